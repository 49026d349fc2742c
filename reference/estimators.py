"""Estimators of the truth: each gives independent passes over the image, whose spread is its error bar."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from reference.film_volpath import FilmVolpath
from reference.goal import Goal, PixelFilter
from reference.integrator import eye_path, mi
from reference.mitsuba_scene import instantiate
from reference.moments import Image
from reference.plan import PILOT_STRATA, plan_strata
from scenes.model import Scene

# isort: split
import drjit as dr  # after the integrator, which chose Dr.Jit's LLVM

# one kernel traces at most so many rays, which bounds its memory to a few hundred MB, and takes at most so many
# samples, which bounds how long Ctrl-C waits to a few seconds
WAVEFRONT, SAMPLES = 1 << 22, 1 << 24
# of pilot passes, far from those that count
PILOT_SEED = 1 << 20


class Estimator(Protocol):
    """What convergence needs of an estimator.

    Attributes
    ----------
    name : str
    version : int              raised when its results change, so that cached ones are not taken for new ones
    pixel_filter : str         "centre" for rays through pixel centres, "box" for averages over pixels
    layers : tuple of str      what a pass estimates; the first decides when the goal is met
    samples : (H, W)           taken of each pixel in a pass
    """

    name: str
    version: int
    pixel_filter: PixelFilter
    layers: tuple[str, ...]
    samples: NDArray[np.uint32]

    def plan(self, goal: Goal) -> float:
        """Choose `samples`, and return the relative error that they are for."""

    def fixed(self) -> dict[str, Image]:
        """Layers that need no sampling, (H, W, 3) each."""

    def one_pass(self, seed: int) -> dict[str, Image]:
        """One independent estimate of each layer, (H, W, 3)."""


class PixelRays:
    """Rays through pixels, in wavefronts of bounded size.

    Parameters
    ----------
    samples : int          of each pixel in a pass
    rays_per_pixel : int   which share them
    pixel_filter : str     whether they go through the pixel's centre or are stratified over it: then a square number
    """

    def __init__(self, scene: Scene, samples: int, rays_per_pixel: int, pixel_filter: PixelFilter) -> None:
        self.mitsuba = instantiate(scene)
        self.shape = (scene.camera.height, scene.camera.width)
        self.samples = np.full(self.shape, samples, np.uint32)
        self.rays_per_pixel = rays_per_pixel
        self.pixel_filter = pixel_filter
        self.sampler = mi.load_dict({"type": "independent"})

    def rays(self, pixel: Any, place: Any = (0.5, 0.5)) -> Any:
        """Mitsuba's own rays through pixels given by their index in row order, at a place from 0 to 1 inside each."""
        height, width = self.shape
        position = mi.Point2f((pixel % width + place[0]) / width, (pixel // width + place[1]) / height)
        return self.mitsuba.sensor.sample_ray(0.0, 0.0, position, mi.Point2f(0.5))[0]

    def average(self, seed: int, radiance: Callable[[Any, Any], Any]) -> Image:
        """Average `radiance(ray, pixel)` over the rays of each pixel, tile by tile, (H, W, 3)."""
        tiles = list(self._tiles())
        parts = []
        for number, tile in enumerate(tiles):
            count = len(tile) * self.rays_per_pixel
            # a seed of its own for each tile of each pass
            self.sampler.seed(seed * len(tiles) + number, count)
            index = dr.arange(mi.UInt32, count)
            pixel = index // self.rays_per_pixel + tile.start
            value = radiance(self.rays(pixel, self._place(index)), pixel)
            mean = dr.block_sum(value, self.rays_per_pixel) / self.rays_per_pixel
            parts.append(np.array(mean, dtype=np.float64).T)
        # contiguous, so that sums over it come out the same when it is read back from the cache
        return np.ascontiguousarray(np.concatenate(parts)).reshape(*self.shape, 3)

    def _place(self, index: Any) -> Any:
        if self.pixel_filter == "centre":
            return (0.5, 0.5)
        side = round(self.rays_per_pixel**0.5)
        cell = index % self.rays_per_pixel
        jitter = self.sampler.next_2d()
        return (cell % side + jitter.x) / side, (cell // side + jitter.y) / side

    def _tiles(self) -> Iterator[range]:
        """Ranges of pixels that one kernel can take."""
        taken, first = np.cumsum(self.samples.ravel(), dtype=np.int64), 0
        while first < taken.size:
            before = taken[first - 1] if first else 0
            last = int(np.searchsorted(taken, before + SAMPLES, side="right"))
            last = max(first + 1, min(last, first + WAVEFRONT // self.rays_per_pixel))
            yield range(first, last)
            first = last


class Equiangular(PixelRays):
    """The main estimator: the integrator `single_scattering`, with as many strata for each pixel as it needs.

    Parameters
    ----------
    light_share : see the integrator
    pixel_filter : "centre", where surfaces need no sampling, or "box"
    """

    name = "equiangular"
    version = 10
    # with a box filter: rays of a pixel and pass, and strata of each
    BOX_RAYS, BOX_STRATA = 16, 4

    def __init__(self, scene: Scene, light_share: float = 1.0, pixel_filter: PixelFilter = "centre") -> None:
        box = pixel_filter == "box"
        self.layers: tuple[str, ...] = ("scattering", "surface") if box else ("scattering",)
        rays, strata = (self.BOX_RAYS, self.BOX_STRATA) if box else (1, PILOT_STRATA)
        super().__init__(scene, rays * strata, rays, pixel_filter)
        self.integrator = mi.load_dict({"type": "single_scattering", "light_share": light_share})

    def plan(self, goal: Goal) -> float:
        """Give each pixel the strata that it needs; over a box what varies from ray to ray decides, not they."""
        if self.pixel_filter == "box":
            return goal.rel_error
        self.samples, planned_for = plan_strata(lambda number: self._scattering(PILOT_SEED + number), goal)
        return planned_for

    def fixed(self) -> dict[str, Image]:
        """Direct light on surfaces: the lights have no extent, so one ray through the centre is exact."""
        if self.pixel_filter == "box":
            return {}
        return {"surface": self._surface(seed=0)}

    def one_pass(self, seed: int) -> dict[str, Image]:
        """Airlight along each ray, and over a box direct light on surfaces, from rays of its own."""
        if self.pixel_filter == "box":
            return {"scattering": self._scattering(2 * seed), "surface": self._surface(2 * seed + 1)}
        return {"scattering": self._scattering(seed)}

    def _scattering(self, seed: int) -> Image:
        samples = mi.UInt32((self.samples // self.rays_per_pixel).ravel())

        def airlight(ray: Any, pixel: Any) -> Any:
            scene, medium = self.mitsuba.scene, self.mitsuba.medium
            strata = dr.gather(mi.UInt32, samples, pixel)
            path = eye_path(scene, ray, medium)
            return self.integrator.scattering(scene, self.sampler, ray, path, medium, distance_samples=strata)

        return self.average(seed, airlight)

    def _surface(self, seed: int) -> Image:
        def light(ray: Any, _: Any) -> Any:
            path = eye_path(self.mitsuba.scene, ray, self.mitsuba.medium)
            return self.integrator.surface(self.mitsuba.scene, ray, path, self.mitsuba.medium)

        return self.average(seed, light)


class Volpath(PixelRays):
    """Mitsuba's own `volpath`, cut off after one scattering event: the independent check, of the composite only.

    Parameters
    ----------
    samples : int    of each pixel in a pass; more make a pass's mean nearer to a Gaussian
    """

    name = "volpath"
    version = 1
    layers: tuple[str, ...] = ("composite",)

    def __init__(self, scene: Scene, samples: int = 16) -> None:
        super().__init__(scene, samples, samples, "centre")
        self.integrator = mi.load_dict({"type": "volpath", "max_depth": 2})

    def plan(self, goal: Goal) -> float:
        """Nothing: every pixel takes as many paths."""
        return goal.rel_error

    def fixed(self) -> dict[str, Image]:
        """Nothing: every sample takes its own path."""
        return {}

    def one_pass(self, seed: int) -> dict[str, Image]:
        """Radiance along each ray."""

        def radiance(ray: Any, _: Any) -> Any:
            # without the medium it would render without fog, and say nothing
            return self.integrator.sample(self.mitsuba.scene, self.sampler, ray, self.mitsuba.medium)[0]

        return {"composite": self.average(seed, radiance)}


def default_estimator() -> type[Equiangular] | type[FilmVolpath]:
    """Choose the best estimator for the variant that works on this machine."""
    return FilmVolpath if mi.variant() == "scalar_rgb" else Equiangular
