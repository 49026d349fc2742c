"""What a visibility strategy is made of, beside its GLSL: what it builds on, and what it gives the scattering pass."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from gpu_impl.device import Device
from gpu_impl.geometry import Geometry
from gpu_impl.given import GivenIntervals
from gpu_impl.lattices.lattice import Lattice
from gpu_impl.passes.geometry import GBuffer
from gpu_impl.passes.shadow_map import ShadowMap
from gpu_impl.textures import PictureTextures
from gpu_impl.timing import Clock
from scenes.model import Light, Scene

if TYPE_CHECKING:
    from gpu_impl.techniques import Technique


class Kept:
    """What a scene's meshes and media decide, made once and kept from frame to frame."""

    def __init__(self) -> None:
        self._kept: dict[Hashable, Any] = {}

    def get(self, key: Hashable, make: Callable[[], Any]) -> Any:
        """Find what was made under a key, or make it."""
        if key not in self._kept:
            self._kept[key] = make()
        return self._kept[key]

    def release(self) -> None:
        """Release all of it."""
        for one in self._kept.values():
            one.release()
        self._kept.clear()


@dataclass(frozen=True)
class FogInputs:
    """All that there is when one light's airlight is about to be evaluated.

    Attributes
    ----------
    light : Light              one of the scene's; a directional one has a position (`light_uniforms.placed`)
    number : int               which of them
    lattice : Lattice          of rays that are evaluated for this light
    shadow_map : ShadowMap     of this light
    kept : Kept                for what stays the same while eye and lights move
    given : GivenIntervals     of the lattice's rays, where the technique asks for them
    clock : Clock              to be told of passes of one's own, by one of the names in `timing.PASSES`
    """

    device: Device
    scene: Scene
    light: Light
    number: int
    technique: Technique
    lattice: Lattice
    geometry: Geometry
    gbuffer: GBuffer
    shadow_map: ShadowMap
    pictures: PictureTextures
    kept: Kept
    given: GivenIntervals | None
    clock: Clock


class Supply:
    """What a strategy gives the scattering pass for one light and one frame; this one gives nothing.

    Attributes
    ----------
    defines : of both shaders of the pass
    """

    defines: Mapping[str, object] = {}

    def bind(self, program: Any) -> None:
        """Set uniforms, bind textures (from unit 9 on) and storage buffers (4 and 5)."""

    def draw(self, device: Device, program: Any, targets: tuple[Any, ...], add: bool) -> None:
        """Run the program on the lattice: here once for each of its cells.

        A strategy that draws geometry of its own clears the targets unless it is to add to them.
        """
        device.fill(program, *targets, add=add)

    def give_back(self, device: Device) -> None:
        """Give back what was taken for this frame."""


def nothing(inputs: FogInputs) -> Supply:
    """Ray, light and shadow map are enough."""
    return Supply()


def anywhere(device: Device) -> None:
    """Any OpenGL that runs the other passes will do."""


@dataclass(frozen=True)
class Visibility:
    """Which pieces of a ray are lit.

    Attributes
    ----------
    source : str               file below `shaders/`, or a path
    what : str                 in a few words
    supply : callable          makes what the shader needs beside ray, light and shadow map
    vertex : str               vertex shader: that of a full screen, or one that draws geometry
    defines : mapping          tells the variants of one file apart
    reads_shadow_map : bool    whether the map's resolution is part of its error
    asks_points : bool         whether it asks of points on the ray whether they lie in the dark (in_shadow()), so that
                               rays can answer in place of the map
    given : bool               whether it reports lit intervals that it was handed (`given.py`)
    grid_only : bool           whether it draws on the image's pixels, so that it takes no lattice but the grid
    in_steps : bool            whether the driver cuts what it reports into the technique's steps, for models that
                               sample points
    airlight_at_corners : bool whether its vertex shader evaluates the airlight model, for the driver to interpolate
    check : callable           raises InputError where this OpenGL lacks something
    """

    source: str
    what: str
    supply: Callable[[FogInputs], Supply] = nothing
    vertex: str = "fullscreen.vert.glsl"
    defines: Mapping[str, int] = field(default_factory=dict)
    reads_shadow_map: bool = True
    asks_points: bool = True
    given: bool = False
    grid_only: bool = False
    in_steps: bool = False
    airlight_at_corners: bool = False
    check: Callable[[Device], None] = anywhere
