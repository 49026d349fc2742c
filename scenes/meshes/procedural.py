"""Meshes that our code makes, the same bytes on every machine: a torus, a wire mesh, stand-ins for others' meshes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenes.meshes import dragon, standins, wire_mesh
from scenes.meshes.triangles import Triangles


@dataclass(frozen=True)
class Recipe:
    """How a mesh is made, and what has to come out.

    Attributes
    ----------
    make : callable      returns the mesh; its docstring's first line says what it is
    sha256 : str         of the PLY file, hexadecimal
    triangles : int      number of faces
    stands_in : bool     whether it takes the place of a mesh of that name made by someone else
    """

    make: Callable[[], Triangles]
    sha256: str
    triangles: int
    stands_in: bool = True


def torus() -> Triangles:
    """Donut around the y axis, radii 1 and 0.35, with its exact normals.

    384 x 192 quads; the chord error measured is 9.2e-5 of the major radius.
    """
    major, minor, around, across = 1.0, 0.35, 384, 192
    ring, tube = _circle(around), _circle(across)
    c, s = ring[:, None, 0], ring[:, None, 1]
    outward, up = tube[None, :, 0], tube[None, :, 1]
    level = np.broadcast_to(up, (around, across))
    normals = np.stack([c * outward, level, s * outward], axis=2)
    vertices = np.stack([c * (major + minor * outward), minor * level, s * (major + minor * outward)], axis=2)
    i, j = (index.ravel() for index in np.indices((around, across)))
    corner = [((i + di) % around) * across + (j + dj) % across for di, dj in ((0, 0), (0, 1), (1, 1), (1, 0))]
    faces = np.stack([np.stack([corner[a] for a in abc], axis=1) for abc in ((0, 1, 2), (2, 3, 0))], axis=1)
    return Triangles(
        vertices.reshape(-1, 3).astype(np.float32),
        faces.reshape(-1, 3).astype(np.uint32),
        normals.reshape(-1, 3).astype(np.float32),
    )


def _circle(n: int) -> NDArray[np.float64]:
    """Unit vectors (n, 2) at n equal angles; rounded to 2^-30, where the sines of all C libraries agree."""
    grid = 2.0**30
    points = [(math.cos(2.0 * math.pi * k / n), math.sin(2.0 * math.pi * k / n)) for k in range(n)]
    return np.array([[round(x * grid) / grid, round(y * grid) / grid] for x, y in points])


RECIPES: dict[str, Recipe] = {
    "torus.ply": Recipe(
        torus,
        "2fdb62ba8f1dc0886288bf6fb8691e35cecd1e7e48b60e26fb4c8af0942b0686",
        147456,
        stands_in=False,
    ),
    "wire_mesh.ply": Recipe(
        wire_mesh.wire_mesh,
        "dc5cc3e57f0ee77d407eaf5b69dd3717c8b1eb477a4c378f338d66e436b491a0",
        139330,
        stands_in=False,
    ),
    "dragon_97k_fixed.ply": Recipe(
        dragon.fine_dragon,
        "5ad1787b2cf7f73c4b8fad27d0d9a7dd00615a6c6692664f171c5c9260810b75",
        96664,
    ),
    "dragon_res3_fixed.ply": Recipe(
        dragon.coarse_dragon,
        "613e85b0fee4e82acc4a1b2e39267cdc3ec3536e738046532aadbadd281d1c58",
        45542,
    ),
    "yeahright_cc2.ply": Recipe(
        standins.fine_wires,
        "35d47bde6a8b921159c8f1e91d90ffd8361fb047edfe66bf19932f99c46b2bd2",
        188072,
    ),
    "yeahright_cc1.ply": Recipe(
        standins.coarse_wires,
        "95b41c0d45a83d4277813628b8c77cc413250d77f9693dc46d37539890866208",
        47116,
    ),
    "bunny_hr.ply": Recipe(
        standins.rabbit,
        "767fcb2de8da8c27bc61d18615089990feba8b0b161f1f742eed9259ebc86945",
        59764,
    ),
    "armadillo_29k.ply": Recipe(
        standins.biped,
        "518e86e7c9c353f8cbe0d8ebf5d5f5dc29df2a8204d059a09c13a8d5d7b138f3",
        29188,
    ),
    "spot.ply": Recipe(
        standins.cow,
        "29386eeb6fd4ef92f1f4d7a664ea3179a408672fcb1ec5835125348add0809b9",
        23196,
    ),
    "scorpion.ply": Recipe(
        standins.scorpion,
        "9581909f9c3efe7ee82a83f9270a8f2f5671bd02535644904ebc2fcdbb517e09",
        12712,
    ),
    "fertility.ply": Recipe(
        standins.embrace,
        "78eda89872dda0d6b777597ff9eebeefc4169e80e1fec1c7d2293d18c2c5f15d",
        8920,
    ),
    "teapot.ply": Recipe(
        standins.teapot,
        "b113da3e1519beb8ae3747434d2e64002f11b45d0ad81168f9cc9e6917b029e4",
        6384,
    ),
}
