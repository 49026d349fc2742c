"""The airlight without Monte Carlo: lit intervals found by ray casting, and float64 quadrature on them."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from reference.convergence import Estimate, relative_error
from reference.deterministic.kinks import Stretches
from reference.deterministic.lit_intervals import STEPS, LitIntervals, Search, search
from reference.deterministic.piece_airlight import piece_airlight
from reference.deterministic.ray_spans import Array, Rays
from reference.deterministic.scattered_light import ScatteredLight
from reference.deterministic.shadow_rays import ShadowRays
from reference.estimators import Equiangular
from reference.moments import Image, check_finite, tiles
from scenes.model import Scene

# of the pixels and channels at which the relative error is stated, as `Goal` does by default
PERCENTILE = 95.0


class Deterministic:
    """A witness that shares with the estimator the surfaces, as Mitsuba's rays meet them, and nothing else.

    Camera, lights, fog and phase function are those of the loaded scene, evaluated in float64. A pixel's error is the
    sum, in absolute values since nothing in it is independent, of

    - how far the ends of its intervals may be off, times the light that is scattered there;
    - what the last doubling of the probes changed, where it still changed something (see `lit_intervals.search`);
    - the difference of the quadrature's two rules.

    It knows nothing of an interval that no probe met (see `search` for how often that is). Elsewhere it was larger than
    what was off, by 1.1 times or more, in every pixel of the shipped scenes that have a closed form. Light on surfaces
    is the estimator's own, one ray a pixel.

    Parameters
    ----------
    scene : Scene
    light_share : float    of the way from a light over which its light is attenuated, as in `SingleScattering`
    steps : tuple of int   between the probes of a ray; see `search`
    """

    name = "deterministic"
    version = 2
    pixel_filter = "centre"
    layers: tuple[str, ...] = ("scattering",)

    def __init__(self, scene: Scene, light_share: float = 1.0, steps: tuple[int, ...] = STEPS) -> None:
        self._scene, self._light_share, self._steps = scene, light_share, steps
        self._shadow_rays = ShadowRays(scene)
        self._rays = Rays.of_camera(scene, self._shadow_rays.t_end())

    def estimate(self) -> Estimate:
        """Both layers, with numerical errors in place of standard errors, and steps between probes as samples.

        Raises
        ------
        NotFiniteError
            The camera looks straight into a light, where airlight is infinite.
        BlackReferenceError
            The airlight is zero everywhere.
        """
        begin = time.perf_counter()
        found = self._search()
        mean, error = self._scattering(found)
        check_finite("scattering", mean)
        surface = Equiangular(self._scene, light_share=self._light_share).fixed()["surface"]
        means, errors = {"scattering": mean, "surface": surface}, {"scattering": error, "surface": 0 * surface}
        return Estimate(
            mean=means,
            standard_error=errors,
            tile_mean={layer: tiles(image) for layer, image in means.items()},
            tile_error={layer: tiles(image) for layer, image in errors.items()},
            image_mean={layer: image.mean(axis=(0, 1)) for layer, image in means.items()},
            image_error={layer: image.mean(axis=(0, 1)) for layer, image in errors.items()},
            samples=found.steps.reshape(mean.shape[:2]),
            passes=0,
            planned_for=0.0,
            rel_error=relative_error(mean, error, PERCENTILE),
            stopped_by="exact",
            seconds=time.perf_counter() - begin,
        )

    def scattering(self) -> tuple[Image, Image]:
        """Airlight and its error, (H, W, 3) each."""
        return self._scattering(self._search())

    def _search(self) -> Search:
        return search(self._shadow_rays, self._rays, self._scene, self._steps)

    def _scattering(self, found: Search) -> tuple[Image, Image]:
        value, error = self._airlight(found.intervals, np.ones_like(found.open))
        before, _ = self._airlight(found.before, found.open)
        error[found.open] += np.abs(value - before)[found.open]
        shape = (self._scene.camera.height, self._scene.camera.width, 3)
        return value.reshape(shape), error.reshape(shape)

    def _airlight(self, intervals: LitIntervals, pixels: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Airlight of some pixels and its error, (pixels, 3) each; 0 in the others."""
        value, error = np.zeros((pixels.size, 3)), np.zeros((pixels.size, 3))
        for number, light in enumerate(self._scene.lights):
            scattered = ScatteredLight(self._scene, light, self._light_share, self._shadow_rays.parallel_way)
            lit = intervals.pieces_of(number, pixels)
            stretches = Stretches(lit.ray, lit.begin, lit.end)
            more, numerical = piece_airlight(self._scene, light, scattered, self._rays, stretches)
            ends = np.stack([lit.begin, lit.end], axis=-1)
            off = np.stack([lit.begin_error, lit.end_error], axis=-1)[..., None]
            value += more
            error += numerical
            np.add.at(error, lit.ray, (scattered.density(self._rays[lit.ray], ends) * off).sum(axis=1))
        return value, error
