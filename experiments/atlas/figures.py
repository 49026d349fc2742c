"""Error maps of all models for one phase function, float64 beside float32, on one sheet."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from analytic.models import AirlightModel
from experiments.atlas.errors import PRECISIONS, ErrorMap
from experiments.atlas.grid import VISIBLE_DEPTH, Grid
from scenes.replacing import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_figure", "write_figure"]

ACROSS = 3  # models in a row, two panels each
SCALE = (1e-16, 1.0)
COLOURS = "viridis"
# line style and colour of the contours in each precision: the target of a float64 model, and the two of a shader
CONTOURS: dict[str, dict[float, tuple[str, str]]] = {
    "float64": {1e-9: ("solid", "white")},
    "float32": {1e-4: ("dashed", "black"), 1e-2: ("solid", "black")},
}
# inches
WIDTH, ROW, HEAD, FOOT = 16.0, 2.55, 1.0, 0.65


def write_figure(
    path: Path, title: str, models: list[AirlightModel], maps: dict[tuple[str, str], ErrorMap], grid: Grid
) -> None:
    """Write what `draw_figure` draws to a PNG file, 1600 pixels wide."""
    with replacing(path) as beside:
        draw_figure(title, models, maps, grid).savefig(beside, format="png", pil_kwargs={"optimize": True})


def draw_figure(title: str, models: list[AirlightModel], maps: dict[tuple[str, str], ErrorMap], grid: Grid) -> Figure:
    """Draw the 95th percentiles of every model's cells.

    Parameters
    ----------
    title : str   of the sheet
    models : all of them, in the order of the panels; one without a map has its panel say what it takes instead
    maps : by name of the model and precision
    """
    from matplotlib.figure import Figure

    rows = -(-len(models) // ACROSS)
    height = rows * ROW + HEAD + FOOT
    figure = Figure(figsize=(WIDTH, height), dpi=100)
    spec = figure.add_gridspec(
        rows,
        3 * ACROSS - 1,
        width_ratios=([1, 1, 0.32] * ACROSS)[:-1],
        left=0.045,
        right=0.925,
        top=1 - (HEAD + 0.15) / height,
        bottom=FOOT / height,
        hspace=0.42,
        wspace=0.1,
    )
    drawn = [number for number, model in enumerate(models) if (model.name, PRECISIONS[0]) in maps]
    for number, model in enumerate(models):
        row, column = divmod(number, ACROSS)
        if number not in drawn:
            _draw_refusal(figure.add_subplot(spec[row, 3 * column : 3 * column + 2]), model)
            continue
        # the axes are named at the last map of a column and at the first of a row
        lowest = not any(other > number and other % ACROSS == column for other in drawn)
        leftmost = not any(number - column <= other < number for other in drawn)
        for side, precision in enumerate(PRECISIONS):
            axes = figure.add_subplot(spec[row, 3 * column + side])
            _draw_map(axes, maps[model.name, precision], grid)
            _label(axes, f"{model.name}\n{precision}", lowest, leftmost and not side)
    _draw_bar(figure, height)
    figure.text(0.045, 1 - 0.3 / height, title, fontsize=13, weight="bold", va="center")
    figure.text(
        0.045,
        1 - 0.66 / height,
        f"Lines: float64 white 1e-9; float32 black, dashed 1e-4, solid 1e-2. Left of the dotted line (H = "
        f"{VISIBLE_DEPTH:g}) the visible segments count; right of it, where the light is invisible, all.",
        fontsize=10,
        va="center",
    )
    return figure


def _draw_map(axes: Axes, errors: ErrorMap, grid: Grid) -> None:
    from matplotlib.colors import LogNorm

    # what is wrong beyond measure is drawn as 1, what is exact as 1e-16; a cell without a segment stays grey
    shown = np.clip(errors.percentile_95.T, *SCALE)
    axes.set_facecolor("0.8")
    axes.pcolormesh(
        _edges(grid.optical_h), _edges(grid.optical_length), shown, norm=LogNorm(*SCALE), cmap=COLOURS, rasterized=True
    )
    for level, (style, colour) in CONTOURS[errors.precision].items():
        if np.nanmin(shown) < level < np.nanmax(shown):
            logarithm = np.log10(shown)
            axes.contour(
                grid.optical_h,
                grid.optical_length,
                logarithm,
                levels=[np.log10(level)],
                linestyles=style,
                colors=colour,
                linewidths=1.0,
            )
    axes.axvline(VISIBLE_DEPTH, color="white", linestyle="dotted", linewidth=1.2)
    axes.set(xscale="log", yscale="log")


def _label(axes: Axes, title: str, lowest: bool, leftmost: bool) -> None:
    ticks, labels = [1e-3, 0.1, 10.0], ["0.001", "0.1", "10"]
    axes.set_xticks(ticks, labels if lowest else [], minor=False)
    axes.set_yticks(ticks, labels if leftmost else [], minor=False)
    axes.minorticks_off()
    axes.tick_params(labelsize=9)
    axes.set_title(title, fontsize=9.5, loc="left", pad=3)
    if lowest:
        axes.set_xlabel(r"$H = \sigma_t h$", fontsize=10, labelpad=1)
    if leftmost:
        axes.set_ylabel(r"$T = \sigma_t (x_b - x_a)$", fontsize=10, labelpad=1)


def _draw_refusal(axes: Axes, model: AirlightModel) -> None:
    axes.set(xticks=[], yticks=[], facecolor="0.94")
    axes.set_title(f"{model.name}\n", fontsize=9.5, loc="left", pad=3)
    taken = "\n".join(model.phases)
    axes.text(0.5, 0.5, f"takes only\n{taken}", ha="center", va="center", fontsize=10, transform=axes.transAxes)


def _draw_bar(figure: Figure, height: float) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm

    axes = figure.add_axes((0.943, FOOT / height, 0.013, 1 - (HEAD + FOOT + 0.15) / height))
    bar: Any = figure.colorbar(ScalarMappable(LogNorm(*SCALE), COLOURS), cax=axes, extend="both")
    bar.set_label("relative error, 95th percentile", fontsize=11)
    bar.set_ticks(10.0 ** np.arange(-16, 1, 2))
    bar.ax.tick_params(labelsize=9)


def _edges(centres: NDArray[np.float64]) -> NDArray[np.float64]:
    """Edges of cells whose centres are equally spaced in their logarithm, (m + 1,)."""
    half_step = np.sqrt(centres[1] / centres[0])
    return np.append(centres / half_step, centres[-1] * half_step)
