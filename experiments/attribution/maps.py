"""The signed error of each pixel, part by part: a row a technique, one scale for all."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from experiments.attribution.coalitions import PARTS
from experiments.attribution.measurement import Attribution
from experiments.heat_maps.colours import colour_map
from experiments.heat_maps.heat_map import NOISE, HeatMap, is_noise
from experiments.heat_maps.panel import show
from experiments.sheet import display
from scenes.replacing import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAP = HeatMap(signed=True, unit="relative")
COLUMNS = ("technique", "reference", "whole error", *PARTS, "remains")
# inches: a picture's cell, the room above and below all rows
CELL, TOP, BOTTOM = 1.75, 0.35, 0.45


def draw_maps(path: Path, attributions: Sequence[Attribution], below: str) -> None:
    """Draw technique, reference, the whole error, each part's Shapley value, and what remains.

    Parameters
    ----------
    attributions : of one scene against one reference
    below : under the figure: what made it
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

    scale = MAP.scale(attributions[0].reference)
    width = 0.3 + len(COLUMNS) * CELL + 0.9
    height = TOP + len(attributions) * (CELL + 0.1) + BOTTOM
    figure = Figure(figsize=(width, height), dpi=110)
    grid = figure.add_gridspec(
        len(attributions), len(COLUMNS), left=0.3 / width, right=1 - 0.9 / width, bottom=BOTTOM / height,
        top=1 - TOP / height, wspace=0.04, hspace=0.06,
    )  # fmt: skip
    for row, found in enumerate(attributions):
        axes = [figure.add_subplot(grid[row, column]) for column in range(len(COLUMNS))]
        _draw_row(axes, found)
        axes[0].set_ylabel(textwrap.fill(found.label, 26), fontsize=8)
        if row == 0:
            for axis, title in zip(axes, COLUMNS, strict=True):
                # at one height, also above what is no picture
                axis.set_title(title, fontsize=9, y=1.0)
    bar = figure.add_axes((1 - 0.75 / width, BOTTOM / height, 0.15 / width, 1 - (TOP + BOTTOM) / height))
    shown = ScalarMappable(scale.norm(), colour_map(MAP.colour_map))
    figure.colorbar(shown, cax=bar, extend="both", extendfrac=0.04)
    bar.set_yticks(scale.ticks(), labels=[f"{tick:.3g}" for tick in scale.ticks()], fontsize=7)
    bar.minorticks_off()
    bar.set_title(MAP.symbol, fontsize=8)
    legend = (
        f"Signed error of the luminance over max(r, floor), red: too bright, logarithmic beyond {scale.linear:.3g} %. "
        f"Grey: within {NOISE:g} standard errors of the reference; none enters the parts. {below}"
    )
    figure.text(0.3 / width, 0.06 / height, textwrap.fill(legend, 190), fontsize=7, color="0.35", va="bottom")
    with replacing(path) as beside:
        figure.savefig(beside, format="png")


def _draw_row(axes: Sequence[Axes], found: Attribution) -> None:
    for axis in axes:
        axis.set_xticks([])
        axis.set_yticks([])
        for spine in axis.spines.values():
            spine.set_visible(False)
    axes[0].imshow(display(found.picture, found.reference))
    axes[1].imshow(display(found.reference, found.reference))
    split = found.split
    _draw_error(axes[2], found, split.whole.signed, noisy=True)
    for axis, part in zip(axes[3:], PARTS, strict=False):
        axis.set_box_aspect(found.reference.shape[0] / found.reference.shape[1])
        if part in split.parts:
            _draw_error(axis, found, split.parts[part].signed, noisy=False)
        else:
            reason = textwrap.fill(found.parts.left_out[part].replace("`", ""), 22)
            axis.text(0.5, 0.5, reason, fontsize=7, color="0.35", ha="center", va="center", transform=axis.transAxes)
    _draw_error(axes[-1], found, split.remains.signed, noisy=True)


def _draw_error(axis: Axes, found: Attribution, signed: np.ndarray, noisy: bool) -> None:
    """Show an error (H, W, 3); where the reference's noise is in it, what it may be is grey."""
    errors = MAP.errors(found.reference + signed, found.reference)
    noise = MAP.noise(found.standard_error, found.reference)
    hidden = is_noise(errors, noise) if noisy else np.zeros(errors.shape, np.bool_)
    picture = axis.imshow(np.zeros((2, 2)), cmap=colour_map(MAP.colour_map), interpolation="nearest")
    show(picture, np.ma.masked_array(errors, hidden))
    picture.set_norm(MAP.scale(found.reference).norm())
