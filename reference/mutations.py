"""The main estimator spoilt on purpose: what the agreement tests must notice, or they are worth nothing.

Each mutation is an integrator of `reference/agreement/spoilt.py`, but for the lights that are moved. It counts as
noticed by a test that the right estimate passes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace

import numpy as np

import analytic
from reference.agreement.comparison import Comparison, compare
from reference.agreement.measured import Witness, exact_witness, witness
from reference.agreement.spoilt import (
    HG,
    Denser,
    ForwardHG,
    Mirrored,
    MirroredHG,
    NextStep,
    NoCosine,
    NoEyeLeg,
    NoFog,
    NoLightLeg,
)
from reference.agreement.unseen import unseen_variance
from reference.agreement.volpath import AsVolpath
from reference.agreement.witnesses import Report, Witnesses, estimate_deterministic, estimate_equiangular
from reference.deterministic import Deterministic
from reference.estimators import Equiangular
from reference.integrator import mi
from reference.mitsuba_scene import instantiate
from scenes.model import Scene

# of a phase function's largest value: what sets forward and backward apart must be more
EVEN = 0.1


@contextmanager
def moved_lights(scene: Scene) -> Iterator[None]:
    """Move each light for a while: what is instantiated from one loaded scene is shared.

    By 1 % of its distance from the middle of what the camera sees, along the camera's upward axis; parallel light is
    turned by 0.01 rad about the camera's viewing axis.
    """
    mitsuba_scene = instantiate(scene).scene
    origin, direction, t_max = scene.camera.rays()
    ends = t_max.copy()
    ray = mi.Ray3f(mi.Point3f(origin.reshape(-1, 3).T), mi.Vector3f(direction.reshape(-1, 3).T))
    ends = np.minimum(t_max.ravel(), np.array(mitsuba_scene.ray_intersect_preliminary(ray).t)).reshape(t_max.shape)
    middle = (origin + 0.5 * ends[..., None] * direction).mean(axis=(0, 1))
    up, axis = scene.camera.to_world[:3, 1], scene.camera.to_world[:3, 2]
    before = []
    for emitter, light in zip(mitsuba_scene.emitters(), scene.lights, strict=True):
        parameters = mi.traverse(emitter)
        key = "position" if "position" in parameters else "to_world"
        before.append((parameters, key, type(parameters[key])(parameters[key])))
        shift = 0.01 * np.linalg.norm(light.position - middle) * up
        if key == "position":
            parameters[key] = parameters[key] + mi.Vector3f(shift.tolist())
        elif light.kind == "directional":
            parameters[key] = mi.Transform4f().rotate(axis.tolist(), float(np.degrees(0.01))) @ parameters[key]
        else:
            parameters[key] = mi.Transform4f().translate(shift.tolist()) @ parameters[key]
        parameters.update()
    try:
        yield
    finally:
        for parameters, key, value in before:
            parameters[key] = value
            parameters.update()


def _always(scene: Scene, witnesses: Witnesses) -> str:
    return ""


def _needs_shadow(scene: Scene, witnesses: Witnesses) -> str:
    return "" if witnesses.unseen.has_shadow else "nothing shades the fog that is seen"


def _needs_surface(scene: Scene, witnesses: Witnesses) -> str:
    return "" if witnesses.unseen.has_surface else "no surface is seen"


@dataclass(frozen=True)
class Mutation:
    """One way to spoil the estimator.

    Attributes
    ----------
    name : str
    meaning : str          for the table
    integrator : type      what takes the place of the right one
    idle : callable        scene and witnesses to the reason why it cannot matter, decided without its result; ""
    around : callable      what else is changed while it runs
    """

    name: str
    meaning: str
    integrator: type[AsVolpath]
    idle: Callable[[Scene, Witnesses], str] = _always
    around: Callable[[Scene], AbstractContextManager[None]] = lambda scene: nullcontext()


MIRROR = Mutation("g -> -g", "the phase function mirrored", Mirrored)
NO_FOG = Mutation("no medium", "rendered without fog, as Mitsuba does without the sensor's medium", NoFog)
MUTATIONS = (
    MIRROR,
    Mutation("sigma_t + 1 %", "at the same albedo, so sigma_s + 1 % too", Denser),
    Mutation("light moved by 1 %", "of its distance from what is seen", AsVolpath, around=moved_lights),
    Mutation("no loss to the eye", "the eye's leg without transmittance", NoEyeLeg),
    Mutation("no loss from the light", "the light's leg without transmittance", NoLightLeg),
    NO_FOG,
    Mutation("visibility off by one", "looked up one of 64 strata further along the ray", NextStep, _needs_shadow),
    Mutation("no cosine", "surfaces without the cosine", NoCosine, _needs_surface),
)


@dataclass(frozen=True)
class Outcome:
    """What the tests said of a mutation.

    Attributes
    ----------
    mutation : Mutation
    meaning : str                       of the mutation in this scene
    comparisons : tuple of Comparison   with each witness that it is held against; none where it is idle
    controls : tuple of Comparison      of the right estimate with the same witnesses
    idle : str                          why it cannot matter in this scene; "" where it can
    """

    mutation: Mutation
    meaning: str
    comparisons: tuple[Comparison, ...]
    controls: tuple[Comparison, ...]
    idle: str

    @property
    def noticed_by(self) -> tuple[tuple[str, ...], ...]:
        """Names of the tests of each comparison that fail it, and pass what is not spoilt."""
        return tuple(
            tuple(
                spoilt.test
                for spoilt, right in zip(comparison.verdicts, control.verdicts, strict=True)
                if right.agrees and not spoilt.agrees
            )
            for comparison, control in zip(self.comparisons, self.controls, strict=True)
        )

    @property
    def noticed(self) -> bool:
        """Whether any test fails it and passes what is not spoilt."""
        return any(self.noticed_by)


def try_mutation(mutation: Mutation, scene: Scene, witnesses: Witnesses, report: Report | None = None) -> Outcome:
    """Compare a spoilt estimate with the right witnesses, the deterministic mode and `volpath`."""
    if idle := mutation.idle(scene, witnesses):
        return Outcome(mutation, mutation.meaning, (), (), idle)
    integrator, meaning = mutation.integrator, mutation.meaning
    truths: tuple[Witness, ...] = witnesses.composite[1:]
    right = witnesses.composite[0]
    if mutation is MIRROR and is_even(scene):
        integrator = MirroredHG
        meaning += f"; both sides take HG {HG}, for the scene's {scene.phase.name} is even"
        truths = (_with_hg(scene, witnesses),)
        right = _spoilt_witness(mutation, ForwardHG, scene, witnesses, report)
    spoilt = _spoilt_witness(mutation, integrator, scene, witnesses, report)
    comparisons, controls = (tuple(compare(one, truth) for truth in truths) for one in (spoilt, right))
    return Outcome(mutation, meaning, comparisons, controls, "")


def is_even(scene: Scene) -> bool:
    """Whether the phase function is so nearly even that mirroring it is no mutation."""
    p = scene.phase.evaluate(np.linspace(-1, 1, 201))
    return bool(np.abs(p - p[::-1]).max() < EVEN * p.max())


def _spoilt_witness(
    mutation: Mutation, integrator: type[AsVolpath], scene: Scene, witnesses: Witnesses, report: Report | None
) -> Witness:
    plugin = "single_scattering_as_volpath" if integrator is AsVolpath else f"single_scattering_{integrator.__name__}"
    with mutation.around(scene):
        if mutation is NO_FOG:
            # nothing to sample, and an estimate of nothing is an error of its own
            estimator = Equiangular(scene)
            estimator.integrator = mi.load_dict({"type": plugin})
            return exact_witness(mutation.name, estimator.fixed()["surface"])
        estimate, surface = estimate_equiangular(scene, plugin, report)
    unseen = unseen_variance(witnesses.unseen.equiangular, estimate.samples * estimate.passes)
    if issubclass(integrator, ForwardHG):
        unseen *= _brightening(scene) ** 2
    return witness(mutation.name, estimate, unseen, surface)


def _with_hg(scene: Scene, witnesses: Witnesses) -> Witness:
    """The deterministic mode with the phase function of ForwardHG."""
    other = replace(scene, phase=analytic.phase("hg", g=HG))
    estimate = estimate_deterministic(other, 1 - mi.math.ShadowEpsilon)
    doubt = _brightening(scene) ** 2 * witnesses.doubt
    return witness(Deterministic.name, estimate, doubt, witnesses.surface_as_volpath)


def _brightening(scene: Scene) -> float:
    """How much more of the light ForwardHG scatters than the scene's even phase function, at most."""
    cosine = np.linspace(-1, 1, 201)
    return float((analytic.phase("hg", g=HG).evaluate(cosine) / scene.phase.evaluate(cosine)).max())
