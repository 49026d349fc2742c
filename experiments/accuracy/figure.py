"""The figure of `airlight accuracy`: errors against samples a ray, and against texels of the shadow map."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

from experiments.accuracy.study import LIMITS, SHADOW_MAP_LADDER, STEPS_LADDER, Row
from experiments.palette import OKABE_ITO
from scenes.replacing import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_figure(path: Path, rows: Sequence[Row], below: str) -> None:
    """Draw a column a phase function; the 95th percentile whole, the median dashed, a colour a scene.

    Parameters
    ----------
    below : str    under the figure: what made it
    """
    from matplotlib.figure import Figure

    phases = list(dict.fromkeys(row["phase"] for row in rows))
    figure = Figure(figsize=(4.2 * len(phases), 7.2), dpi=110, layout="constrained")
    panels = figure.subplots(2, len(phases), sharey=True, squeeze=False)
    for column, phase in enumerate(phases):
        mine = [row for row in rows if row["phase"] == phase]
        _curves(panels[0, column], mine, "steps", "shadow_map", SHADOW_MAP_LADDER[-1])
        _curves(panels[1, column], mine, "shadow_map", "steps", STEPS_LADDER[-1])
        panels[0, column].set(title=phase, xlabel=f"samples in the shadow region (map: {SHADOW_MAP_LADDER[-1]} texels)")
        panels[1, column].set(xlabel=f"texels on a side of the shadow map ({STEPS_LADDER[-1]} samples)")
    for row in panels:
        row[0].set_ylabel("relative error of the scattering layer")
    # between the percentiles and the medians, where the thesis's scenes leave room
    panels[0, -1].legend(loc="lower right", bbox_to_anchor=(1, 0.15), fontsize=7, frameon=False)
    text = textwrap.fill(f"whole: 95th percentile; dashed: median. {below}", 60 * len(phases))
    figure.supxlabel(text, fontsize=7, color="0.35")
    with replacing(path) as beside:
        figure.savefig(beside, format="png")


def _curves(panel: Axes, rows: Sequence[Row], along: str, fixed: str, value: int) -> None:
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    for scene, colour in zip(scenes, cycle(OKABE_ITO), strict=False):
        mine = sorted(
            (int(row[along]), row["rel_50"], row["rel_95"])
            for row in rows
            if row["scene"] == scene and int(row[fixed]) == value
        )
        at, median, most = zip(*mine, strict=True)
        panel.plot(at, most, "o-", color=colour, lw=1.3, ms=3, label=scene)
        panel.plot(at, median, "o--", color=colour, lw=0.9, ms=2)
    for limit, text in zip(LIMITS, ("limit of the median", "limit of the 95th percentile"), strict=True):
        panel.axhline(limit, color="0.5", lw=0.8, ls=":")
        panel.text(at[0], limit, text, fontsize=6, color="0.4", va="bottom")
    panel.set(xscale="log", yscale="log")
    panel.set_xticks(at, [str(one) for one in at])
    panel.minorticks_off()
