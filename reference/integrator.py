"""A Mitsuba integrator for single scattering in a homogeneous medium, which fills space or is bounded.

Importing this module loads Mitsuba and registers the plugin `single_scattering`.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from reference.distances import equiangular_or_attenuated, even_or_attenuated, position_of, reach, shifted_strata
from reference.fog_path import FogPath, bounded_path, fog_of, is_bounded, whole_path
from scenes.errors import InputError
from scenes.mitsuba_setup import mitsuba

# Dr.Jit settles on an LLVM library when it is imported, so the choice comes first
mi = mitsuba()
import drjit as dr  # noqa: E402

# A surface must not shade itself by the rounding of its own position; a point in the fog is on no surface.
SURFACE_MARGIN = 1e-4
FOG_MARGIN = 0.0


class SingleScattering(mi.SamplingIntegrator):  # type: ignore[name-defined]
    r"""Single scattering by stratified equiangular sampling (:monosp:`single_scattering`).

    .. pluginparameters::

     * - distance_samples
       - |int|
       - Distances that are sampled for each ray and light, one in each of as many strata. (Default: 16)
     * - light_share
       - |float|
       - Share of the way from a light over which its light is attenuated. Less than 1 is wrong, and the same as
         Mitsuba's `volpath`, which stops :monosp:`ShadowEpsilon` short of the light. (Default: 1)

    The radiance of a ray is the sum of

    - `surface`: light that one reflection sends to the eye, attenuated on both legs; deterministic, since the
      lights have no extent;
    - `scattering`: light that the fog scatters once. The distance is sampled in proportion to 1 / d^2, d the distance
      to the light (Kulla and Fajardo 2012, section 4), which leaves no singularity to the estimator, and in thick fog
      part of the time in proportion to the transmittance of both legs; transmittance is analytic, for each channel,
      and visibility a shadow ray.

    AOVs hold the two parts. Point, spot and directional lights are sampled, all of them for each ray. The sensor needs
    the medium that it is in, as Mitsuba's own integrators need it. A medium fills space, or is bounded by a shape with
    a `null` BSDF that has it as its interior, as a directional light needs it. A second medium, one that is not
    homogeneous, and any other surface that lets light pass are refused. Filter and sampler place a pixel's rays.

    .. tabs::
        .. code-tab:: xml

            <integrator type="single_scattering">
                <integer name="distance_samples" value="64"/>
            </integrator>

        .. code-tab:: python

            import reference.integrator  # registers the plugin
            mi.load_dict({'type': 'single_scattering', 'distance_samples': 64})
    """

    def __init__(self, props: Any) -> None:
        super().__init__(props)
        if mi.variant().startswith("scalar"):
            # which lack the pointers to media that it is made of, and would run Python for each sample
            raise ValueError("single_scattering needs an LLVM or CUDA variant; take `volpath` with max_depth = 2.")
        self.distance_samples = props.get("distance_samples", 16)
        self.light_share = props.get("light_share", 1.0)
        if self.distance_samples < 1:
            raise ValueError(f"distance_samples is {self.distance_samples}; use a positive number.")
        if not 0 <= self.light_share <= 1:
            raise ValueError(f"light_share is {self.light_share}; use a number from 0 to 1.")

    def sample(
        self, scene: Any, sampler: Any, ray: Any, medium: Any = None, active: Any = True
    ) -> tuple[Any, Any, list[Any]]:
        """Estimate the radiance along `ray`; the interface of every Mitsuba integrator."""
        path = eye_path(scene, ray, medium, active)
        surface = self.surface(scene, ray, path, medium, active)
        scattering = self.scattering(scene, sampler, ray, path, medium, active)
        aovs = [part[channel] for part in (surface, scattering) for channel in range(3)]
        return surface + scattering, active & path.blocked, aovs

    def aov_names(self) -> list[str]:
        """Names of the AOVs, in the order in which `sample` gives them."""
        return [f"{part}.{channel}" for part in ("surface", "scattering") for channel in "RGB"]

    def surface(self, scene: Any, ray: Any, path: FogPath, medium: Any, active: Any = True) -> Any:
        """Direct light on the surface that the ray hits, as it reaches the eye after one reflection.

        Parameters
        ----------
        ray : Ray3f
        path : FogPath               of `ray`
        medium : Medium or None      the one that the camera is in

        Returns
        -------
        radiance : Spectrum
        """
        radiance, fog, bounded = mi.Spectrum(0.0), fog_of(scene, medium), is_bounded(scene)
        rest = mi.Ray3f(ray)
        rest.o, rest.maxt = ray(path.t_last), ray.maxt - path.t_last
        si = scene.ray_intersect(rest, active & path.blocked)
        hit = active & path.blocked & si.is_valid()
        for emitter in delta_emitters(scene):
            ds, weight = emitter.sample_direction(si, mi.Point2f(0.5), hit)
            lit, leg = self.surface_leg(scene, si, ds, bounded, path.ends_in_fog, hit)
            value = self.reflected(si, ray, ds, lit)
            radiance[lit] += self._attenuated(value * weight, fog, ray, path.fog_length + leg)
        return radiance

    def surface_leg(self, scene: Any, si: Any, ds: Any, bounded: bool, in_fog: Any, active: Any) -> tuple[Any, Any]:
        """Whether a light sees a surface, and over what length its light is attenuated on the way [scene unit]."""
        return self._leg(scene, ds, SURFACE_MARGIN, bounded, in_fog, active)

    def reflected(self, si: Any, ray: Any, ds: Any, active: Any) -> Any:
        """BSDF times cosine, Spectrum."""
        return si.bsdf(ray).eval(mi.BSDFContext(), si, si.to_local(ds.d), active)

    def scattering(
        self,
        scene: Any,
        sampler: Any,
        ray: Any,
        path: FogPath,
        medium: Any,
        active: Any = True,
        distance_samples: Any = None,
    ) -> Any:
        """Airlight, averaged over the strata of each light.

        Parameters
        ----------
        sampler : Sampler            one number is taken per light, and one per light and stratum
        ray : Ray3f
        path : FogPath               of `ray`
        medium : Medium or None      the one that the camera is in
        distance_samples : UInt32    strata, for each ray its own; by default the plugin's parameter

        Returns
        -------
        radiance : Spectrum
        """
        strata = mi.UInt32(self.distance_samples if distance_samples is None else distance_samples)
        # float64: a running sum of 4,096 nearly equal terms is 5e-5 off in float32, in every pass alike
        radiance = dr.zeros(mi.Color3d, dr.width(ray))
        for emitter in delta_emitters(scene):
            distance = self._distances(scene, emitter, ray, path, medium)
            stratum = shifted_strata(strata, mi.Float64(sampler.next_1d(active)))

            def one_stratum(
                number: Any,
                sampler: Any,
                total: Any,
                emitter: Any = emitter,
                distance: Any = distance,
                at: Any = stratum,
            ) -> tuple[Any, Any, Any]:
                begin, end = at(number)
                t, inverse_pdf = distance(dr.lerp(begin, end, mi.Float64(sampler.next_1d(active))))
                scattered = self.scattered(scene, emitter, ray, t, medium, active)
                return number + 1, sampler, total + mi.Color3d(scattered * inverse_pdf * mi.Float(end - begin))

            state = (dr.zeros(mi.UInt32, dr.width(ray)), sampler, radiance)
            _, _, radiance = dr.while_loop(state, lambda number, *_: active & (number < strata), one_stratum)
        return mi.Spectrum(radiance)

    def scattered(self, scene: Any, emitter: Any, ray: Any, t: Any, medium: Any, active: Any = True) -> Any:
        """Radiance per length that the fog at one distance sends to the eye, from one light.

        Parameters
        ----------
        ray : Ray3f
        t : Float                    distance from the ray's origin [scene unit]
        medium : Medium or None      the one that the camera is in

        Returns
        -------
        radiance : Spectrum    [1 / scene unit]
        """
        fog, bounded = fog_of(scene, medium), is_bounded(scene)
        mei = self._interaction(fog, ray, t)
        ds, weight = emitter.sample_direction(mei, mi.Point2f(0.5), active)
        there, through_fog = active, t
        if bounded:
            # the plugin takes bodies that are not convex too, which a ray leaves and enters again
            before = mi.Ray3f(ray)
            before.maxt = t
            so_far = bounded_path(scene, before, medium is not None, active)
            there, through_fog = active & so_far.ends_in_fog, so_far.fog_length
        lit, leg = self._leg(scene, ds, FOG_MARGIN, bounded, mi.Bool(True), there)
        phase, _ = fog.phase_function().eval_pdf(mi.PhaseFunctionContext(None), mei, ds.d, lit)
        sigma_s, _, _ = fog.get_scattering_coefficients(mei, lit)
        return dr.select(lit, self._attenuated(sigma_s * phase * weight, fog, ray, through_fog + leg), 0)

    def _distances(self, scene: Any, emitter: Any, ray: Any, path: FogPath, medium: Any) -> Any:
        """Sampler of where light is scattered: a number from 0 to 1 to distance and inverse density [scene unit]."""
        fog = fog_of(scene, medium)
        begin, end = reach(emitter, ray, path.fog_end)
        begin, end = dr.clip(begin, path.fog_begin, path.fog_end), dr.clip(end, path.fog_begin, path.fog_end)
        _, _, sigma_t = fog.get_scattering_coefficients(self._interaction(fog, ray, mi.Float(0.0)))
        if mi.has_flag(emitter.flags(), mi.EmitterFlags.DeltaPosition):
            return equiangular_or_attenuated(ray, begin, end, position_of(emitter, ray), dr.min(sigma_t))
        return even_or_attenuated(begin, end, dr.min(sigma_t))

    def _leg(self, scene: Any, ds: Any, margin: float, bounded: bool, in_fog: Any, active: Any) -> tuple[Any, Any]:
        """Whether a light sees a point, and over what length its light is attenuated on the way [scene unit]."""
        if not bounded:
            return active & sees(scene, ds, margin, active), self.light_share * ds.dist
        # all the way, for the last of it may hold the boundary; what stands in the margin is the surface itself
        path = bounded_path(scene, from_light(ds, 0.0, self.light_share), in_fog, active)
        blocked = path.blocked & (path.t_end < ds.dist * (self.light_share - margin))
        return active & ~blocked, path.fog_length

    @staticmethod
    def _interaction(medium: Any, ray: Any, t: Any) -> Any:
        mei = dr.zeros(mi.MediumInteraction3f)
        mei.t = t
        mei.p = ray(t)
        mei.wi = -ray.d
        mei.sh_frame = mi.Frame3f(mei.wi)
        mei.time = ray.time
        mei.wavelengths = ray.wavelengths
        mei.medium = mi.MediumPtr(medium)
        return mei

    def _attenuated(self, radiance: Any, medium: Any, ray: Any, distance: Any) -> Any:
        """What the medium leaves of a radiance over a distance."""
        _, _, sigma_t = medium.get_scattering_coefficients(self._interaction(medium, ray, mi.Float(0.0)))
        # in two steps: float32 has no e^(-88), but a strong light has something left there
        half = dr.exp(-0.5 * sigma_t * distance)
        return radiance * half * half

    def to_string(self) -> str:
        """Name the plugin."""
        return f"SingleScattering[distance_samples = {self.distance_samples}, light_share = {self.light_share}]"


def eye_path(scene: Any, ray: Any, medium: Any, active: Any = True) -> FogPath:
    """Follow a camera's ray to what it sees.

    Parameters
    ----------
    medium : Medium or None    the one that the camera is in
    """
    if not is_bounded(scene):
        return whole_path(scene, ray, active)
    # past the far plane too: there the ray would still leave the medium
    endless = mi.Ray3f(ray)
    endless.maxt = dr.inf
    path = bounded_path(scene, endless, medium is not None, active)
    beyond = path.t_end > ray.maxt
    clipped = bounded_path(scene, ray, medium is not None, active & beyond)
    names = [field.name for field in fields(FogPath)]
    return FogPath(**{name: dr.select(beyond, getattr(clipped, name), getattr(path, name)) for name in names})


def from_light(ds: Any, margin: float, share: float = 1.0) -> Any:
    """Ray3f from a light, or from a little before it, to just before a point.

    Parameters
    ----------
    ds : DirectionSample3f    from the point to the light
    margin : float            share of the way, before the point, in which nothing counts as an occluder
    share : float             of the way to the light, from the point on, that the ray covers
    """
    ray = dr.zeros(mi.Ray3f)
    ray.o, ray.d, ray.maxt = ds.p - ds.d * (ds.dist * (1 - share)), -ds.d, ds.dist * (share - margin)
    return mi.Ray3f(ray)


def sees(scene: Any, ds: Any, margin: float, active: Any) -> Any:
    """Tell whether a light sees a point: a ray from the light to just before it.

    Mitsuba's own shadow rays leave a gap of some 1e-4 scene units, whatever the scene's unit is; this one is a share of
    the distance.
    """
    return ~scene.ray_test(from_light(ds, margin), active)


def delta_emitters(scene: Any) -> list[Any]:
    """Return the scene's emitters, each of which must be a point or infinitely far.

    Raises
    ------
    InputError
        A light has an extent, none is there, or light from infinitely far would have to cross fog without end.
    """
    emitters = scene.emitters()
    if not emitters:
        raise InputError("The scene has no light.")
    for emitter in emitters:
        flags = emitter.flags()
        directional = mi.has_flag(flags, mi.EmitterFlags.DeltaDirection)
        if not (directional or mi.has_flag(flags, mi.EmitterFlags.DeltaPosition)):
            raise InputError(
                f"single_scattering samples point, spot and directional lights, and the scene has: {emitter}."
            )
        if directional and not is_bounded(scene):
            raise InputError("A directional light needs a medium that a shape with a null BSDF holds.")
    return emitters


mi.register_integrator("single_scattering", SingleScattering)
