"""Errors of each case, scene by scene: what any suite that measures them can be told by."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import cycle

import polars

from experiments.palette import OKABE_ITO
from experiments.studies import Plot, Study
from experiments.studies.cells import Gaps, Row, label

# bars are read one by one; a grid of hundreds has a study of its own
MOST_BARS = 40
MEDIAN, PERCENTILE_95 = "scattering.rel_50", "scattering.rel_95"
# column of the run's table -> heading, and how a number is shown
COLUMNS = {
    MEDIAN: ("median", "{:.3%}"),
    PERCENTILE_95: ("95 %", "{:.3%}"),
    "scattering.rel_99": ("99 %", "{:.3%}"),
    "scattering.image_mean_rel": ("image mean", "{:+.3%}"),
    "scattering.flip": ("FLIP", "{:.4f}"),
    "rel_error": ("reference's noise", "{:.2%}"),
}


def plots(table: polars.DataFrame) -> Iterator[Plot]:
    """The 95th percentile of each case's error as a bar, a dot on it for the median, a group a scene."""
    from matplotlib.figure import Figure

    rows = _measured(table)
    if not rows or len(rows) > MOST_BARS:
        return
    names = list(dict.fromkeys(label(row) for row in rows))
    groups = list(dict.fromkeys(_scene(row) for row in rows))
    width = 0.8 / len(names)
    figure = Figure(figsize=(max(5.0, 0.35 * len(rows) + 2.5), 3.4), dpi=110, layout="constrained")
    panel = figure.subplots()
    for number, (name, colour) in enumerate(zip(names, cycle(OKABE_ITO), strict=False)):
        mine = [row for row in rows if label(row) == name]
        at = [groups.index(_scene(row)) + (number - (len(names) - 1) / 2) * width for row in mine]
        panel.bar(at, [row[PERCENTILE_95] for row in mine], 0.9 * width, color=colour, label=name)
        medians = [row[MEDIAN] for row in mine]
        panel.plot(at, medians, "o", color="white", markeredgecolor="black", ms=4, ls="none")
    panel.set(ylabel="relative error of the airlight", yscale="log")
    # a scene may be called anything, and formulas cannot
    panel.set_xticks(range(len(groups)), groups, parse_math=False)
    figure.legend(loc="outside upper left", ncols=3, fontsize=8, frameon=False)
    yield Plot("errors", "Relative error of the scattering layer: 95th percentile (bar) and median (dot).", figure)


def text(table: polars.DataFrame) -> str:
    """One Markdown table, a line a case; where a case has no numbers, why."""
    gaps = Gaps()
    lines = [[_scene(row), label(row), *_cells(row, gaps)] for row in table.iter_rows(named=True)]
    return gaps.table(["scene", "technique", *(heading for heading, _ in COLUMNS.values())], lines)


def _cells(row: Row, gaps: Gaps) -> list[str]:
    """A case's numbers; where none was measured, one reason for all."""
    if why := gaps.cell(row, MEDIAN, lambda row: ""):
        return [why] * len(COLUMNS)
    return [gaps.cell(row, column, partial(_number, column=column)) for column in COLUMNS]


def _number(row: Row, column: str) -> str:
    _, shape = COLUMNS[column]
    return shape.format(float(row[column]))


def _measured(table: polars.DataFrame) -> list[Row]:
    # an axis of powers of ten has no place for 0
    return [row for row in table.iter_rows(named=True) if row.get(MEDIAN) is not None and row.get(PERCENTILE_95)]


def _scene(row: Row) -> str:
    return " ".join(filter(None, (row["scene"], row["phase"], row["camera"])))


STUDY = Study("Errors against the reference", plots, text)
