"""Errors of each case, scene by scene: what any suite that measures them can be told by."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import cycle

import polars

from experiments.palette import OKABE_ITO
from experiments.studies import Plot, Study
from experiments.technique_label import technique_label

# bars are read one by one; a grid of hundreds has a study of its own
MOST_BARS = 40


def plots(table: polars.DataFrame) -> Iterator[Plot]:
    """The 95th percentile of each case's error as a bar, a dot on it for the median, a group a scene."""
    from matplotlib.figure import Figure

    rows = _measured(table)
    if not rows or len(rows) > MOST_BARS:
        return
    names = list(dict.fromkeys(_label(row) for row in rows))
    groups = list(dict.fromkeys(_scene(row) for row in rows))
    width = 0.8 / len(names)
    figure = Figure(figsize=(max(5.0, 0.35 * len(rows) + 2.5), 3.4), dpi=110, layout="constrained")
    panel = figure.subplots()
    for number, (name, colour) in enumerate(zip(names, cycle(OKABE_ITO), strict=False)):
        mine = [row for row in rows if _label(row) == name]
        at = [groups.index(_scene(row)) + (number - (len(names) - 1) / 2) * width for row in mine]
        panel.bar(at, [row["scattering.rel_95"] for row in mine], 0.9 * width, color=colour, label=name)
        medians = [row["scattering.rel_50"] for row in mine]
        panel.plot(at, medians, "o", color="white", markeredgecolor="black", ms=4, ls="none")
    panel.set(ylabel="relative error of the airlight", yscale="log")
    panel.set_xticks(range(len(groups)), groups)
    figure.legend(loc="outside upper left", ncols=3, fontsize=8, frameon=False)
    yield Plot("errors", "Relative error of the scattering layer: 95th percentile (bar) and median (dot).", figure)


def text(table: polars.DataFrame) -> str:
    """One Markdown table, a line a case; where a case has no numbers, why."""
    lines = [
        "| scene | technique | median | 95 % | 99 % | image mean | FLIP | reference's noise |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    for row in table.iter_rows(named=True):
        if row["status"] != "done" or row.get("scattering.rel_50") is None:
            lines.append(f"| {_scene(row)} | {_label(row)} | {row['status']}: {row['reason']} | | | | | |")
            continue
        numbers = [f"{row[f'scattering.rel_{part}']:.3%}" for part in (50, 95, 99)]
        lines.append(
            f"| {_scene(row)} | {_label(row)} | {' | '.join(numbers)} | {row['scattering.image_mean_rel']:+.3%} "
            f"| {row['scattering.flip']:.4f} | {float(row['rel_error']):.2%} |"
        )
    return "\n".join(lines)


def _measured(table: polars.DataFrame) -> list[dict]:
    return [row for row in table.iter_rows(named=True) if row.get("scattering.rel_95")]


def _scene(row: dict) -> str:
    return " ".join(filter(None, (row["scene"], row["phase"], row["camera"])))


def _label(row: dict) -> str:
    return technique_label(row["technique"], row)


STUDY = Study("Errors against the reference", plots, text)
