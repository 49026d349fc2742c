"""A heat map and its bar in a matplotlib figure, laid out once and filled for each comparison."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from experiments.heat_maps.colours import NOISE_COLOUR, colour_map
from experiments.heat_maps.heat_map import HeatMap, is_noise, typical_noise
from experiments.metrics import Image

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.image import AxesImage


class Panel:
    """One heat map of several pictures, a picture an axis, with one bar for all."""

    def __init__(self, heat_map: HeatMap, axes: Sequence[Axes], bar: Axes) -> None:
        from matplotlib.patches import Rectangle

        self.heat_map = heat_map
        colours = colour_map(heat_map.colour_map)
        # a mean of neighbours would be an error that no pixel has
        self._pictures = [axis.imshow(np.zeros((2, 2)), cmap=colours, interpolation="nearest") for axis in axes]
        hint = ", red: too bright" if heat_map.signed else ""
        axes[0].set_title(heat_map.title + hint, fontsize=10)
        extend = "both" if heat_map.signed else "max"
        # the arrows of a bar beside several rows stay as small as beside one
        arrow = 0.05 / len(axes)
        self._bar = axes[0].figure.colorbar(self._pictures[0], cax=bar, extend=extend, extendfrac=arrow)
        bar.set_title(heat_map.symbol, fontsize=8, y=1 + arrow, pad=2)
        bar.tick_params(labelsize=8)
        # the pictures' grey on the bar, where errors are noise
        self._noise = Rectangle((0, 0), 1, 0, transform=bar.get_yaxis_transform(), facecolor=NOISE_COLOUR, zorder=3)
        bar.add_patch(self._noise)

    def fill(self, tests: Sequence[Image], reference: Image, standard_error: Image | None) -> str:
        """Show the errors of pictures (H, W, 3); what is to be said below them is returned."""
        scale = self.heat_map.scale(reference)
        norm = scale.norm()
        noise = np.zeros(reference.shape[:2])
        if standard_error is not None:
            noise = self.heat_map.noise(standard_error, reference)
        for picture, test in zip(self._pictures, tests, strict=True):
            errors = self.heat_map.errors(test, reference)
            show(picture, np.ma.masked_array(errors, is_noise(errors, noise)))
            picture.set_norm(norm)
        self._bar.set_ticks(scale.ticks(), labels=[f"{tick:.3g}" for tick in scale.ticks()])
        self._bar.minorticks_off()
        level = min(typical_noise(noise), scale.limit)
        lower = -level if scale.lowest else 0.0
        self._noise.set_y(lower)
        self._noise.set_height(level - lower)
        return f"{self.heat_map.title}: logarithmic beyond {scale.linear:.3g}" if scale.linear else ""


def show(picture: AxesImage, image: NDArray[np.floating]) -> None:
    """Put another image, of any size, in the place of the one that a figure shows."""
    height, width = image.shape[:2]
    picture.set_data(image)
    picture.set_extent((-0.5, width - 0.5, height - 0.5, -0.5))
