"""One scene: every contender's error, work, memory and time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from experiments.intervals import Array
from experiments.metrics import Metrics, measure
from experiments.rounds import Times, time_in_rounds
from experiments.technique_benchmark.contenders import AS_DENSE, BASELINE, BOUNDED, Contender
from experiments.technique_benchmark.spacing import steps_as_dense
from gpu_impl.device import shared_device
from gpu_impl.memory import Footprint, footprint
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import Technique
from gpu_impl.timing import PassClock
from reference.estimate import Reference
from scenes.errors import InputError
from scenes.model import Scene


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
    times : Times                   what the clocks said
    """

    contender: Contender
    technique: Technique
    refusal: str = ""
    metrics: Metrics | None = None
    footprint: Footprint | None = None
    counts: dict[str, float] = field(default_factory=dict)
    rays: int = 0
    times: Times = field(default_factory=Times)


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
        return self.contenders[name].times.milliseconds / self.contenders[to].times.milliseconds


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
                metrics=measure(frame.scattering, reference.scattering, reference.noise("scattering")),
                counts={counter: float(count.mean()) for counter, count in counts.items()},
                rays=next(iter(counts.values())).size,
            )
    for name, one in found.items():
        if not one.refusal:
            tell(f"memory and set-up, {name}")
            found[name] = replace(one, footprint=footprint(scene, one.technique, device))
    drawn = {name: one.technique for name, one in found.items() if not one.refusal}
    with Renderer(scene, device) as renderer:
        times = time_in_rounds(renderer, drawn, rounds, tell)
    timed = {name: replace(one, times=times.get(name, Times())) for name, one in found.items()}
    return Result(scene, reference, timed, PassClock(device).method)


def _prepared(contender: Contender, scene: Scene) -> Measured:
    technique = contender.find()
    try:
        technique.check_scene(scene)
    except InputError as error:
        return Measured(contender, technique, refusal=str(error))
    return Measured(contender, technique)
