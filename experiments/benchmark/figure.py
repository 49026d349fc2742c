"""The figure of `airlight benchmark reference`: error against time of both estimators, a panel a scene."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from experiments.benchmark.efficiency import Array, Passes, quartiles, relative_deviation
from experiments.benchmark.measurement import Measurement
from reference.goal import FEWEST_PASSES
from scenes.replacing import replacing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

OURS, STRATA, THEIRS = "#2a5db0", "#2a9d5c", "#c0392b"


def draw_figure(path: Path, measurements: Sequence[Measurement], below: str) -> None:
    """Draw medians and quartiles over the pixels with airlight.

    Parameters
    ----------
    below : str    under the figure: what made it
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.4 * len(measurements), 4.2), dpi=110, layout="constrained")
    panels = figure.subplots(1, len(measurements), sharey=True, squeeze=False)[0]
    for panel, measured in zip(panels, measurements, strict=True):
        _draw_scene(panel, measured)
    panels[0].set_ylabel("relative standard error of a pixel")
    panels[0].legend(loc="lower left", fontsize=7, frameon=False)
    figure.supxlabel(below, fontsize=7, color="0.35")
    with replacing(path) as beside:
        figure.savefig(beside, format="png")


def _draw_scene(panel: Axes, measured: Measurement) -> None:
    truth, goal = measured.truth, measured.goal.rel_error
    steps = np.array([(one.seconds, *quartiles(one.deviation)) for one in measured.strata])
    _band(panel, steps[:, 0], steps[:, 1:], STRATA, "ours, one pass of 1 to 256 strata", "o-")
    for passes, before, colour, label in (
        (measured.ours, measured.plan_seconds, OURS, "ours, planned passes"),
        (measured.theirs, 0.0, THEIRS, "volpath"),
    ):
        worst = quartiles(relative_deviation(passes, truth))[2]
        # as far as it takes a quarter of the pixels beyond the last that is shown to the goal
        last = max(FEWEST_PASSES, (worst / goal) ** 2)
        _passes(panel, passes, truth, before, np.array([1.0, FEWEST_PASSES]), colour, label, "-")
        if last > FEWEST_PASSES:
            further = f"{label}, as N^-1/2" if passes is measured.theirs else None
            _passes(panel, passes, truth, before, np.array([FEWEST_PASSES, last]), colour, further, "--")
    panel.axhline(goal, color="0.3", lw=0.8, ls=":")
    panel.set(xscale="log", yscale="log", xlabel="seconds")
    camera = measured.scene.camera
    panel.set_title(f"{measured.scene.name}, {camera.width} x {camera.height}", fontsize=10)


def _passes(
    panel: Axes, passes: Passes, truth: Array, before: float, counts: Array, colour: str, label: str | None, line: str
) -> None:
    errors = np.array(quartiles(relative_deviation(passes, truth))) / np.sqrt(counts)[:, None]
    _band(panel, before + counts * passes.typical_seconds, errors, colour, label, line)


def _band(panel: Axes, seconds: Array, errors: Array, colour: str, label: str | None, line: str) -> None:
    """A median inside its quartiles, (n, 3)."""
    panel.fill_between(seconds, errors[:, 0], errors[:, 2], color=colour, alpha=0.15, lw=0)
    panel.plot(seconds, errors[:, 1], line, color=colour, lw=1.3, ms=3, label=label)
