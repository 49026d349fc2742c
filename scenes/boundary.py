"""The convex body that holds a bounded medium."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenes.meshes.triangles import Triangles

Array = NDArray[np.float64]

# both renderers ask every plane for every leg of light
MOST_PLANES = 64
# of the body's size: what float32 vertices of a cube that was turned leave open
TOLERANCE = 1e-5
INWARD = "leave flip_normals out, or put it in where the to_world mirrors"


@dataclass(frozen=True)
class Boundary:
    """The intersection of half-spaces, or a ball.

    Attributes
    ----------
    planes : (N, 4)            unit outward normal n and offset o: inside is n . x <= o; no rows for a ball
    ball : (4,) or None        centre and radius [scene unit]
    corners : (V, 3)           of the half-spaces' body [scene unit]; no rows for a ball
    """

    planes: Array
    ball: Array | None
    corners: Array

    def depths(self, origin: Array, axis: Array) -> tuple[float, float]:
        """Least and largest distance of the body's points along `axis`, (3,) and of unit length, from `origin`."""
        if self.ball is not None:
            middle = float((self.ball[:3] - origin) @ axis)
            return middle - float(self.ball[3]), middle + float(self.ball[3])
        along = (self.corners - origin) @ axis
        return float(along.min()), float(along.max())

    def meets(self, polygon: Array) -> bool:
        """Whether a flat convex polygon, (N, 3), has an area in common with the body."""
        if self.ball is not None:
            return bool(_distance_to(polygon, self.ball[:3]) < self.ball[3])
        return _area(clipped(polygon, self.planes)) > 0

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Whether points, (..., 3), lie inside; (...)."""
        if self.ball is not None:
            return np.asarray(np.linalg.norm(points - self.ball[:3], axis=-1) <= self.ball[3])
        return np.asarray((points @ self.planes[:, :3].T <= self.planes[:, 3]).all(axis=-1))


def ball(centre: Array, radius: float) -> Boundary:
    """Boundary of a sphere."""
    return Boundary(np.empty((0, 4)), np.array([*centre, radius]), np.empty((0, 3)))


def convex_hull(triangles: Triangles) -> Boundary:
    """Boundary of a closed convex mesh.

    Raises
    ------
    ValueError
        With the reason, as the end of a sentence, why it is none.
    """
    corners = np.asarray(triangles.vertices, np.float64)
    size = float(np.linalg.norm(np.ptp(corners, axis=0)))
    if not size > 1e-6 * np.abs(corners).max():
        raise ValueError("it is too small, or too far from the origin, for float32")
    # flat-shaded meshes repeat a corner once a face
    _, place = np.unique(np.round(corners / (TOLERANCE * size)).astype(np.int64), axis=0, return_inverse=True)
    faces = place.reshape(-1)[np.asarray(triangles.faces, np.int64)]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]]
    forward, backward = ({tuple(edge) for edge in side.tolist()} for side in (edges, edges[:, ::-1]))
    if forward != backward:
        raise ValueError("it is not closed, so no medium has a place inside it")
    a, b, c = (corners[triangles.faces[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1)
    normals, a = normals[length > 0] / length[length > 0, None], a[length > 0]
    planes = np.column_stack([normals, (normals * a).sum(axis=1)])
    if (planes[:, 3] < planes[:, :3] @ corners.mean(axis=0)).all():
        raise ValueError(f"its faces look inward, so its interior is all of space: {INWARD}")
    grid = np.round(planes / np.array([1e-4, 1e-4, 1e-4, 1e-4 * size])).astype(np.int64)
    planes = planes[np.unique(grid, axis=0, return_index=True)[1]]
    if len(planes) > MOST_PLANES:
        raise ValueError(f"its faces lie in {len(planes)} planes, and at most {MOST_PLANES} are taken; use a sphere")
    if (corners @ planes[:, :3].T > planes[:, 3] + TOLERANCE * size).any():
        raise ValueError("it is not convex; use a cube, a sphere or another convex shape")
    return Boundary(planes, None, corners)


def clipped(polygon: Array, planes: Array) -> Array:
    """The part of a flat convex polygon, (N, 3), that lies inside half-spaces, (P, 4); (M, 3)."""
    for plane in planes:
        outside = polygon @ plane[:3] - plane[3]
        kept = []
        for here in range(len(polygon)):
            there = (here + 1) % len(polygon)
            if outside[here] <= 0:
                kept.append(polygon[here])
            if (outside[here] <= 0) != (outside[there] <= 0):
                share = outside[here] / (outside[here] - outside[there])
                kept.append(polygon[here] + share * (polygon[there] - polygon[here]))
        polygon = np.array(kept).reshape(-1, 3)
    return polygon


def _area(polygon: Array) -> float:
    if len(polygon) < 3:
        return 0.0
    spokes = polygon[1:] - polygon[0]
    return float(np.linalg.norm(np.cross(spokes[:-1], spokes[1:]).sum(axis=0))) / 2


def _distance_to(rectangle: Array, point: Array) -> float:
    """Distance of a point from a rectangle, (4, 3) in order around it."""
    u, v = rectangle[1] - rectangle[0], rectangle[3] - rectangle[0]
    s, t = ((point - rectangle[0]) @ side / (side @ side) for side in (u, v))
    nearest = rectangle[0] + np.clip(s, 0, 1) * u + np.clip(t, 0, 1) * v
    return float(np.linalg.norm(point - nearest))
