"""The truth without a usable LLVM: Mitsuba's C++ `volpath`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, ClassVar

import numpy as np

from reference.goal import Goal, PixelFilter
from reference.integrator import mi
from reference.mitsuba_scene import instantiate
from reference.moments import Image
from scenes.model import Scene

# how the names of the parameters end by which surfaces reflect: of one value, and of a picture
REFLECTANCES = ("reflectance.value", "reflectance.data")
# the largest blocks in which a scalar variant renders a film [pixel]
BLOCK = 32


class FilmVolpath:
    """C++ `volpath` through Mitsuba's film, for `scalar_rgb`, in which Python integrators are a hundred times slower.

    A film samples the whole pixel: the averages are over pixels, not at their centres. The layers come from the same
    scene with black surfaces and from the same scene with a medium that only absorbs.
    """

    name = "film_volpath"
    version = 3
    pixel_filter: PixelFilter = "box"
    layers: tuple[str, ...] = ("scattering", "surface")
    SAMPLES = 8
    # how the parameters end that are zero for a layer
    _BLACK: ClassVar[dict[str, tuple[str, ...]]] = {"scattering": REFLECTANCES, "surface": (".albedo.value.value",)}

    def __init__(self, scene: Scene) -> None:
        self.samples = np.full((scene.camera.height, scene.camera.width), self.SAMPLES, np.uint32)
        self._scene = instantiate(scene).scene
        self._sensor = _box_sensor(scene, self._scene)
        self._integrator = mi.load_dict({"type": "volpath", "max_depth": 2})
        # Mitsuba numbers the pixels of whole blocks from seed times the film's pixels on, and each number is a stream:
        # a film of blocks that are not full would share some with the next seed (of 20 x 12, a fifth)
        height, width = self.samples.shape
        self._stride = -(-(_whole_blocks(width) * _whole_blocks(height)) // (width * height))

    def plan(self, goal: Goal) -> float:
        """Nothing: every pixel takes as many paths."""
        return goal.rel_error

    def fixed(self) -> dict[str, Image]:
        """Nothing: both layers are sampled."""
        return {}

    def one_pass(self, seed: int) -> dict[str, Image]:
        """Both layers, each from seeds of its own."""
        images = {}
        for number, layer in enumerate(self.layers):
            with _at_zero(self._scene, self._BLACK[layer]):
                image = mi.render(
                    self._scene,
                    sensor=self._sensor,
                    integrator=self._integrator,
                    seed=(2 * seed + number) * self._stride,
                    spp=self.SAMPLES,
                )
            images[layer] = np.array(image, dtype=np.float64)[..., :3]
        return images


def set_to_zero(mitsuba_scene: Any, endings: tuple[str, ...]) -> dict[str, Any]:
    """Set a scene's parameters whose names end so to zero, and return what they were, by name."""
    parameters = mi.traverse(mitsuba_scene)
    keys = [key for key in parameters.keys() if key.endswith(endings)]  # noqa: SIM118 - the map has no iterator
    before = {key: type(parameters[key])(parameters[key]) for key in keys}
    parameters.update({key: value * 0 for key, value in before.items()})
    return before


@contextmanager
def _at_zero(mitsuba_scene: Any, endings: tuple[str, ...]) -> Iterator[None]:
    """Set parameters to zero for a while: what is instantiated from one parse is shared."""
    before = set_to_zero(mitsuba_scene, endings)
    try:
        yield
    finally:
        mi.traverse(mitsuba_scene).update(before)


def _whole_blocks(pixels: int) -> int:
    """Pixels of the blocks that cover a side of the film."""
    return -(-pixels // BLOCK) * BLOCK


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
