"""The figure of `airlight benchmark techniques`: milliseconds of each pass, a bar a contender, a panel a scene."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from experiments.technique_benchmark.contenders import BASELINE
from experiments.technique_benchmark.measurement import Result
from gpu_impl.timing import PASSES
from scenes.replacing import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = dict(zip(PASSES, ("#4c78a8", "#72b7b2", "#54a24b", "#eeca3b", "#e45756", "#b279a2"), strict=True))


def draw_figure(path: Path, results: Sequence[Result], below: str) -> None:
    """Draw a row of panels a scene and a column a phase function.

    Parameters
    ----------
    below : str    under the figure: what made it
    """
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    scenes = list(dict.fromkeys(result.scene.name for result in results))
    phases = list(dict.fromkeys(result.scene.phase.name for result in results))
    most = max(len(result.contenders) for result in results)
    figure = Figure(figsize=(5.5 * len(phases), (0.2 * most + 1.0) * len(scenes) + 0.8), dpi=110, layout="constrained")
    panels = figure.subplots(len(scenes), len(phases), squeeze=False)
    for panel in panels.flat:
        panel.set_axis_off()
    for result in results:
        _draw_panel(panels[scenes.index(result.scene.name), phases.index(result.scene.phase.name)], result)
    handles = [Patch(color=colour, label=name) for name, colour in COLOURS.items()]
    figure.legend(handles=handles, loc="outside upper center", ncols=len(PASSES), fontsize=8, frameon=False)
    figure.supxlabel(textwrap.fill(below, 90 * len(phases)), fontsize=7, color="0.35")
    with replacing(path) as beside:
        figure.savefig(beside, format="png")


def _draw_panel(panel: Axes, result: Result) -> None:
    panel.set_axis_on()
    drawn = [one for one in result.contenders.values() if not one.refusal]
    places = np.arange(len(drawn))
    left = np.zeros(len(drawn))
    for name in PASSES:
        widths = np.array([one.times.pass_median(name) for one in drawn])
        panel.barh(places, widths, left=left, color=COLOURS[name], height=0.75)
        left += widths
    whole = [float(np.median(one.times.milliseconds)) for one in drawn]
    panel.plot(whole, places, "|", color="0.1", ms=9, mew=1.2)
    baseline = float(np.median(result.contenders[BASELINE.name].times.milliseconds))
    panel.axvline(baseline, color="0.3", lw=0.8, ls=":")
    panel.set_yticks(places, [one.contender.name for one in drawn], fontsize=7)
    panel.invert_yaxis()
    panel.tick_params(axis="x", labelsize=7)
    panel.set_xlim(left=0)
    panel.set_xlabel("ms a frame", fontsize=8)
    camera = result.scene.camera
    panel.set_title(f"{result.scene.name}, {result.scene.phase.name}, {camera.width} x {camera.height}", fontsize=9)
