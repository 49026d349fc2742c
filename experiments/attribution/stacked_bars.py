"""A stacked bar per technique, side by side: what each part has of the squared error of all parts, in per cent."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from experiments.attribution.coalitions import PARTS
from experiments.attribution.measurement import Attribution
from experiments.palette import OKABE_ITO
from scenes.replacing import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = dict(zip(PARTS, OKABE_ITO, strict=False))
# a piece lower than this part of the panel has no room for its number
LEAST_LABELLED = 0.05
# nor has a standard error below this one two ends
LEAST_DRAWN = 0.005


def draw_bars(path: Path, attributions: Sequence[Attribution], below: str) -> None:
    """Draw a panel a technique, each on a scale of its own: a negative part may be many times the whole.

    Parameters
    ----------
    below : under the figure: what made it
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    width = max(1.9 * len(attributions) + 0.6, 5.0)
    figure = Figure(figsize=(width, 5.2), dpi=110, layout="constrained")
    panels = figure.subplots(1, len(attributions), squeeze=False)[0]
    for number, (panel, found) in enumerate(zip(panels, attributions, strict=True)):
        _draw_bar(panel, found)
        if number == 0:
            panel.set_ylabel("share of all parts in the mean squared error [%]", fontsize=8)
    handles = [Patch(color=colour, label=name) for name, colour in COLOURS.items()]
    figure.legend(handles=handles, loc="outside upper center", ncols=3, fontsize=8, frameon=False)
    figure.supxlabel(textwrap.fill(below, int(17 * width)), fontsize=7, color="0.35")
    with replacing(path) as beside:
        figure.savefig(beside, format="png")


def _draw_bar(panel: Axes, found: Attribution) -> None:
    panel.set_title(textwrap.fill(found.label, 22), fontsize=9)
    panel.set_xticks([])
    split = found.split
    panel.tick_params(axis="y", labelsize=7)
    for side in ("top", "right", "bottom"):
        panel.spines[side].set_visible(False)
    if split.together.is_noise:
        panel.text(0.5, 0.5, "within\nthe noise", transform=panel.transAxes, ha="center", va="center", fontsize=9)
        panel.set_yticks([])
        return
    panel.set_xlabel(f"all parts: RMS\n{found.of_mean(split.together):.2%} of the mean", fontsize=8)
    heights = {part: 100 * split.fraction(share) for part, share in split.parts.items()}
    errors = {part: 100 * share.standard_error / abs(split.together.value) for part, share in split.parts.items()}
    room = sum(map(abs, heights.values()))
    above = under = 0.0
    for part, height in heights.items():
        bottom = above if height > 0 else under
        panel.bar(0, height, bottom=bottom, width=0.8, color=COLOURS[part])
        if errors[part] > LEAST_DRAWN * room:
            panel.errorbar(0.3, bottom + height, yerr=errors[part], ecolor="0.1", capsize=2)
        if abs(height) > LEAST_LABELLED * room:
            middle = bottom + height / 2
            panel.text(0, middle, f"{height:.3g}", ha="center", va="center", fontsize=8, color="white", weight="bold")
        above, under = above + max(height, 0), under + min(height, 0)
    panel.axhline(0, color="0.1", lw=0.8)
    panel.set_xlim(-0.6, 0.6)
