"""The lattice grid/N: the fog is evaluated on every N-th pixel of the image, in x and in y."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gpu_impl.lattices.lattice import LatticeKind
from scenes.model import Camera, Light, Scene


@dataclass(frozen=True)
class Grid:
    """Which pixels are evaluated: `first`, and every `step`-th from there; read by shaders/lattice.glsl.

    Attributes
    ----------
    step : int             N
    size : (int, int)      how many there are in x and in y
    first : (int, int)     in the middle of the first N pixels, or nearer to the image's corner, so that the last one
                           lies in the image too
    """

    step: int
    size: tuple[int, int]
    first: tuple[int, int]

    @classmethod
    def of(cls, camera: Camera, step: int) -> Grid:
        """Every `step`-th pixel of a camera's image."""
        pixels = camera.width, camera.height
        width, height = (-(-count // step) for count in pixels)
        x, y = (min(step // 2, (count - 1) % step) for count in pixels)
        return cls(step, (width, height), (x, y))

    @property
    def uniforms(self) -> dict[str, Any]:
        """Uniforms of shaders/lattice.glsl."""
        return {"downsample": self.step, "first_pixel": self.first}


def _uniforms(scene: Scene, light: Light, size: tuple[int, int], step: int) -> dict[str, Any]:
    return Grid.of(scene.camera, step).uniforms


GRID = LatticeKind("lattice/grid.glsl", "every N-th pixel of the image", uniforms=_uniforms)
