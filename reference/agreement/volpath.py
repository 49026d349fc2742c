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
from reference.fog_path import bounded_path
from reference.goal import FEWEST_IN_LIMIT, FEWEST_PASSES, Goal
from reference.integrator import SingleScattering, mi
from reference.moments import BlackReferenceError, Image, tiles
from scenes.model import Scene

# Samples of a pixel in a pass. A pass's mean is to be near a Gaussian, although volpath's samples are far from it:
# their deviation is up to 190 times their mean on `wire_mesh`.
MOST_SAMPLES, FEWEST_SAMPLES = 1024, 64


class AsVolpath(SingleScattering):
    """The integrator under `volpath`'s convention (:monosp:`single_scattering_as_volpath`); see the module."""

    def __init__(self, props: Any) -> None:
        super().__init__(props)
        self.light_share = 1 - mi.math.ShadowEpsilon

    def surface_leg(self, scene: Any, si: Any, ds: Any, bounded: bool, in_fog: Any, active: Any) -> tuple[Any, Any]:
        """By shadow rays that begin where Mitsuba's own do, and end where they do."""
        way = si.spawn_ray_to(ds.p)
        if not bounded:
            return active & ~scene.ray_test(way, active), self.light_share * ds.dist
        walked = bounded_path(scene, way, in_fog, active)
        return active & ~walked.blocked, walked.fog_length


mi.register_integrator("single_scattering_as_volpath", AsVolpath)


class VolpathOfItsOwn(Volpath):
    """`volpath` with random numbers that belong to the scene and its parameters.

    With the same numbers for each, the six phase functions of a scene are off alike, and the error of what is pooled
    over them would be up to the square root of six too small.
    """

    def __init__(self, scene: Scene, samples: int) -> None:
        super().__init__(scene, samples)
        # room for 4,096 passes of one
        self._first = int(scene.digest[:4], 16) << 12

    def one_pass(self, seed: int) -> dict[str, Image]:
        """Radiance along each ray."""
        return super().one_pass(self._first + seed)


def estimate_volpath(
    scene: Scene, power: float, time_limit: float, report: Callable[[Progress], None] | None = None
) -> Estimate:
    """Run `volpath`, never from the cache, until its image mean is known well enough; of no light, zero.

    Parameters
    ----------
    power : float         relative bias of the image mean that is to be caught
    time_limit : float    [s]; it stops there with what it has
    report : callable     called after each pass; its error is the image mean's
    """
    begin = time.perf_counter()
    estimator, estimate, wanted = VolpathOfItsOwn(scene, _samples_in(scene, time_limit)), None, FEWEST_PASSES
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
        goal = Goal(1e-12, time_limit=max(left, 1e-3), sample_limit=limit)
        try:
            estimate = converge(estimator, goal, tell, estimate)
        except BlackReferenceError:
            estimate = _until_light(estimator, begin + time_limit)
        # half as many again at most, for the error is itself uncertain
        more = np.clip((image_mean_power(estimate) / power) ** 2 - 1, 0.05, 0.5)
        wanted = estimate.passes + int(np.ceil(estimate.passes * more))


def _until_light(estimator: Volpath, end: float) -> Estimate:
    """Passes from the first on until one brings light, or the time of `perf_counter` is over.

    The mean of n passes of which one is not zero has a standard error of its own size.
    """
    begin, passes, image = time.perf_counter(), 0, np.zeros((*estimator.shape, 3))
    while not image.any() and (passes < FEWEST_IN_LIMIT or time.perf_counter() < end):
        image += estimator.one_pass(passes)["composite"]
        passes += 1
    image /= passes
    pixels, blocks, whole = ({"composite": values} for values in (image, tiles(image), image.mean(axis=(0, 1))))
    return Estimate(
        mean=pixels,
        standard_error=pixels,
        tile_mean=blocks,
        tile_error=blocks,
        image_mean=whole,
        image_error=whole,
        samples=estimator.samples,
        passes=passes,
        planned_for=np.inf,
        rel_error=1.0,
        stopped_by="time",
        seconds=time.perf_counter() - begin,
    )


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
    """Standard error of the image mean of the composite, all channels together, relative; infinite of no light."""
    (layer,) = estimate.image_mean
    if not estimate.image_mean[layer].any():
        return np.inf
    return float(estimate.image_error[layer].mean() / estimate.image_mean[layer].mean())


def image_mean_power(estimate: Estimate) -> float:
    """Relative bias of the image mean that a comparison with the exact one would catch."""
    error, dof = image_mean_error(estimate), estimate.passes - 1.0
    return smallest_bias(np.ones(1), np.array([error]), np.array([dof]), count=1)
