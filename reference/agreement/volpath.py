"""Mitsuba's `volpath` as a witness, and our integrator under its convention.

`volpath` walks to a light in steps and stops ShadowEpsilon (8.9e-4) of the way short of it, the last piece left without
extinction. That makes it too bright by the factor e^(sigma_t d ShadowEpsilon), d the distance to the light: +0.03 % on
`empty`, where the closed form says that we are right and it is not. And its shadow rays begin RayEpsilon (8.9e-5) times
the size of the coordinates above a surface, where ours end a ten-thousandth of the way before it: a point of a surface
that a hair of its own shades is lit for one and dark for the other. One such pixel moved the image mean of `wire_mesh`
by 0.3 % at 64 x 64. So whatever is compared with `volpath` follows both of its conventions.

It takes Mitsuba's independent sampler. The stratified one would need a fifth of the time, but its dimensions are not
independent of each other (of pairs of numbers, cells of 1/16 by 1/16 are hit 3 % too often or too seldom), and
`volpath` takes both the distance and the light's transmittance from it: in a hard spot of 24 degrees its image mean was
0.130 % too dark with an error of 0.022 %, and with the independent one 0.009 % too bright with an error of 0.038 %.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from reference.agreement.significance import smallest_bias
from reference.convergence import Estimate, Progress, converge
from reference.estimators import PILOT_SEED, Volpath
from reference.fog_path import FogPath, bounded_path, fog_of, is_bounded
from reference.goal import FEWEST_PASSES, Goal
from reference.integrator import SingleScattering, delta_emitters, mi
from scenes.model import Scene

# Samples of a pixel in a pass. A pass's mean is to be near a Gaussian, although volpath's samples are far from it:
# their deviation is up to 190 times their mean on `wire_mesh`.
MOST_SAMPLES, FEWEST_SAMPLES = 1024, 64


class AsVolpath(SingleScattering):
    """The integrator under `volpath`'s convention (:monosp:`single_scattering_as_volpath`); see the module."""

    def __init__(self, props: Any) -> None:
        super().__init__(props)
        self.light_share = 1 - mi.math.ShadowEpsilon

    def surface(self, scene: Any, ray: Any, path: FogPath, medium: Any, active: Any = True) -> Any:
        """Direct light on the surface that the ray hits, by shadow rays that begin where Mitsuba's own do."""
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
        way = si.spawn_ray_to(ds.p)
        if not bounded:
            return active & ~scene.ray_test(way, active), self.light_share * ds.dist
        walked = bounded_path(scene, way, in_fog, active)
        return active & ~walked.blocked, walked.fog_length

    def reflected(self, si: Any, ray: Any, ds: Any, active: Any) -> Any:
        """BSDF times cosine, Spectrum."""
        return si.bsdf(ray).eval(mi.BSDFContext(), si, si.to_local(ds.d), active)


mi.register_integrator("single_scattering_as_volpath", AsVolpath)


def estimate_volpath(
    scene: Scene, power: float, time_limit: float, report: Callable[[Progress], None] | None = None
) -> Estimate:
    """Run `volpath`, never from the cache, until its image mean is known well enough.

    Parameters
    ----------
    power : float         relative bias of the image mean that is to be caught
    time_limit : float    [s]; it stops there with what it has
    report : callable     called after each pass; its error is the image mean's
    """
    begin = time.perf_counter()
    estimator, estimate, wanted = Volpath(scene, _samples_in(scene, time_limit)), None, FEWEST_PASSES
    while True:
        left = time_limit - (time.perf_counter() - begin)
        if estimate and (left <= 0 or image_mean_power(estimate) <= power):
            return estimate
        reached = image_mean_error(estimate) if estimate else np.inf

        def tell(progress: Progress, reached: float = reached, wanted: int = wanted) -> None:
            seconds = time.perf_counter() - begin
            still = min(seconds * (wanted / progress.passes - 1), time_limit - seconds)
            if report:
                report(Progress(progress.passes, reached, seconds, max(still, 0.0)))

        # the number of samples ends each part, and the error of its pixels never
        limit = int(estimator.samples.mean()) * wanted
        estimate = converge(estimator, Goal(1e-12, time_limit=max(left, 1e-3), sample_limit=limit), tell, estimate)
        # half as many again at most, for the error is itself uncertain
        more = np.clip((image_mean_power(estimate) / power) ** 2 - 1, 0.05, 0.5)
        wanted = estimate.passes + int(np.ceil(estimate.passes * more))


def _samples_in(scene: Scene, time_limit: float) -> int:
    """As many samples of a pixel and pass, from MOST_SAMPLES to FEWEST_SAMPLES, as let half the time hold 32 passes."""
    pilot = Volpath(scene, FEWEST_SAMPLES)
    # the first pass compiles
    pilot.one_pass(PILOT_SEED)
    begin = time.perf_counter()
    pilot.one_pass(PILOT_SEED + 1)
    share = 0.5 * time_limit / (FEWEST_PASSES * (time.perf_counter() - begin))
    return int(np.clip(FEWEST_SAMPLES * share, FEWEST_SAMPLES, MOST_SAMPLES))


def image_mean_error(estimate: Estimate) -> float:
    """Standard error of the image mean of the composite, all channels together, relative."""
    (layer,) = estimate.image_mean
    return float(estimate.image_error[layer].mean() / estimate.image_mean[layer].mean())


def image_mean_power(estimate: Estimate) -> float:
    """Relative bias of the image mean that a comparison with the exact one would catch."""
    error, dof = image_mean_error(estimate), estimate.passes - 1.0
    return smallest_bias(np.ones(1), np.array([error]), np.array([dof]), count=1)
