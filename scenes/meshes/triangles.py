"""Triangles in memory: the arrays, the normals that Mitsuba would compute, and the PLY bytes of our own meshes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Triangles:
    """A triangle mesh in its local space.

    Attributes
    ----------
    vertices : (V, 3) float32           positions [scene unit]
    faces : (F, 3) uint32               vertex indices; counter-clockwise seen from the side the normal points to
    normals : (V, 3) float32 or None    as stored in the file, not made unit length; None where it has none
    uv : (V, 2) float32 or None         texture coordinates as Mitsuba's plugin holds them
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]
    normals: NDArray[np.float32] | None = None
    uv: NDArray[np.float32] | None = None


def vertex_normals(vertices: NDArray[np.floating], faces: NDArray[np.integer]) -> NDArray[np.float32]:
    """Unit normals per vertex: the normals of the faces around it, weighted by their angle there.

    Parameters
    ----------
    vertices : (V, 3) float   positions [scene unit]
    faces : (F, 3) int        vertex indices

    Returns
    -------
    (V, 3) float32   unit vectors; (1, 0, 0), Mitsuba's own choice, where no face of non-zero area meets the vertex

    Source: Thuermer and Wuethrich 1998, "Computing Vertex Normals from Polygonal Facets", which Mitsuba uses too.
    In float64: Mitsuba's float32 sums differ by at most 8e-5 rad on Stanford's dragon, at slivers, and by 3e-7 rad on
    our own meshes (tests/scenes/meshes/test_files.py).
    """
    corners = np.asarray(vertices, np.float64)[faces]  # (F, 3 corners, 3)
    edges = np.roll(corners, -1, axis=1) - corners  # edge i leaves corner i
    normal = np.cross(edges[:, 0], edges[:, 1])
    twice_area = np.linalg.norm(normal, axis=1)
    usable = twice_area > 0.0
    edges, normal, twice_area = edges[usable], normal[usable], twice_area[usable]
    # atan2 keeps its digits in slivers, where the arc cosine of a rounded dot product loses them; the sine part
    # is twice the triangle's area at each of the three corners.
    angle = np.arctan2(twice_area[:, None], -np.sum(edges * np.roll(edges, 1, axis=1), axis=2))
    weighted = (normal / twice_area[:, None])[:, None, :] * angle[:, :, None]
    index = np.asarray(faces)[usable].ravel()
    total = np.stack(
        [np.bincount(index, weighted[:, :, axis].ravel(), minlength=len(vertices)) for axis in range(3)], axis=1
    )
    length = np.linalg.norm(total, axis=1)
    lone = length == 0.0
    total[lone] = (1.0, 0.0, 0.0)
    length[lone] = 1.0
    return (total / length[:, None]).astype(np.float32)


def ply_bytes(mesh: Triangles) -> bytes:
    """Binary little-endian PLY of the vertices, the faces and, where present, the normals (float32, int32)."""
    names = ["x", "y", "z"] if mesh.normals is None else ["x", "y", "z", "nx", "ny", "nz"]
    columns = [mesh.vertices] if mesh.normals is None else [mesh.vertices, mesh.normals]
    header = "\n".join(
        [
            "ply",
            "format binary_little_endian 1.0",
            f"element vertex {len(mesh.vertices)}",
            *[f"property float {name}" for name in names],
            f"element face {len(mesh.faces)}",
            "property list uchar int vertex_indices",
            "end_header\n",
        ]
    )
    rows = np.empty(len(mesh.faces), np.dtype([("count", "u1"), ("index", "<i4", 3)]))
    rows["count"] = 3
    rows["index"] = mesh.faces
    return header.encode("ascii") + np.hstack(columns).astype("<f4").tobytes() + rows.tobytes()
