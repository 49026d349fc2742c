"""What a scene is once loaded: plain dataclasses of numpy arrays, in world space and SI-free scene units."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from analytic import Medium
from analytic.phase import Phase
from scenes.boundary import Boundary
from scenes.meshes.files import MeshFile

Array = NDArray[Any]


@dataclass(frozen=True)
class Camera:
    """A pinhole with Mitsuba's conventions: it looks along its local +z, local +x points to the image's left.

    Attributes
    ----------
    to_world : (4, 4)       rigid transform from camera to world space
    tan_half_x : float      tangent of half the horizontal field of view
    near, far : float       clip distances along the viewing axis [scene unit]; a ray begins on the near plane and
                            ends on the far one, as Mitsuba's rays do, and the fog before the near plane is not seen
    width, height : int     size of the image [pixel]
    """

    to_world: Array
    tan_half_x: float
    near: float
    far: float
    width: int
    height: int

    @property
    def origin(self) -> Array:
        """The pinhole, (3,)."""
        return self.to_world[:3, 3]

    @property
    def tan_half_y(self) -> float:
        """Tangent of half the vertical field of view (square pixels)."""
        return self.tan_half_x * self.height / self.width

    def rays(self, positions: Array | None = None) -> tuple[Array, Array, Array]:
        """Rays through the pixel centres, row 0 at the top, or through other places in the image.

        Parameters
        ----------
        positions : (h, w, 2)    x and y [pixel], (0.5, 0.5) in the first pixel's centre; the centres of all by default

        Returns
        -------
        origin : (height, width, 3)       on the near plane; (h, w, 3) where positions are given, and so on
        direction : (height, width, 3)    unit length
        t_max : (height, width)           distance from the origin to the far plane [scene unit]
        """
        if positions is None:
            positions = np.stack(np.meshgrid(np.arange(self.width) + 0.5, np.arange(self.height) + 0.5), axis=-1)
        x = (1 - 2 * positions[..., 0] / self.width) * self.tan_half_x
        y = (1 - 2 * positions[..., 1] / self.height) * self.tan_half_y
        local = np.stack([x, y, np.ones_like(x)], axis=-1)
        stretch = np.linalg.norm(local, axis=-1)
        # einsum, not matmul, for the fixed summation order
        direction = np.einsum("ij,hwj->hwi", self.to_world[:3, :3], local / stretch[..., None])
        return self.origin + direction * (self.near * stretch)[..., None], direction, (self.far - self.near) * stretch


@dataclass(frozen=True)
class Light:
    """A light without extent.

    Attributes
    ----------
    kind : "point", "spot" or "directional"
    position : (3,)            [scene unit]; of no meaning for a directional light
    intensity : (3,)           linear Rec.709 [W/sr]; for a spot, the one on its axis; for a directional light, its
                               irradiance on a surface that faces it [W / scene unit^2]
    to_world : (4, 4)          from the light's own frame, in which it shines along +z
    beam_width : float         half-angle inside which a spot has its full intensity [rad]
    cutoff_angle : float       half-angle outside which it is dark [rad]; in between it falls linearly with the angle
    texture : Texture or None  a spot's picture, stretched over the square around its cone
    """

    kind: Literal["point", "spot", "directional"]
    position: Array
    intensity: Array
    to_world: Array
    beam_width: float
    cutoff_angle: float
    texture: Texture | None = None

    @property
    def direction(self) -> Array:
        """A spot's axis, or the way a directional light travels, (3,), unit length."""
        return self.to_world[:3, 2] / np.linalg.norm(self.to_world[:3, 2])


@dataclass(frozen=True)
class Texture:
    """A picture over texture coordinates, sampled as Mitsuba's `bitmap` samples it.

    Attributes
    ----------
    pixels : (H, W, 3) float32   linear Rec.709; row 0 is at v = 0
    to_uv : (2, 3)               affine map of the coordinates before the picture is looked up
    nearest : bool               take the nearest texel; otherwise interpolate the four around
    wrap : str                   beyond 0 to 1: "repeat", "mirror" or "clamp"
    path : Path                  the file
    """

    pixels: Array
    to_uv: Array
    nearest: bool
    wrap: Literal["repeat", "mirror", "clamp"]
    path: Path


@dataclass(frozen=True)
class Material:
    """How a surface reflects: kd / pi + ks (n + 2) / (2 pi) cos^n alpha (Lafortune and Willems 1994).

    Attributes
    ----------
    diffuse : (3,) or Texture    kd, linear Rec.709
    specular : (3,)              ks; 0 for a diffuse surface
    exponent : float             n
    two_sided : bool             lit on both sides; otherwise black from behind
    """

    diffuse: Array | Texture
    specular: Array
    exponent: float
    two_sided: bool


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh of one material.

    Attributes
    ----------
    name : str                       its id in the scene file, made up where the file gives none
    vertices : (V, 3) float32        world space
    faces : (F, 3) uint32
    normals : (V, 3) float32 or None unit vertex normals; None where each face is flat
    material : Material
    file : MeshFile or None          where it came from; None for an analytic shape
    mapping : str                    what `coordinates` are: "uv" for texture coordinates; "sphere", "cylinder" or
                                     "disk" for the place on that unit shape, of which (u, v) is a function
    coordinates : (V, 3) or None     float32; "uv" leaves the third 0; None where the file has none
    """

    name: str
    vertices: Array
    faces: Array
    normals: Array | None
    material: Material
    file: MeshFile | None
    mapping: Literal["uv", "sphere", "cylinder", "disk"]
    coordinates: Array | None


@dataclass(frozen=True)
class Scene:
    """One scene with its parameters filled in.

    Attributes
    ----------
    name : str                     the file's name without its ending
    path : Path                    the XML file
    parameters : dict              the `$` parameters that were given
    phase : Phase                  of the fog
    boundary : Boundary or None    what holds the fog; None where it fills space
    normals : dict                 Mitsuba's name of a mesh's vertex normals to those that we computed, (V * 3,), for
                                   the meshes whose files have none: both renderers then shade with the same
    replaced : tuple of str        integrators of the file that are not single scattering, and are not used
    parsed : ParserState           Mitsuba's own parse of the same file, size and mesh paths filled in; the reference
                                   is instantiated from it, so that a mistake of the loader shows as a difference
    digest : str                   hash of everything that decides the picture: the file, its parameters, its meshes
    """

    name: str
    path: Path
    parameters: dict[str, str]
    camera: Camera
    meshes: tuple[Mesh, ...]
    lights: tuple[Light, ...]
    medium: Medium
    phase: Phase
    boundary: Boundary | None
    normals: dict[str, Array]
    replaced: tuple[str, ...]
    parsed: Any
    digest: str

    def __repr__(self) -> str:
        """One line, for notebooks."""
        triangles = sum(len(mesh.faces) for mesh in self.meshes)
        stand_ins = f", stand-in for {', '.join(self.stand_ins)}" if self.stand_ins else ""
        given = "".join(f", {name}={value}" for name, value in self.parameters.items())
        lights = f"{len(self.lights)} light{'s' * (len(self.lights) != 1)}"
        return (
            f"<Scene {self.name} {self.camera.width} x {self.camera.height}{given}: {self.phase.name} fog, {lights}, "
            f"{triangles} triangles{stand_ins}>"
        )

    @cached_property
    def stand_ins(self) -> tuple[str, ...]:
        """Names of the meshes for which a procedural stand-in serves."""
        return tuple(sorted({mesh.file.name for mesh in self.meshes if mesh.file and mesh.file.is_stand_in}))
