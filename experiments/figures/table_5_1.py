"""Table 5.1: frames a second as published, beside frames that are timed here, all in one run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from experiments.figures.entry import Drawn
from experiments.figures.stage import Stage
from experiments.intervals import FEWEST_ROUNDS, Array, median_interval
from experiments.markdown import table
from experiments.palette import OKABE_ITO
from experiments.renderers import open_renderer
from experiments.rounds import time_in_rounds
from experiments.technique_benchmark.budget import load_within
from experiments.technique_benchmark.contenders import FAST, TABLE_5_1
from gpu_impl.techniques import find_technique

# as the thesis's frames; its meshes' triangles are not stated
SIDE = 1024
TRIANGLES = 20_000
# the fewest whose smallest and largest enclose the median 95 % of the time
ROUNDS = FEWEST_ROUNDS
# the thesis's anisotropic phase function (chapter 5), and its column of the table
PHASES = {"rayleigh": 0, "isotropic": 1}
TIMED = {"printed": "Weng2010:printed", "repaired": "Weng2010"}


@dataclass(frozen=True)
class Rate:
    """One scene and phase function.

    Attributes
    ----------
    published : int                    frames a second of Table 5.1
    milliseconds : dict of (rounds,)   of whole frames, by the names of `TIMED`
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
    techniques = {short: find_technique(technique, **FAST) for short, technique in TIMED.items()}
    with open_renderer(scene) as renderer:
        times = time_in_rounds(
            renderer,
            techniques,
            ROUNDS,
            lambda what: stage.tell(f"Table 5.1: {name}, {phase}, {what}"),
            passes_too=False,
        )
    timed = {short: found.milliseconds for short, found in times.items()}
    return Rate(name, phase, TABLE_5_1[name][PHASES[phase]], timed)


def frame_rates(stage: Stage) -> Drawn:
    """Table 5.1."""
    from matplotlib.figure import Figure

    from experiments.atlas.timing import processor

    found = rates(stage)
    figure = Figure(figsize=(9, 4.2), layout="constrained")
    axes = figure.subplots()
    at = np.arange(len(found))
    axes.bar(at - 0.25, [one.published for one in found], 0.25, color="0.6", label="published, GeForce 9800 GT")
    for place, (name, label), colour in zip((0, 0.25), TIMED.items(), OKABE_ITO, strict=False):
        middle, low, high = np.array([one.frames_a_second(name) for one in found]).T
        bars = (middle - low, high - middle)
        axes.bar(at + place, middle, 0.25, color=colour, yerr=bars, ecolor="0.2", capsize=2, label=label)
    axes.set_xticks(at, [f"{one.scene}\n{one.phase}" for one in found], fontsize=7)
    axes.set_ylabel("frames a second")
    axes.legend(fontsize=7, frameon=False)
    lines = [
        [f"{one.scene}, {one.phase}", str(one.published)]
        + ["{:.1f} [{:.1f}, {:.1f}]".format(*one.frames_a_second(name)) for name in TIMED]
        for one in found
    ]
    text = table(["scene and phase function", "Table 5.1", *TIMED.values()], lines)
    return Drawn(
        figure,
        f"Frames a second, {SIDE} x {SIDE}, surfaces and fog, eye and light in motion. Published: GeForce 9800 GT, "
        "2008. "
        f"Here: {processor()}, {stage.gl_renderer}, meshes of {TRIANGLES:,} triangles, fog on every "
        f"{FAST['downsample']}th "
        f"pixel, {FAST['steps']} samples a ray, median of {ROUNDS} rounds with the interval that holds it 95 % of the "
        "time; as printed the pictures are wrong, however fast they are. Other hardware: the published column says "
        f"nothing about the others' method.\n\n{text}",
    )
