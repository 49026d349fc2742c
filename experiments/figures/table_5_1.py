"""Table 5.1: frames a second as published, beside frames that are timed here, all in one run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from experiments.figures.entry import Drawn
from experiments.figures.stage import Stage
from experiments.intervals import Array, median_interval
from experiments.markdown import table
from experiments.technique_benchmark.budget import load_within
from experiments.technique_benchmark.contenders import FAST, FASTER, TABLE_5_1
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique

# as the thesis's frames; its meshes' triangles are not stated
SIDE = 1024
TRIANGLES = 20_000
ROUNDS = 7
# the thesis's anisotropic phase function (chapter 5), and its column of the table
PHASES = {"rayleigh": 0, "isotropic": 1}
# the closed form that the thesis has for each: section 4.4, and the series of section 4.3
THESIS_FORM = {"isotropic": "Weng2010:three-ei", "rayleigh": "Weng2010:taylor"}
SHORT = {"thesis": "the thesis's forms", "repaired": "Weng2010", "whole ray": "without shadow polygons"}


@dataclass(frozen=True)
class Rate:
    """One scene and phase function.

    Attributes
    ----------
    published : int                    frames a second of Table 5.1
    milliseconds : dict of (rounds,)   of whole frames, by the names of `SHORT`
    """

    scene: str
    phase: str
    published: int
    milliseconds: dict[str, Array]

    def frames_a_second(self, name: str) -> tuple[float, float, float]:
        """Median, and the interval that holds it 95 % of the time."""
        low, high = median_interval(self.milliseconds[name])
        return 1e3 / float(np.median(self.milliseconds[name])), 1e3 / high, 1e3 / low


def rates(stage: Stage) -> list[Rate]:
    """Time the frames of every row and column, each once a run."""
    return stage.once(("rates",), lambda: [_rate(stage, name, phase) for name in TABLE_5_1 for phase in PHASES])


def _rate(stage: Stage, name: str, phase: str) -> Rate:
    scene = load_within(name, TRIANGLES, (SIDE, SIDE), phase=phase)
    techniques = {
        "thesis": find_technique(THESIS_FORM[phase], **FAST),
        "repaired": find_technique("Weng2010", **FAST),
        "whole ray": find_technique("lit_intervals:unbounded+quadrature", **FASTER),
    }
    stage.tell(f"Table 5.1: {name}, {phase}")
    milliseconds: dict[str, list[float]] = {one: [] for one in techniques}
    with Renderer(scene) as renderer:
        # the first round compiles
        for number in range(ROUNDS + 1):
            for one, technique in techniques.items():
                milliseconds[one].append(renderer.frame_time(technique, number))
    timed = {one: np.array(found[1:]) for one, found in milliseconds.items()}
    return Rate(name, phase, TABLE_5_1[name][PHASES[phase]], timed)


def frame_rates(stage: Stage) -> Drawn:
    """Table 5.1."""
    from matplotlib.figure import Figure

    from experiments.atlas.timing import processor

    found = rates(stage)
    figure = Figure(figsize=(9, 4.2), layout="constrained")
    axes = figure.subplots()
    at = np.arange(len(found))
    axes.bar(at - 0.3, [one.published for one in found], 0.2, color="0.6", label="published, GeForce 9800 GT")
    colours = ("#0072b2", "#e69f00", "#009e73")
    for place, (name, label), colour in zip((-0.1, 0.1, 0.3), SHORT.items(), colours, strict=True):
        middle, low, high = np.array([one.frames_a_second(name) for one in found]).T
        bars = (middle - low, high - middle)
        axes.bar(at + place, middle, 0.2, color=colour, yerr=bars, ecolor="0.2", capsize=2, label=label)
    axes.set_xticks(at, [f"{one.scene}\n{one.phase}" for one in found], fontsize=7)
    axes.set_ylabel("frames a second")
    axes.legend(fontsize=7, frameon=False)
    lines = [
        [f"{one.scene}, {one.phase}", str(one.published)]
        + ["{:.1f} [{:.1f}, {:.1f}]".format(*one.frames_a_second(name)) for name in SHORT]
        for one in found
    ]
    text = table(["scene and phase function", "Table 5.1", *SHORT.values()], lines)
    return Drawn(
        figure,
        f"Frames a second, {SIDE} x {SIDE}, surfaces and fog, eye and light in motion. Published: GeForce 9800 GT, "
        "2008. "
        f"Here: {processor()}, {stage.gl_renderer}, meshes of {TRIANGLES:,} triangles, fog on every "
        f"{FAST['downsample']}th "
        f"pixel, {FAST['steps']} samples a ray, median of {ROUNDS} rounds with the interval that holds it 95 % of the "
        f"time. Other hardware: the columns say nothing about each other's method.\n\n{text}",
    )
