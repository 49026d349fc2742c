"""Repair of a triangle mesh into one closed shell in which every edge has exactly two triangles.

A silhouette edge is where one of an edge's two triangles faces the light and the other does not: an edge with one
triangle, or with three, makes a shadow volume that does not close.

What is done: vertices at one place become one; faces that are there twice, or once from either side, cancel; where an
edge has more triangles than two, those of the two largest patches stay; the largest shell stays; holes are closed
(scenes.meshes.hole_filling). Written here because the libraries that do it carry the AGPL or the GPL.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenes.meshes.hole_filling import close_holes
from scenes.meshes.polygons import Polygons, cut_into_triangles, of_triangles

Indices = NDArray[np.int64]


def repair(mesh: Polygons) -> Polygons:
    """The mesh's largest shell, closed, edge-manifold and consistently oriented.

    Positions are rounded to float32 first, as the file will hold them: what meets there has to meet here.
    """
    positions, faces = cut_into_triangles(mesh)
    positions, faces = weld(positions.astype(np.float32).astype(np.float64), faces)
    faces = without_repeats(faces)
    while (surplus := _surplus(positions, faces)).any():
        faces = faces[~surplus]
    patch = patches(faces, len(positions))
    faces = faces[patch == np.bincount(patch).argmax()]
    positions, faces = close_holes(positions, faces)
    used, compact = np.unique(faces, return_inverse=True)
    return of_triangles(positions[used], compact.reshape(-1, 3))


def weld(positions: NDArray[np.float64], faces: Indices) -> tuple[NDArray[np.float64], Indices]:
    """Vertices at exactly one place made one, in the order in which they first appear."""
    # adding 0 turns -0 into 0, which is the same place with other bytes
    _, first, place = np.unique(positions + 0.0, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return positions[first[order]], rank[place.ravel()][faces]


def without_repeats(faces: Indices) -> Indices:
    """Faces without those that have a corner twice, and without copies.

    Of copies of one face one stays, unless as many turn the other way: these enclose nothing, and all go.
    """
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    # a rotation that puts the smallest corner first keeps the way a triangle turns
    turned = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    sign = np.where(turned[:, 1] < turned[:, 2], 1, -1)
    _, group = np.unique(np.sort(turned, axis=1), axis=0, return_inverse=True)
    group = group.ravel()
    majority = np.sign(np.bincount(group, sign)).astype(np.int64)
    candidates = np.flatnonzero(sign == majority[group])
    _, first = np.unique(group[candidates], return_index=True)
    return faces[np.sort(candidates[first])]


def half_edges(faces: Indices) -> tuple[Indices, Indices]:
    """Starts and ends, (3 F,) each: side s of face f, from corner s to the next, is number s * F + f."""
    return faces.T.ravel(), np.roll(faces, -1, axis=1).T.ravel()


def patches(faces: Indices, vertex_count: int) -> Indices:
    """Number (F,) of the patch of each face: faces connected through edges with one face on either side."""
    start, end = half_edges(faces)
    low, high = np.minimum(start, end), np.maximum(start, end)
    _, edge = np.unique(low * vertex_count + high, return_inverse=True)
    order = np.argsort(edge, kind="stable")
    uses = np.bincount(edge)
    begin = (np.cumsum(uses) - uses)[uses == 2]
    first, second = order[begin], order[begin + 1]
    paired = start[first] != start[second]
    return _connected(first[paired] % len(faces), second[paired] % len(faces), len(faces))


def _connected(a: Indices, b: Indices, count: int) -> Indices:
    """Number (count,) of the component of each node of a graph whose edges join a[i] and b[i]."""
    label = np.arange(count)
    while True:
        low = np.minimum(label[a], label[b])
        before = label.copy()
        # the smaller label is given to both ends and to what they hang on
        np.minimum.at(label, before[a], low)
        np.minimum.at(label, before[b], low)
        while not np.array_equal(label, label[label]):
            label = label[label]
        if np.array_equal(label, before):
            return np.unique(label, return_inverse=True)[1]


def _surplus(positions: NDArray[np.float64], faces: Indices) -> NDArray[np.bool_]:
    """Which faces (F,) go, because two better ones lie along an edge of theirs.

    Along an edge one face stays for each direction: that of the largest patch, and in a patch the one with the
    largest area. A pocket or a fin that a decimation left is a small patch, and its slivers are small faces.
    """
    start, end = half_edges(faces)
    patch = patches(faces, len(positions))
    size = np.bincount(patch)[patch]
    corners = positions[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    face = np.tile(np.arange(len(faces)), 3)
    directed = start * len(positions) + end
    order = np.lexsort((face, -area[face], -size[face], directed))
    repeated = np.zeros(len(directed), np.bool_)
    repeated[order[1:]] = np.diff(directed[order]) == 0
    surplus = np.zeros(len(faces), np.bool_)
    surplus[face[repeated]] = True
    return surplus
