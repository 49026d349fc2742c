"""What a lattice is: which rays the fog is evaluated on, and how the image's pixels get their values back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from scenes.model import Camera, Light, Scene


def every_nth(camera: Camera, step: int) -> tuple[int, int]:
    """As many cells as every `step`-th pixel has, in x and in y."""
    return -(-camera.width // step), -(-camera.height // step)


def no_uniforms(scene: Scene, light: Light, size: tuple[int, int], step: int) -> dict[str, Any]:
    """N and the size of the lattice are enough."""
    return {}


@dataclass(frozen=True)
class LatticeKind:
    """A lattice's GLSL, and what it needs.

    Attributes
    ----------
    source : str                   file below `shaders/`, or a path: where in the image each cell's ray goes
    what : str                     in a few words
    reconstruction : str or None   of the values at the image's pixels; None where `Technique.upsample` says how
    size : callable                (camera, N) to the number of cells in x and in y
    uniforms : callable            (scene, light, size, N) to uniforms of both files
    """

    source: str
    what: str
    reconstruction: str | None = None
    size: Callable[[Camera, int], tuple[int, int]] = every_nth
    uniforms: Callable[[Scene, Light, tuple[int, int], int], dict[str, Any]] = no_uniforms


@dataclass(frozen=True)
class Lattice:
    """The lattice of one light.

    Attributes
    ----------
    kind : LatticeKind
    size : (int, int)      how many cells there are in x and in y
    uniforms : dict        of `kind.source` and `kind.reconstruction`
    """

    kind: LatticeKind
    size: tuple[int, int]
    uniforms: dict[str, Any]

    @classmethod
    def of(cls, kind: LatticeKind, scene: Scene, light: Light, step: int) -> Lattice:
        """Lay it over the image that the scene's camera takes."""
        size = kind.size(scene.camera, step)
        common = {"downsample": step, "lattice_size": size}
        return cls(kind, size, common | kind.uniforms(scene, light, size, step))
