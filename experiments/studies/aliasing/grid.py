"""The full grid of scenes, phase functions, techniques and lattices: one table, and the same as a matrix of colours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from experiments.studies import Plot
from experiments.studies.aliasing.naming import naming, shared_settings
from experiments.studies.cells import Gaps, Row, values_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.image import AxesImage

COLUMN = "scattering.rel_95"
# the colours' ends: what nobody sees, and an error ten times as large as the picture [%]
LEAST, MOST = 0.01, 1000.0
INTRODUCTION = """## Every cell of the grid

Relative errors of the scattering layer, median / 95th percentile, with fog on every N-th pixel in x and in y, brought
to the others by {upsample} upsampling; {shared}. A cell without number says why.

{table}"""


def grid_text(rows: Sequence[Row]) -> str:
    """The table of the grid; empty without rows."""
    if not rows:
        return ""
    gaps, spacings = Gaps(), values_of(rows, "downsample")
    found = _cells(rows)
    lines = [
        [*line, *(gaps.cell(found.get((line, spacing)), COLUMN, _both) for spacing in spacings)]
        for line in dict.fromkeys(key[0] for key in found)
    ]
    headings = ["scene", "phase function", "technique", *(f"N = {spacing}" for spacing in spacings)]
    upsample = " or ".join(values_of(rows, "upsample"))
    shared = shared_settings(rows) or "settings as they stand"
    return INTRODUCTION.format(upsample=upsample, shared=shared, table=gaps.table(headings, lines))


def grid_plots(rows: Sequence[Row]) -> Iterator[Plot]:
    """A square a cell: a row a technique under a phase function, a column a lattice of a scene."""
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

    if not any(row.get(COLUMN) for row in rows):
        return
    scenes, phases, spacings = (values_of(rows, name) for name in ("scene", "phase", "downsample"))
    found, scale = _cells(rows), LogNorm(LEAST, MOST)
    techniques = list(dict.fromkeys(technique for (_, _, technique), _ in found))
    size = 0.62 * len(scenes) * len(spacings) + 3.6, 0.3 * len(phases) * len(techniques) + 1.3
    figure = Figure(figsize=size, dpi=110, layout="constrained")
    panels = figure.subplots(len(phases), len(scenes), squeeze=False, sharex=True, sharey=True)
    for i, phase in enumerate(phases):
        for j, scene in enumerate(scenes):
            cells = [[found.get(((scene, phase, technique), n)) for n in spacings] for technique in techniques]
            picture = _matrix(panels[i, j], cells, scale)
            panels[i, j].set_xticks(range(len(spacings)), [str(n) for n in spacings], fontsize=8)
            panels[i, j].set_yticks(range(len(techniques)), techniques, fontsize=7)
            if i == 0:
                panels[i, j].set_title(scene, fontsize=9)
        panels[i, 0].set_ylabel(phase, fontsize=9)
    bar = figure.colorbar(picture, ax=panels, fraction=0.02, extend="both")
    bar.set_label("relative error of the airlight, 95th percentile [%]", fontsize=8)
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.tick_params(labelsize=7)
    figure.supxlabel("fog on every N-th pixel in x and in y", fontsize=8)
    caption = (
        "95th percentile of the scattering layer's relative error [%] over scenes, phase functions, techniques and "
        "lattices; crossed out where the technique refuses the scene or the case has no number."
    )
    yield Plot("grid", caption, figure)


def _cells(rows: Sequence[Row]) -> dict[tuple[tuple[str, str, str], int], Row]:
    name = naming(rows, "downsample")
    return {((row["scene"], row["phase"], name(row)), row["downsample"]): row for row in rows}


def _both(row: Row) -> str:
    return f"{_percent(row['scattering.rel_50'])} / {_percent(row[COLUMN])}"


def _percent(error: float) -> str:
    """Two digits, however small."""
    return "0 %" if error == 0 else f"{100 * error:.{max(0, 1 - int(np.floor(np.log10(100 * error))))}f} %"


def _matrix(panel: Axes, cells: Sequence[Sequence[Row | None]], scale: Normalize) -> AxesImage:
    errors = np.array([[_error(cell) for cell in line] for line in cells])
    picture = panel.imshow(np.maximum(errors, LEAST), cmap="cividis", norm=scale, aspect="auto")
    panel.set_facecolor("0.92")
    panel.tick_params(length=0)
    for (row, column), error in np.ndenumerate(errors):
        # white where cividis is dark
        colour = "0.4" if np.isnan(error) else "white" if error < np.sqrt(LEAST * MOST) else "black"
        text = "×" if np.isnan(error) else _percent(error / 100).removesuffix(" %")
        panel.text(column, row, text, ha="center", va="center", fontsize=6, color=colour)
    return picture


def _error(cell: Row | None) -> float:
    """In %, NaN where there is none."""
    return float("nan") if cell is None or cell.get(COLUMN) is None else 100 * cell[COLUMN]
