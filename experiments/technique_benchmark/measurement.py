"""One scene: every contender's error, work, memory and time, the times in rounds that run each of them once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from experiments.metrics import Metrics, measure
from experiments.technique_benchmark.contenders import AS_DENSE, BASELINE, BOUNDED, Contender
from experiments.technique_benchmark.intervals import Array
from experiments.technique_benchmark.spacing import steps_as_dense
from gpu_impl.device import Device, shared_device
from gpu_impl.memory import Footprint, footprint
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import Technique
from gpu_impl.timing import PassClock
from reference.estimate import Reference
from scenes.errors import InputError
from scenes.model import Scene

SEED = 51


@dataclass(frozen=True)
class Measured:
    """What was measured of one contender in one scene.

    Attributes
    ----------
    refusal : str                   why it cannot draw the scene, in its own words; empty where it does, and of one that
                                    does not the rest means nothing
    metrics : Metrics               errors of the scattering layer, at the size that is timed
    counts : dict                   means over the rays that are evaluated, by the names of `COUNTERS`
    rays : int                      how many these are
    milliseconds : (rounds,)        wall clock of whole frames
    clocked : (rounds,)             the same of frames with a clock at each pass
    passes : dict of (rounds,)      what that clock says [ms]
    """

    contender: Contender
    technique: Technique
    refusal: str = ""
    metrics: Metrics | None = None
    footprint: Footprint | None = None
    counts: dict[str, float] = field(default_factory=dict)
    rays: int = 0
    milliseconds: Array = field(default_factory=lambda: np.empty(0))
    clocked: Array = field(default_factory=lambda: np.empty(0))
    passes: dict[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class Result:
    """One scene with its phase function.

    Attributes
    ----------
    contenders : dict    by the contenders' names, in their order
    clock : str          how passes were timed; see `gpu_impl.timing.PassClock`
    """

    scene: Scene
    reference: Reference
    contenders: dict[str, Measured]
    clock: str

    def ratios(self, name: str, to: str = BASELINE.name) -> Array:
        """Time of a contender over that of another in the same round, (rounds,); both draw the scene."""
        return self.contenders[name].milliseconds / self.contenders[to].milliseconds


def measure_scene(
    scene: Scene,
    reference: Reference,
    rounds: int,
    tell: Callable[[str], None],
    contenders: Sequence[Contender],
) -> Result:
    """Measure every contender that can draw the scene; nothing else may run meanwhile.

    Parameters
    ----------
    reference : Reference    of the scene, estimated before
    rounds : int             that count; one more is run before them
    tell : callable          told what is being done
    contenders : the baseline among them
    """
    device = shared_device()
    found = {one.name: _prepared(one, scene) for one in contenders}
    with Renderer(scene, device) as renderer:
        for name, one in found.items():
            if one.refusal:
                continue
            tell(f"errors and counts, {name}")
            if name == AS_DENSE:
                dense = steps_as_dense(renderer, found[BOUNDED].technique)
                one = replace(one, technique=replace(one.technique, steps=dense))
            frame = renderer.render(one.technique)
            counts = renderer.counts(one.technique)
            found[name] = replace(
                one,
                metrics=measure(frame.scattering, reference.scattering, reference.standard_error("scattering")),
                counts={counter: float(count.mean()) for counter, count in counts.items()},
                rays=next(iter(counts.values())).size,
            )
    for name, one in found.items():
        if not one.refusal:
            tell(f"memory and set-up, {name}")
            found[name] = replace(one, footprint=footprint(scene, one.technique, device))
    drawn = {name: one.technique for name, one in found.items() if not one.refusal}
    times = time_in_rounds(scene, device, drawn, rounds, tell)
    timed = {name: replace(one, **times.get(name, {})) for name, one in found.items()}
    return Result(scene, reference, timed, PassClock(device).method)


def _prepared(contender: Contender, scene: Scene) -> Measured:
    technique = contender.find()
    try:
        technique.check_scene(scene)
    except InputError as error:
        return Measured(contender, technique, refusal=str(error))
    return Measured(contender, technique)


def time_in_rounds(
    scene: Scene, device: Device, techniques: dict[str, Technique], rounds: int, tell: Callable[[str], None]
) -> dict[str, dict]:
    """Time all techniques once a round, in an order drawn anew, so that whatever slows the machine down meets them all.

    Each draws the same frame of the same motion twice: with nothing but the whole timed, and with a clock at each pass,
    which comes first in every other round. The first round, in which shaders are compiled, does not count.

    Returns
    -------
    dict of dict
        `milliseconds`, `clocked` and `passes` of `Measured`, by the techniques' names.
    """
    order = np.random.default_rng(SEED)
    plain: dict[str, list[float]] = {name: [] for name in techniques}
    clocked: dict[str, list[float]] = {name: [] for name in techniques}
    passes: dict[str, list[dict[str, float]]] = {name: [] for name in techniques}
    clock = PassClock(device)
    with Renderer(scene, device) as renderer:
        for number in range(rounds + 1):
            tell(f"round {number} of {rounds}")
            for name in order.permutation(list(techniques)).tolist():
                for with_clock in (False, True) if number % 2 == 0 else (True, False):
                    if with_clock:
                        clocked[name].append(renderer.frame_time(techniques[name], number, clock))
                        passes[name].append(clock.milliseconds())
                    else:
                        plain[name].append(renderer.frame_time(techniques[name], number))
    return {
        name: {
            "milliseconds": np.array(plain[name][1:]),
            "clocked": np.array(clocked[name][1:]),
            "passes": {one: np.array([found[one] for found in passes[name][1:]]) for one in passes[name][0]},
        }
        for name in techniques
    }
