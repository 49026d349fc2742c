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
from scenes.mesh_files import MeshFile

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

    def rays(self) -> tuple[Array, Array, Array]:
        """Rays through the pixel centres, row 0 at the top.

        Returns
        -------
        origin : (height, width, 3)       on the near plane
        direction : (height, width, 3)    unit length
        t_max : (height, width)           distance from the origin to the far plane [scene unit]
        """
        x = (1 - (2 * np.arange(self.width) + 1) / self.width) * self.tan_half_x
        y = (1 - (2 * np.arange(self.height) + 1) / self.height) * self.tan_half_y
        local = np.stack([*np.meshgrid(x, y), np.ones((self.height, self.width))], axis=-1)
        stretch = np.linalg.norm(local, axis=-1)
        # einsum, not matmul, for the fixed summation order
        direction = np.einsum("ij,hwj->hwi", self.to_world[:3, :3], local / stretch[..., None])
        return self.origin + direction * (self.near * stretch)[..., None], direction, (self.far - self.near) * stretch


@dataclass(frozen=True)
class Light:
    """A light without extent.

    Attributes
    ----------
    kind : "point" or "spot"
    position : (3,)          [scene unit]
    intensity : (3,)         linear Rec.709 [W/sr]; for a spot, the one on its axis
    direction : (3,)         the spot's axis, unit length
    beam_width : float       half-angle inside which a spot has its full intensity [rad]
    cutoff_angle : float     half-angle outside which it is dark [rad]; between the two it falls linearly with the angle
    """

    kind: Literal["point", "spot"]
    position: Array
    intensity: Array
    direction: Array
    beam_width: float
    cutoff_angle: float


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh with one diffuse colour.

    Attributes
    ----------
    name : str                       its id in the scene file, made up where the file gives none
    vertices : (V, 3) float32        world space
    faces : (F, 3) uint32
    normals : (V, 3) float32 or None unit vertex normals; None where each face is flat
    computed_normals : bool          the file had none: they are ours, and for a PLY Mitsuba is handed the same
    reflectance : (3,)               linear Rec.709
    two_sided : bool                 lit on both sides; otherwise black from behind
    file : MeshFile or None          where it came from; None for an analytic shape
    """

    name: str
    vertices: Array
    faces: Array
    normals: Array | None
    computed_normals: bool
    reflectance: Array
    two_sided: bool
    file: MeshFile | None


@dataclass(frozen=True)
class Scene:
    """One scene with its parameters filled in.

    Attributes
    ----------
    name : str                     the file's name without its ending
    path : Path                    the XML file
    parameters : dict              the `$` parameters that were given
    phase : Phase          of the medium that fills space
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
    replaced: tuple[str, ...]
    parsed: Any
    digest: str

    @cached_property
    def stand_ins(self) -> tuple[str, ...]:
        """Names of the meshes for which a procedural stand-in serves."""
        return tuple(sorted({mesh.file.name for mesh in self.meshes if mesh.file and mesh.file.is_stand_in}))
