"""Closed surfaces of a scene, and which points they hold.

What makes a surface closed, and what makes a point inside it, is counted modulo 2: every edge belongs to an even number
of triangles, and a ray from the point to infinity crosses an odd number of them. No way leads from a point inside to
one outside without crossing the surface; neither the orientation of the triangles nor self-intersections matter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from scenes.model import Mesh

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# Rows are axes; rays run along the last. Nothing is modelled along it, so no ray meets an edge or a vertex.
_AXES = np.linalg.qr(np.array([[0.3141, 0.5926, 0.7418], [0.2718, -0.8281, 0.4590], [0.5772, 0.1566, -0.8014]]))[0].T
# triangles at a time
_PIECE = 1 << 18
# of a mesh's size: corners nearer than this are one, and a point nearer to a triangle is on it
_GRID = 2.0**-20


@dataclass(frozen=True)
class ClosedPart:
    """A connected closed surface.

    Attributes
    ----------
    triangles : (T, 3, 3)    corners of the triangles [scene unit]
    holds : (N,) bool        which of the given points are inside
    """

    triangles: Array
    holds: NDArray[np.bool_]


def closed_parts(mesh: Mesh, points: Array) -> list[ClosedPart]:
    """Connected parts of a mesh that are closed and hold any of the points.

    A part on which one of the points lies, as far as float32 can tell, is left out: nobody knows on which side.

    Parameters
    ----------
    mesh : Mesh
    points : (N, 3)    [scene unit]
    """
    vertices = mesh.vertices.astype(np.float64)
    lowest, highest = vertices.min(axis=0), vertices.max(axis=0)
    size = float((highest - lowest).max())
    margin = _GRID * size
    near = np.flatnonzero(((points >= lowest - margin) & (points <= highest + margin)).all(axis=1))
    if not near.size:
        return []
    crossings = _crossings(mesh, vertices, points[near])
    # forwards the ray decides; a triangle that the point lies on is crossed just before it or just after
    ahead = [(hit[distance > -margin], distance[distance > -margin]) for hit, distance in crossings]
    if not any(hit.size for hit, _ in ahead):
        return []
    faces = _welded(mesh, vertices, lowest, size)
    part_of = _parts(faces)
    found = []
    for part in np.unique(np.concatenate([part_of[hit] for hit, _ in ahead])):
        mine = [distance[part_of[hit] == part] for hit, distance in ahead]
        touched = any((np.abs(distance) < margin).any() for distance in mine)
        holds = np.zeros(len(points), bool)
        holds[near] = [len(distance) % 2 == 1 for distance in mine]
        if touched or not holds.any():
            continue
        members = part_of == part
        if _is_closed(faces[members]):
            found.append(ClosedPart(vertices[mesh.faces[members]], holds))
    return found


def _crossings(mesh: Mesh, vertices: Array, points: Array) -> list[tuple[Indices, Array]]:
    """Triangles that a ray from each point crosses, and how far away [scene unit]: (K,) both, a pair for each point."""
    turned, starts = (vertices @ _AXES.T).T, points @ _AXES.T
    found: list[list[tuple[Indices, Array]]] = [[] for _ in points]
    for first in range(0, len(mesh.faces), _PIECE):
        faces = mesh.faces[first : first + _PIECE]
        corners = np.stack([turned[:, faces[:, corner]] for corner in range(3)])  # (3 corners, 3 axes, T)
        lowest, highest = corners.min(axis=0), corners.max(axis=0)
        for (x, y, z), pairs in zip(starts, found, strict=True):
            boxes = (lowest[0] <= x) & (x <= highest[0]) & (lowest[1] <= y) & (y <= highest[1])
            hit = np.flatnonzero(boxes)
            u, v, w = (corners[:, axis, hit] - start for axis, start in enumerate((x, y, z)))  # (3 corners, K) each
            # twice the areas between the ray and the edges; the same number, with its sign turned, in the neighbour
            area = np.roll(u, -1, axis=0) * np.roll(v, -2, axis=0) - np.roll(u, -2, axis=0) * np.roll(v, -1, axis=0)
            inside = (area > 0).all(axis=0) | (area < 0).all(axis=0)
            distance = (area * w).sum(axis=0)[inside] / area.sum(axis=0)[inside]
            pairs.append((hit[inside] + first, distance))
    return [(np.concatenate([hit for hit, _ in pairs]), np.concatenate([d for _, d in pairs])) for pairs in found]


def _welded(mesh: Mesh, vertices: Array, lowest: Array, size: float) -> Indices:
    """Triangles whose corners are places, (F, 3): a flat-shaded mesh repeats a corner once a face."""
    x, y, z = np.round((vertices - lowest) / (_GRID * size)).astype(np.int64).T
    _, place = np.unique(x << 42 | y << 21 | z, return_inverse=True)
    return place[mesh.faces.astype(np.int64)]


def _parts(faces: Indices) -> NDArray[np.int32]:
    """Number of the connected part to which each triangle belongs, (F,)."""
    a, b, c = faces.T
    places = int(faces.max()) + 1
    links = coo_array((np.ones(2 * len(faces), np.int8), (np.r_[a, b], np.r_[b, c])), shape=(places, places))
    return connected_components(links, directed=False)[1][a]


def _is_closed(faces: Indices) -> bool:
    """Whether each edge belongs to an even number of triangles."""
    edges = np.sort(np.concatenate([faces[:, :2], faces[:, 1:], faces[:, ::2]]), axis=1)
    # what welding has made a point bounds nothing
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, count = np.unique(edges[:, 0] << 32 | edges[:, 1], return_counts=True)
    return bool((count % 2 == 0).all())
