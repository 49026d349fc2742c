"""Catmull-Clark subdivision of polygon meshes.

Source: Catmull and Clark 1978, "Recursively generated B-spline surfaces on arbitrary topological meshes"; the rules
at a boundary are those of DeRose, Kass and Truong 1998, section 3: a boundary is a uniform cubic B-spline.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenes.errors import InputError
from scenes.meshes.polygons import Polygons


def catmull_clark(mesh: Polygons, levels: int) -> Polygons:
    """The mesh after `levels` subdivisions; all its polygons are quads from the first one on.

    A polygon of n sides becomes n quads, so a mesh with C corners has C, 4 C, 16 C ... quads.

    Raises
    ------
    InputError   an edge has more than two polygons: the rules do not say where its points go
    """
    for _ in range(levels):
        mesh = _subdivide(mesh)
    return mesh


def _subdivide(mesh: Polygons) -> Polygons:
    """One level. New vertices in this order: those of the mesh, one an edge, one a polygon."""
    positions, corners, sides = mesh.vertices, mesh.corners, mesh.sides
    polygon_of = np.repeat(np.arange(len(sides)), sides)
    following = mesh.next_corner
    # a polygon's side runs from each of its corners to the next one
    ends = np.sort(np.stack([corners, corners[following]], axis=1), axis=1)
    edges, edge_of, uses = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    edge_of = edge_of.ravel()
    if uses.max() > 2:
        raise InputError(
            "An edge of the mesh has more than two polygons, which Catmull-Clark does not know; repair it."
        )

    centres = _sums(polygon_of, positions[corners], len(sides)) / sides[:, None]
    middles = positions[edges].mean(axis=1)
    inner = (uses == 2)[:, None]
    smooth = (2.0 * middles + _sums(edge_of, centres[polygon_of], len(edges))) / 4.0
    edge_points = np.where(inner, smooth, middles)

    moved = _moved_vertices(mesh, centres[polygon_of], edges, middles, uses == 1)
    first_edge, first_centre = len(positions), len(positions) + len(edges)
    previous = np.empty_like(following)
    previous[following] = np.arange(len(following))
    quads = np.stack([corners, first_edge + edge_of, first_centre + polygon_of, first_edge + edge_of[previous]], axis=1)
    return Polygons(np.concatenate([moved, edge_points, centres]), quads.ravel(), np.full(len(quads), 4))


def _moved_vertices(
    mesh: Polygons,
    centres: NDArray[np.float64],
    edges: NDArray[np.int64],
    middles: NDArray[np.float64],
    at_boundary: NDArray[np.bool_],
) -> NDArray[np.float64]:
    """Where the mesh's own vertices go, (V, 3); `centres` is (C, 3), that of each corner's polygon."""
    positions, count = mesh.vertices, len(mesh.vertices)
    valence = np.maximum(np.bincount(mesh.corners, minlength=count), 1)[:, None]  # a lone vertex divides by it too
    both_ends = edges.T.ravel()
    degree = np.maximum(np.bincount(both_ends, minlength=count), 1)[:, None]
    faces = _sums(mesh.corners, centres, count) / valence
    around = _sums(both_ends, np.tile(middles, (2, 1)), count) / degree
    smooth = (faces + 2.0 * around + (valence - 3.0) * positions) / valence

    rim_ends = edges[at_boundary].T.ravel()
    rim_degree = np.bincount(rim_ends, minlength=count)
    # 6/8 of the vertex and 1/8 of each neighbour: half of it, and a quarter of each edge's middle
    on_rim = positions / 2.0 + _sums(rim_ends, np.tile(middles[at_boundary], (2, 1)), count) / 4.0
    moved = np.where((rim_degree == 0)[:, None], smooth, positions)
    # where several boundaries meet in a vertex, or no polygon does, it stays
    lone = np.bincount(mesh.corners, minlength=count) == 0
    return np.where((rim_degree == 2)[:, None], on_rim, np.where(lone[:, None], positions, moved))


def _sums(index: NDArray[np.int64], values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """(count, 3) sums of the rows of `values` (N, 3) that have each `index` (N,)."""
    return np.stack([np.bincount(index, values[:, axis], minlength=count) for axis in range(3)], axis=1)
