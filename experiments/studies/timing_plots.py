"""The figures of the study `timing`: ratios over the grid, passes as stacked bars, and growth."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np
import polars

from experiments.measurements.timing import pass_column
from experiments.palette import OKABE_ITO
from experiments.studies import Plot
from experiments.studies.cells import Row, label, values_of
from experiments.studies.timing_growth import AXES, Axis, along
from experiments.technique_benchmark.figure import COLOURS as PASS_COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKS = "os^vDxP*"
# meshes decimated to one budget differ by some triangles from scene to scene
ALIKE = 1.02


def plots(table: polars.DataFrame) -> Iterator[Plot]:
    """Those for which the table has cases."""
    rows = list(table.iter_rows(named=True))
    timed = [row for row in rows if row["status"] == "done" and row.get("timing.ms_50") is not None]
    grid = [row for row in timed if row["product"] == "grid"]
    if any(row["timing.ratio_50"] is not None for row in grid):
        yield Plot(
            "ratios",
            "Time of a frame over the baseline's in the same round, against the spacing N of evaluated pixels; bars "
            "are the intervals of the medians. Dotted: as fast as the baseline.",
            _ratios([row for row in grid if row["timing.ratio_50"] is not None]),
        )
    if grid:
        phase = values_of(grid, "phase")[0]
        yield Plot(
            "passes",
            f"Milliseconds of each pass (medians; phase function {phase}), by {grid[0]['timing.clock']}; the tick is a "
            "frame without that clock.",
            _passes([row for row in grid if row["phase"] == phase]),
        )
    found = [axis for axis in AXES if along(axis, rows)]
    if found:
        yield Plot(
            "growth",
            "Milliseconds against what there is to do: whole frames above, below the passes that the quantity is work "
            "for. Where a technique drew several scenes and phase functions, their median.",
            _growth(found, rows),
        )


def _ratios(rows: Sequence[Row]) -> Figure:
    from matplotlib.figure import Figure

    scenes, phases = values_of(rows, "scene"), values_of(rows, "phase")
    styles = _styles(label(row, "downsample") for row in rows)
    figure = Figure(figsize=(2.5 * len(scenes) + 0.8, 2.3 * len(phases) + 0.9), dpi=110, layout="constrained")
    panels = figure.subplots(len(phases), len(scenes), sharex=True, sharey=True, squeeze=False)
    for i, phase in enumerate(phases):
        for j, scene in enumerate(scenes):
            panel, here = panels[i, j], [row for row in rows if (row["scene"], row["phase"]) == (scene, phase)]
            panel.axhline(1.0, color="0.4", lw=0.8, ls=":")
            for name, (colour, mark) in styles.items():
                line = sorted(
                    (row for row in here if label(row, "downsample") == name), key=lambda row: row["downsample"]
                )
                at, middle = [row["downsample"] for row in line], [row["timing.ratio_50"] for row in line]
                bars = np.array([_reach(row) for row in line]).reshape(-1, 2).T
                panel.errorbar(at, middle, bars, color=colour, marker=mark, ms=3.5, lw=1, elinewidth=0.8)
            panel.set(xscale="log", yscale="log")
            _plain_ticks(panel, values_of(rows, "downsample"))
            if i == 0:
                panel.set_title(scene, fontsize=9)
        panels[i, 0].set_ylabel(f"{phase}: ratio", fontsize=8)
    figure.supxlabel("spacing N of evaluated pixels", fontsize=8)
    _legend(figure, styles)
    return figure


def _reach(row: Row) -> tuple[float, float]:
    """How far an interval goes below and above its ratio; not at all where there is none."""
    if row["timing.ratio_low"] is None:
        return 0.0, 0.0
    return row["timing.ratio_50"] - row["timing.ratio_low"], row["timing.ratio_high"] - row["timing.ratio_50"]


def _passes(rows: Sequence[Row]) -> Figure:
    """A row of panels a scene, a column a spacing, a bar a technique."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    scenes, spacings = values_of(rows, "scene"), values_of(rows, "downsample")
    names = list(dict.fromkeys(label(row, "downsample") for row in rows))
    height = (0.19 * len(names) + 0.75) * len(scenes) + 0.8
    figure = Figure(figsize=(2.6 * len(spacings) + 1.8, height), dpi=110, layout="constrained")
    panels = figure.subplots(len(scenes), len(spacings), sharex="row", sharey=True, squeeze=False)
    for i, scene in enumerate(scenes):
        for j, spacing in enumerate(spacings):
            panel = panels[i, j]
            for row in rows:
                if (row["scene"], row["downsample"]) == (scene, spacing):
                    _bar(panel, names.index(label(row, "downsample")), row)
            panel.set_title(f"{scene}, N = {spacing}", fontsize=8)
            panel.tick_params(labelsize=7)
            panel.set_yticks(range(len(names)), names)
    panels[0, 0].invert_yaxis()
    handles = [Patch(color=colour, label=name) for name, colour in PASS_COLOURS.items()]
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles), fontsize=8, frameon=False)
    figure.supxlabel("ms a frame", fontsize=8)
    return figure


def _bar(panel: Axes, place: int, row: Row) -> None:
    left = 0.0
    for name, colour in PASS_COLOURS.items():
        width = row[pass_column(name)]
        panel.barh(place, width, left=left, color=colour, height=0.75)
        left += width
    panel.plot(row["timing.ms_50"], place, "|", color="0.1", ms=8, mew=1.2)


def _growth(axes: Sequence[Axis], rows: Sequence[Row]) -> Figure:
    from matplotlib.figure import Figure

    styles = _styles(name for axis in axes for name in along(axis, rows))
    figure = Figure(figsize=(2.9 * len(axes) + 0.5, 5.6), dpi=110, layout="constrained")
    panels = figure.subplots(2, len(axes), sharex="col", squeeze=False)
    for j, axis in enumerate(axes):
        for name, line in along(axis, rows).items():
            colour, mark = styles[name]
            at = _places(axis, line)
            for panel, of_passes in ((panels[0, j], False), (panels[1, j], True)):
                curve = [_middle(axis, line, x, of_passes) for x in at]
                panel.plot(at, curve, color=colour, marker=mark, ms=3.5, lw=1)
        places = _places(axis, [row for line in along(axis, rows).values() for row in line])
        for panel in panels[:, j]:
            panel.set(xscale="log", yscale="log")
            _plain_ticks(panel, places)
        panels[1, j].set_xlabel(axis.name, fontsize=8)
        panels[1, j].set_title(" + ".join(axis.passes), fontsize=8)
        panels[0, j].set_title("whole frame", fontsize=8)
    for i in (0, 1):
        panels[i, 0].set_ylabel("ms", fontsize=8)
    _legend(figure, styles)
    return figure


def _places(axis: Axis, rows: Sequence[Row]) -> list[float]:
    """Where the axis has rows; those that differ by less than `ALIKE` lie at the first of them."""
    places: list[float] = []
    for x in sorted({axis.quantity(row) or 0.0 for row in rows}):
        if not places or x > ALIKE * places[-1]:
            places.append(x)
    return places


def _middle(axis: Axis, line: Sequence[Row], x: float, of_passes: bool) -> float:
    """Median over what else differs at one place of the axis; not a number where nothing took time."""
    here = [row for row in line if x <= (axis.quantity(row) or 0.0) <= ALIKE * x]
    found = float(np.median([axis.pass_milliseconds(row) if of_passes else row["timing.ms_50"] for row in here]))
    return found if found > 0 else np.nan


def _styles(names: Iterable[str]) -> dict[str, tuple[str, str]]:
    """A colour and a mark for each name."""
    return dict(zip(dict.fromkeys(names), zip(cycle(OKABE_ITO), cycle(MARKS), strict=False), strict=False))


def _plain_ticks(panel: Axes, places: Sequence[float]) -> None:
    """Numbers without powers of ten on logarithmic axes: at the places in x, at 1, 2 and 5 of a decade in y."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    # of places that lie closer than the words are wide, the first
    apart = [one for i, one in enumerate(places) if i == 0 or one > 1.25 * places[i - 1]]
    panel.set_xticks(apart, [f"{one:.3g}" if one < 1e3 else f"{one / 1e3:,.4g}k" for one in apart])
    panel.xaxis.set_minor_formatter(NullFormatter())
    panel.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    panel.yaxis.set_minor_formatter(NullFormatter())
    panel.tick_params(labelsize=7)


def _legend(figure: Figure, styles: dict[str, tuple[str, str]]) -> None:
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], color=colour, marker=mark, ms=4, label=name) for name, (colour, mark) in styles.items()]
    figure.legend(handles=handles, loc="outside upper center", ncols=4, fontsize=7, frameon=False)
