"""Estimators of the truth: each gives independent passes over the image, whose spread is its error bar."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from reference.integrator import eye_path, mi
from reference.mitsuba_scene import instantiate
from scenes.model import Scene

# isort: split
import drjit as dr  # after the integrator, which chose Dr.Jit's LLVM

Image = NDArray[np.float64]
# one wavefront holds at most this many samples, which bounds its memory to a few hundred MB
WAVEFRONT = 1 << 22


class Estimator(Protocol):
    """What convergence needs of an estimator.

    Attributes
    ----------
    name : str
    version : int              raised when its results change, so that cached ones are not taken for new ones
    samples_per_pass : int     per pixel
    pixel_filter : str         "centre" for rays through pixel centres, "box" for averages over pixels
    layers : tuple of str      what a pass estimates
    """

    name: str
    version: int
    samples_per_pass: int
    pixel_filter: str
    layers: tuple[str, ...]

    def fixed(self) -> dict[str, Image]:
        """Layers that need no sampling, (H, W, 3) each."""

    def one_pass(self, seed: int) -> dict[str, Image]:
        """One independent estimate of each layer, (H, W, 3)."""


class PixelCentres:
    """Rays through pixel centres, in wavefronts of bounded size."""

    samples_per_pass = 16

    def __init__(self, scene: Scene, sampler: str) -> None:
        self.mitsuba = instantiate(scene)
        self.shape = (scene.camera.height, scene.camera.width)
        self.sampler = mi.load_dict({"type": sampler, "sample_count": self.samples_per_pass})
        self.sampler.set_samples_per_wavefront(self.samples_per_pass)

    def rays(self, pixel: Any) -> Any:
        """Mitsuba's own rays through the centres of pixels given by their index in row order."""
        height, width = self.shape
        position = mi.Point2f((pixel % width + 0.5) / width, (pixel // width + 0.5) / height)
        return self.mitsuba.sensor.sample_ray(0.0, 0.0, position, mi.Point2f(0.5))[0]

    def average(self, seed: int, radiance: Any) -> Image:
        """Average `radiance(ray)` over the samples of each pixel, tile by tile."""
        pixels = self.shape[0] * self.shape[1]
        tile = max(1, WAVEFRONT // self.samples_per_pass)
        parts = []
        for number, first in enumerate(range(0, pixels, tile)):
            count = min(tile, pixels - first) * self.samples_per_pass
            # a seed of its own for each tile of each pass
            self.sampler.seed(seed * (1 + pixels // tile) + number, count)
            index = dr.arange(mi.UInt32, count) // self.samples_per_pass + first
            value = radiance(self.rays(index))
            mean = dr.block_sum(value, self.samples_per_pass) / self.samples_per_pass
            parts.append(np.array(mean, dtype=np.float64).T)
        # contiguous, so that sums over it come out the same when it is read back from the cache
        return np.ascontiguousarray(np.concatenate(parts)).reshape(*self.shape, 3)


class Equiangular(PixelCentres):
    """The main estimator: the integrator `single_scattering` with stratified distances."""

    name = "equiangular"
    version = 8
    pixel_filter = "centre"
    layers: tuple[str, ...] = ("scattering",)

    def __init__(self, scene: Scene, light_share: float = 1.0) -> None:
        # strata lie within a pass, which speaks for few large ones; an honest error bar asks for many
        super().__init__(scene, "stratified")
        self.integrator = mi.load_dict({"type": "single_scattering"})
        self.integrator.light_share = light_share

    def fixed(self) -> dict[str, Image]:
        """Direct light on surfaces: the lights have no extent, so one ray a pixel is exact."""
        ray = self.rays(dr.arange(mi.UInt32, self.shape[0] * self.shape[1]))
        path = eye_path(self.mitsuba.scene, ray, self.mitsuba.medium)
        surface = self.integrator.surface(self.mitsuba.scene, ray, path, self.mitsuba.medium)
        return {"surface": np.ascontiguousarray(np.array(surface, dtype=np.float64).T).reshape(*self.shape, 3)}

    def one_pass(self, seed: int) -> dict[str, Image]:
        """Airlight along each ray."""
        mitsuba_scene, medium = self.mitsuba.scene, self.mitsuba.medium

        def airlight(ray: Any) -> Any:
            path = eye_path(mitsuba_scene, ray, medium)
            return self.integrator.scattering(mitsuba_scene, self.sampler, ray, path, medium)

        return {"scattering": self.average(seed, airlight)}


class Volpath(PixelCentres):
    """Mitsuba's own `volpath`, cut off after one scattering event: the independent check, of the composite only."""

    name = "volpath"
    version = 1
    pixel_filter = "centre"
    layers: tuple[str, ...] = ("composite",)

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene, "independent")
        self.integrator = mi.load_dict({"type": "volpath", "max_depth": 2})

    def fixed(self) -> dict[str, Image]:
        """Nothing: every sample takes its own path."""
        return {}

    def one_pass(self, seed: int) -> dict[str, Image]:
        """Radiance along each ray."""

        def radiance(ray: Any) -> Any:
            # without the medium it would render without fog, and say nothing
            return self.integrator.sample(self.mitsuba.scene, self.sampler, ray, self.mitsuba.medium)[0]

        return {"composite": self.average(seed, radiance)}


class FilmVolpath:
    """C++ `volpath` through Mitsuba's film, for `scalar_rgb`, in which Python integrators are a hundred times slower.

    A film samples the whole pixel: the averages are over pixels, not at their centres. The layers come from the same
    scene with black surfaces and from the same scene with a medium that only absorbs.
    """

    name = "film_volpath"
    version = 2
    pixel_filter = "box"
    layers: tuple[str, ...] = ("scattering", "surface")
    samples_per_pass = 8
    # how the parameters end that are zero for a layer
    _BLACK: ClassVar[dict[str, tuple[str, ...]]] = {
        "scattering": ("reflectance.value", "reflectance.data"),
        "surface": (".albedo.value.value",),
    }

    def __init__(self, scene: Scene) -> None:
        self._scene = instantiate(scene).scene
        self._sensor = _box_sensor(scene, self._scene)
        self._integrator = mi.load_dict({"type": "volpath", "max_depth": 2})

    def fixed(self) -> dict[str, Image]:
        """Nothing: both layers are sampled."""
        return {}

    def one_pass(self, seed: int) -> dict[str, Image]:
        """Both layers, each from seeds of its own."""
        images = {}
        for number, layer in enumerate(self.layers):
            with _zero(self._scene, self._BLACK[layer]):
                image = mi.render(
                    self._scene,
                    sensor=self._sensor,
                    integrator=self._integrator,
                    seed=2 * seed + number,
                    spp=self.samples_per_pass,
                )
            images[layer] = np.array(image, dtype=np.float64)[..., :3]
        return images


def default_estimator() -> type[Equiangular] | type[FilmVolpath]:
    """Choose the best estimator for the variant that works on this machine."""
    return FilmVolpath if mi.variant() == "scalar_rgb" else Equiangular


@contextmanager
def _zero(mitsuba_scene: Any, endings: tuple[str, ...]) -> Iterator[None]:
    """Set the parameters with these endings to zero for a while: what is instantiated from one parse is shared."""
    parameters = mi.traverse(mitsuba_scene)
    keys = [key for key in parameters.keys() if key.endswith(endings)]  # noqa: SIM118 - the map has no iterator
    before = {key: type(parameters[key])(parameters[key]) for key in keys}
    try:
        parameters.update({key: value * 0 for key, value in before.items()})
        yield
    finally:
        parameters.update(before)


def _box_sensor(scene: Scene, mitsuba_scene: Any) -> Any:
    """Build the scene's camera with a film that keeps float32 and reconstructs nothing."""
    camera = scene.camera
    return mi.load_dict(
        {
            "type": "perspective",
            "to_world": mi.ScalarTransform4f(camera.to_world),
            "fov": 2 * np.degrees(np.arctan(camera.tan_half_x)),
            "near_clip": camera.near,
            "far_clip": camera.far,
            # a camera outside a bounded medium has none
            **({} if (medium := mitsuba_scene.sensors()[0].get_medium()) is None else {"medium": medium}),
            "film": {
                "type": "hdrfilm",
                "width": camera.width,
                "height": camera.height,
                "component_format": "float32",
                "pixel_format": "rgb",
                "rfilter": {"type": "box"},
            },
        }
    )
