"""Polygon meshes between the steps that make a mesh out of its original, and the reader of polygons from OBJ."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenes.errors import InputError
from scenes.meshes.readers import read_mesh
from scenes.meshes.triangles import Triangles


@dataclass(frozen=True)
class Polygons:
    """A mesh of polygons with any number of corners.

    Attributes
    ----------
    vertices : (V, 3) float64   positions [scene unit]
    corners : (C,) int64        vertex indices, polygon after polygon, counter-clockwise seen from outside
    sides : (P,) int64          number of corners of each polygon; sums to C
    """

    vertices: NDArray[np.float64]
    corners: NDArray[np.int64]
    sides: NDArray[np.int64]

    @property
    def starts(self) -> NDArray[np.int64]:
        """(P,) place of each polygon's first corner in `corners`."""
        return np.cumsum(self.sides) - self.sides

    @property
    def next_corner(self) -> NDArray[np.int64]:
        """(C,) place of the corner that follows each corner in its polygon."""
        following = np.arange(len(self.corners)) + 1
        following[self.starts + self.sides - 1] = self.starts
        return following


def of_triangles(vertices: NDArray[np.floating], faces: NDArray[np.integer]) -> Polygons:
    """Triangles, (V, 3) positions and (F, 3) indices, as polygons."""
    return Polygons(vertices.astype(np.float64), faces.astype(np.int64).ravel(), np.full(len(faces), 3))


def cut_into_triangles(mesh: Polygons) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Positions (V, 3) and triangles (F, 3) of a mesh: each polygon is cut from its first corner.

    First the first triangle of every polygon, then the second of every one that has it, and so on: of Q quads,
    triangle i and triangle Q + i are one, so that they can be told from the file again.
    """
    cuts = mesh.sides - 2
    first = np.repeat(mesh.starts, cuts)
    step = np.arange(len(first)) - np.repeat(np.cumsum(cuts) - cuts, cuts)
    order = np.argsort(step, kind="stable")
    first, second = first[order], (first + step)[order] + 1
    corners = mesh.corners
    return mesh.vertices, np.stack([corners[first], corners[second], corners[second + 1]], axis=1)


def as_triangles(mesh: Polygons) -> Triangles:
    """The mesh as it is written to a file: triangles, float32, no normals."""
    vertices, faces = cut_into_triangles(mesh)
    return Triangles(vertices.astype(np.float32), faces.astype(np.uint32))


def read_polygons(path: Path) -> Polygons:
    """The polygons of an OBJ file or the triangles of a PLY file.

    Apart from `scenes.meshes.readers`, which hands out triangles as Mitsuba cuts them: subdivision needs the polygons,
    and the vertices as the file shares them, whatever texture coordinates and normals its corners name.

    Raises
    ------
    InputError   the file cannot be read or is damaged
    """
    if path.suffix.lower() != ".obj":
        triangles = read_mesh(path)
        return of_triangles(triangles.vertices, triangles.faces)
    positions: list[list[float]] = []
    corners: list[int] = []
    sides: list[int] = []
    try:
        for line in path.read_text("latin-1").splitlines():
            match line.split():
                case ["v", x, y, z, *_]:
                    positions.append([float(x), float(y), float(z)])
                case ["f", *names]:
                    indices = [int(name.partition("/")[0]) for name in names]
                    # negative ones count back from the last vertex so far
                    corners += [i - 1 if i > 0 else len(positions) + i for i in indices]
                    sides.append(len(indices))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path and its permissions.") from None
    except ValueError:
        raise InputError(f"{path}: a 'v' or 'f' line does not hold numbers; get the file again.") from None
    mesh = Polygons(np.array(positions).reshape(-1, 3), np.array(corners, np.int64), np.array(sides, np.int64))
    if not sides or min(sides) < 3 or min(corners) < 0 or max(corners) >= len(positions):
        raise InputError(f"{path}: it has no polygons, or one with missing corners; get the file again.")
    if not np.isfinite(mesh.vertices).all():
        raise InputError(f"{path}: a position is NaN or infinite; get the file again.")
    return mesh
