"""Integrators that are wrong on purpose, each in one way, under `volpath`'s convention.

They are registered as :monosp:`single_scattering_` with the name of the class.
"""

from __future__ import annotations

from typing import Any

from reference.agreement.volpath import AsVolpath
from reference.fog_path import FogPath, bounded_path, fog_of, is_bounded
from reference.integrator import FOG_MARGIN, mi

# isort: split
import drjit as dr  # after the integrator, which chose Dr.Jit's LLVM

# strata of a ray, by one of which the visibility is off
STEPS = 64
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


class ForwardHG(AsVolpath):
    """Henyey-Greenstein with g = 0.6 in the place of the scene's even phase function."""

    g = HG

    def scattered(self, scene: Any, emitter: Any, ray: Any, t: Any, medium: Any, active: Any = True) -> Any:
        """Change the phase function."""
        fog = fog_of(scene, medium)
        mei = self._interaction(fog, ray, t)
        ds, _ = emitter.sample_direction(mei, mi.Point2f(0.5), active)
        context = mi.PhaseFunctionContext(None)
        even, _ = fog.phase_function().eval_pdf(context, mei, ds.d, active)
        other, _ = mi.load_dict({"type": "hg", "g": self.g}).eval_pdf(context, mei, ds.d, active)
        return super().scattered(scene, emitter, ray, t, medium, active) * other / even


class MirroredHG(ForwardHG):
    """The same with the wrong sign."""

    g = -HG


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


for _integrator in (Mirrored, ForwardHG, MirroredHG, Denser, NoEyeLeg, NoLightLeg, NoFog, NextStep, NoCosine):
    mi.register_integrator(f"single_scattering_{_integrator.__name__}", _integrator)
