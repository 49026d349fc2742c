"""The main estimator spoilt on purpose: what the agreement tests must notice, or they are worth nothing.

Each mutation is an integrator, a subclass of the one under `volpath`'s convention, but for the lights that are moved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import analytic
from reference.agreement.comparison import Comparison, compare
from reference.agreement.measured import Witness, exact_witness, witness
from reference.agreement.unseen import unseen_variance
from reference.agreement.volpath import AsVolpath
from reference.agreement.witnesses import Report, Witnesses, estimate_deterministic, estimate_equiangular
from reference.deterministic import Deterministic
from reference.estimators import Equiangular
from reference.fog_path import FogPath, bounded_path, fog_of, is_bounded
from reference.integrator import FOG_MARGIN, mi
from reference.mitsuba_scene import instantiate
from scenes.model import Scene

# isort: split
import drjit as dr  # after the integrator, which chose Dr.Jit's LLVM

# strata of a ray, by one of which the visibility is off
STEPS = 64
# of a phase function's largest value: what sets forward and backward apart must be more
EVEN = 0.1
# takes the place of a phase function for which g -> -g would change nothing
HG = 0.6


class Mirrored(AsVolpath):
    """Scatters backward what it should scatter forward."""

    @staticmethod
    def _interaction(medium: Any, ray: Any, t: Any) -> Any:
        mei = AsVolpath._interaction(medium, ray, t)
        # only the phase function asks where the ray came from
        mei.wi = -mei.wi
        return mei


class MirroredHG(AsVolpath):
    """Henyey-Greenstein with g = -0.6 in the place of the scene's even phase function."""

    g = -HG

    def scattered(self, scene: Any, emitter: Any, ray: Any, t: Any, medium: Any, active: Any = True) -> Any:
        """Change the phase function."""
        fog = fog_of(scene, medium)
        mei = self._interaction(fog, ray, t)
        ds, _ = emitter.sample_direction(mei, mi.Point2f(0.5), active)
        context = mi.PhaseFunctionContext(None)
        even, _ = fog.phase_function().eval_pdf(context, mei, ds.d, active)
        other, _ = mi.load_dict({"type": "hg", "g": self.g}).eval_pdf(context, mei, ds.d, active)
        return super().scattered(scene, emitter, ray, t, medium, active) * other / even


class Denser(AsVolpath):
    """One per cent more extinction, and by the same albedo one per cent more scattering."""

    def scattered(self, scene: Any, emitter: Any, ray: Any, t: Any, medium: Any, active: Any = True) -> Any:
        """Raise sigma_s."""
        return 1.01 * super().scattered(scene, emitter, ray, t, medium, active)

    def _attenuated(self, radiance: Any, medium: Any, ray: Any, distance: Any) -> Any:
        return super()._attenuated(radiance, medium, ray, 1.01 * distance)


class NoEyeLeg(AsVolpath):
    """Nothing is lost between fog or surface and the eye."""

    def scattered(self, scene: Any, emitter: Any, ray: Any, t: Any, medium: Any, active: Any = True) -> Any:
        """Find how long the eye's leg is."""
        before = mi.Ray3f(ray)
        before.maxt = t
        self._eye_leg = bounded_path(scene, before, medium is not None, active).fog_length if is_bounded(scene) else t
        return super().scattered(scene, emitter, ray, t, medium, active)

    def surface(self, scene: Any, ray: Any, path: FogPath, medium: Any, active: Any = True) -> Any:
        """Find how long the eye's leg is."""
        self._eye_leg = path.fog_length
        return super().surface(scene, ray, path, medium, active)

    def _attenuated(self, radiance: Any, medium: Any, ray: Any, distance: Any) -> Any:
        return super()._attenuated(radiance, medium, ray, distance - self._eye_leg)


class NoLightLeg(AsVolpath):
    """Nothing is lost between light and fog or surface."""

    def _leg(self, *arguments: Any) -> tuple[Any, Any]:
        return super()._leg(*arguments)[0], mi.Float(0.0)

    def surface_leg(self, *arguments: Any) -> tuple[Any, Any]:
        """Keep the visibility alone."""
        return super().surface_leg(*arguments)[0], mi.Float(0.0)


class NoFog(AsVolpath):
    """What Mitsuba's integrators draw where the medium is left out of the sensor, without a word."""

    def _attenuated(self, radiance: Any, medium: Any, ray: Any, distance: Any) -> Any:
        return radiance


class NextStep(AsVolpath):
    """Visibility looked up one of 64 strata further along the ray."""

    def _distances(self, scene: Any, emitter: Any, ray: Any, path: FogPath, medium: Any) -> Any:
        distance = super()._distances(scene, emitter, ray, path, medium)

        def remember(u: Any) -> tuple[Any, Any]:
            self._next, _ = distance(dr.minimum(u + 1 / STEPS, 1.0))
            return distance(u)

        return remember

    def scattered(self, scene: Any, emitter: Any, ray: Any, t: Any, medium: Any, active: Any = True) -> Any:
        """Take the light's way of here and the shadow of there."""
        mei = self._interaction(fog_of(scene, medium), ray, self._next)
        there, _ = emitter.sample_direction(mei, mi.Point2f(0.5), active)
        self._there = super()._leg(scene, there, FOG_MARGIN, is_bounded(scene), mi.Bool(True), active)[0]
        return super().scattered(scene, emitter, ray, t, medium, active)

    def _leg(self, scene: Any, ds: Any, margin: float, bounded: bool, in_fog: Any, active: Any) -> tuple[Any, Any]:
        _, length = super()._leg(scene, ds, margin, bounded, in_fog, active)
        return active & self._there, length


class NoCosine(AsVolpath):
    """Surfaces as bright as if each faced the light."""

    def reflected(self, si: Any, ray: Any, ds: Any, active: Any) -> Any:
        """Divide by the cosine."""
        return super().reflected(si, ray, ds, active) / dr.maximum(si.to_local(ds.d).z, 1e-3)


for _integrator in (Mirrored, MirroredHG, Denser, NoEyeLeg, NoLightLeg, NoFog, NextStep, NoCosine):
    mi.register_integrator(f"single_scattering_{_integrator.__name__}", _integrator)


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
    idle : str                          why it cannot matter in this scene; "" where it can
    """

    mutation: Mutation
    meaning: str
    comparisons: tuple[Comparison, ...]
    idle: str

    @property
    def noticed(self) -> bool:
        """Whether any test fails it."""
        return any(not comparison.agrees for comparison in self.comparisons)


def try_mutation(mutation: Mutation, scene: Scene, witnesses: Witnesses, report: Report | None = None) -> Outcome:
    """Compare a spoilt estimate with the right witnesses, the deterministic mode and `volpath`."""
    if idle := mutation.idle(scene, witnesses):
        return Outcome(mutation, mutation.meaning, (), idle)
    integrator, meaning = mutation.integrator, mutation.meaning
    truths: tuple[Witness, ...] = witnesses.composite[1:]
    if mutation is MIRROR and is_even(scene):
        integrator = MirroredHG
        meaning += f"; both sides take HG {HG}, for the scene's {scene.phase.name} is even"
        truths = (_with_hg(scene, witnesses),)
    spoilt = _spoilt_witness(mutation, integrator, scene, witnesses, report)
    return Outcome(mutation, meaning, tuple(compare(spoilt, truth) for truth in truths), "")


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
    return witness(mutation.name, estimate, unseen, surface)


def _with_hg(scene: Scene, witnesses: Witnesses) -> Witness:
    """The deterministic mode with the phase function that MirroredHG mirrors."""
    estimate = estimate_deterministic(replace(scene, phase=analytic.phase("hg", g=HG)), 1 - mi.math.ShadowEpsilon)
    return witness(Deterministic.name, estimate, surface=witnesses.surface_as_volpath)
