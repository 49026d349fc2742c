"""Mitsuba's analytic shapes as triangles with exact vertex normals, in the shape's local space.

Chord error, the largest distance between a triangle and the surface it stands for, is under 1e-4 of the radius for
every round shape; the values below are those measured in tests/scenes/meshes/test_tessellate.py.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from scenes.errors import InputError
from scenes.meshes.triangles import Triangles

SIDES = 256  # of a circle: chord error 1 - cos(pi / 256) = 7.5e-5 of the radius
SUBDIVISIONS = 6  # of the icosahedron: 81,920 triangles, chord error 7.1e-5 of the radius


@lru_cache(maxsize=1)
def sphere() -> Triangles:
    """Unit sphere around the origin, normals outward."""
    # trimesh has an icosphere too, but takes a second to import
    vertices, faces = _icosahedron()
    for _ in range(SUBDIVISIONS):
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
        edges, edge_of = np.unique(edges, axis=0, return_inverse=True)
        middles = len(vertices) + edge_of.reshape(-1, 3)
        middle = vertices[edges].sum(axis=1)
        vertices = np.vstack([vertices, middle / np.linalg.norm(middle, axis=1, keepdims=True)])
        (a, b, c), (ab, bc, ca) = faces.T, middles.T
        faces = np.concatenate(
            [np.stack(corners, axis=1) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
        )
    rounded = _frozen(vertices)
    return Triangles(rounded, _frozen_faces(faces), rounded)


@lru_cache(maxsize=1)
def rectangle() -> Triangles:
    """[-1, 1]^2 in the xy plane, normal +z, texture coordinates (x + 1) / 2 and (y + 1) / 2."""
    vertices = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    return Triangles(
        _frozen(vertices),
        _frozen_faces([[0, 1, 2], [2, 3, 0]]),
        _frozen([[0, 0, 1]] * 4),
        _frozen((vertices[:, :2] + 1) / 2),
    )


# for each side of a cube, the directions in which Mitsuba's u and v grow
CUBE_SIDES = (
    ((-1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((1, 0, 0), (0, 1, 0), (0, 0, -1)),
    ((0, -1, 0), (0, 0, 1), (1, 0, 0)),
    ((0, 1, 0), (-1, 0, 0), (0, 0, -1)),
    ((0, 0, -1), (0, -1, 0), (1, 0, 0)),
    ((0, 0, 1), (0, 1, 0), (1, 0, 0)),
)


@lru_cache(maxsize=1)
def cube() -> Triangles:
    """[-1, 1]^3: six flat sides of four vertices each, normals outward, a picture on each side."""
    vertices: list[NDArray[np.float64]] = []
    normals: list[NDArray[np.float64]] = []
    faces: list[list[int]] = []
    for side in CUBE_SIDES:
        normal, u, v = (np.array(direction, np.float64) for direction in side)
        first = len(vertices)
        vertices += [normal - u - v, normal + u - v, normal + u + v, normal - u + v]
        normals += [normal] * 4
        corners = [first, first + 1, first + 2, first + 3]
        # counter-clockwise from outside, whichever hand (u, v, normal) is of
        if np.cross(u, v) @ normal < 0:
            corners.reverse()
        faces += [corners[:3], [corners[2], corners[3], corners[0]]]
    corner_uv = [(0, 0), (1, 0), (1, 1), (0, 1)]
    return Triangles(_frozen(vertices), _frozen_faces(faces), _frozen(normals), _frozen(corner_uv * 6))


@lru_cache(maxsize=1)
def disk() -> Triangles:
    """Unit disk in the xy plane, normal +z."""
    rim = _circle()
    vertices = np.vstack([[[0.0, 0.0, 0.0]], np.column_stack([rim, np.zeros(SIDES)])])
    here = np.arange(SIDES)
    faces = np.column_stack([np.zeros_like(here), here + 1, (here + 1) % SIDES + 1])
    return Triangles(_frozen(vertices), _frozen_faces(faces), _frozen([[0, 0, 1]] * len(vertices)))


@lru_cache(maxsize=1)
def cylinder() -> Triangles:
    """Open unit tube (no caps, as Mitsuba's) around the z axis from z = 0 to 1, normals outward."""
    rim = _circle()
    vertices = np.vstack([np.column_stack([rim, np.full(SIDES, z)]) for z in (0.0, 1.0)])
    here = np.arange(SIDES)
    there = (here + 1) % SIDES
    faces = np.vstack(
        [np.column_stack([here, there, there + SIDES]), np.column_stack([there + SIDES, here + SIDES, here])]
    )
    return Triangles(_frozen(vertices), _frozen_faces(faces), _frozen(vertices * [1, 1, 0]))


def cylinder_frame(p0: NDArray[np.floating], p1: NDArray[np.floating], radius: float) -> NDArray[np.float64]:
    """Place the unit tube, (4, 4).

    Parameters
    ----------
    p0, p1 : (3,) float   ends of the axis [scene unit]
    radius : float        of the tube [scene unit]

    Raises
    ------
    InputError   the tube has no length

    Where its seam lies is Mitsuba's choice (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"), and pictures
    on it follow.
    """
    start, end = np.asarray(p0, np.float64), np.asarray(p1, np.float64)
    length = float(np.linalg.norm(end - start))
    if not (np.isfinite(length) and length > 0.0):
        raise InputError(
            f"A cylinder from {start.tolist()} to {end.tolist()} has no surface; give it two different ends."
        )
    x, y, z = axis = (end - start) / length
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    placed = np.eye(4)
    placed[:3, 0] = np.array([1.0 + sign * x * x * a, sign * b, -sign * x]) * radius
    placed[:3, 1] = np.array([b, sign + y * y * a, -y]) * radius
    placed[:3, 2] = axis * length
    placed[:3, 3] = start
    return placed


def _icosahedron() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Twelve unit vertices, twenty faces, counter-clockwise from outside."""
    golden = (1 + np.sqrt(5)) / 2
    rectangle = [(s, t * golden, 0.0) for s in (-1.0, 1.0) for t in (-1.0, 1.0)]
    vertices = np.array([np.roll(corner, axis) for axis in range(3) for corner in rectangle])
    # the twenty triples of vertices that are neighbours, an edge of length 2 apart
    near = np.isclose(np.linalg.norm(vertices[:, None] - vertices, axis=2), 2)
    triples = [
        (i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[k, i]
    ]
    faces = np.array([t if np.linalg.det(vertices[list(t)]) > 0 else t[::-1] for t in triples])
    return vertices / np.linalg.norm(vertices[0]), faces


def _circle() -> NDArray[np.float64]:
    angle = 2.0 * np.pi * np.arange(SIDES) / SIDES
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _frozen(values: object) -> NDArray[np.float32]:
    """Read-only, since a shape is made once and shared by every scene."""
    array = np.array(values, np.float32)
    array.setflags(write=False)
    return array


def _frozen_faces(values: object) -> NDArray[np.uint32]:
    array = np.array(values, np.uint32)
    array.setflags(write=False)
    return array
