"""Pictures side by side: techniques, references, and the errors between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from experiments.heat_maps.colours import colour_map
from experiments.heat_maps.heat_map import HeatMap
from experiments.metrics import Image, signed_relative_error
from experiments.sheet import display

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# side of one picture on the page [inch]
SIDE = 2.3
SIGNED = HeatMap(signed=True, unit="relative", logarithmic=False)


def picture_grid(rows: int, columns: int, side: float = SIDE) -> tuple[Figure, Any]:
    """A figure with axes for rows x columns pictures, (rows, columns) of axes without ticks."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(columns * side, rows * (side + 0.25)), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    for one in axes.flat:
        one.set_axis_off()
    return figure, axes


def above_and_below(width: float, heights: tuple[float, float]) -> tuple[Figure, Any, Any]:
    """A figure in two parts, one above the other [inch]."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, sum(heights)), layout="constrained")
    parts: Any = figure.subfigures(2, 1, height_ratios=heights)
    return figure, parts[0], parts[1]


def show(axes: Axes, image: Image, exposed_for: Image, title: str) -> None:
    """Show linear radiance, as bright as suits another picture."""
    axes.imshow(display(image, exposed_for))
    axes.set_title(title, fontsize=8)


def show_error(axes: Axes, test: Image, truth: Image, title: str, heat_map: HeatMap = SIGNED) -> Any:
    """Show an error on the scale that all pictures with this reference have; what `error_bar` takes."""
    norm, colours = heat_map.scale(truth).norm(), colour_map(heat_map.colour_map)
    shown = axes.imshow(heat_map.errors(test, truth), cmap=colours, norm=norm)
    axes.set_title(title, fontsize=8)
    return shown


def error_bar(figure: Any, shown: Any, axes: Any, heat_map: HeatMap = SIGNED) -> None:
    """The colour bar of `show_error`, beside axes of a figure or a part of one."""
    bar = figure.colorbar(shown, ax=axes, extend="both" if heat_map.signed else "max", shrink=0.9, aspect=30)
    bar.set_label(heat_map.title, fontsize=7)
    bar.ax.tick_params(labelsize=7)


@dataclass(frozen=True)
class RelativeError:
    """Of the numbers of `experiments.metrics.Metrics` those that figures and claims tell; HDR-FLIP takes a second."""

    rel_50: float
    rel_95: float
    image_mean_rel: float


def in_words(error: RelativeError) -> str:
    """Median, 95th percentile and image mean of a relative error."""
    return f"median {error.rel_50:.2%}, 95 % {error.rel_95:.2%}, image mean {error.image_mean_rel:+.2%}"


def scattering_error(frame: Any, reference: Any) -> RelativeError:
    """How far a frame's airlight is from its reference's, which must not be black."""
    test, truth = (np.asarray(one.scattering, np.float64) for one in (frame, reference))
    if not truth.any():
        raise ValueError("reference must be lit, and is black.")
    relative = np.abs(signed_relative_error(test, truth)[(test != 0) | (truth != 0)])
    median, worst = np.percentile(relative, [50, 95])
    return RelativeError(float(median), float(worst), float(test.mean() / truth.mean() - 1))
