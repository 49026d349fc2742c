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


@dataclass(frozen=True)
class Boundary:
    """The intersection of half-spaces, or a ball.

    Attributes
    ----------
    planes : (N, 4)            unit outward normal n and offset o: inside is n . x <= o; no rows for a ball
    ball : (4,) or None        centre and radius [scene unit]
    """

    planes: Array
    ball: Array | None

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Whether points, (..., 3), lie inside; (...)."""
        if self.ball is not None:
            return np.asarray(np.linalg.norm(points - self.ball[:3], axis=-1) <= self.ball[3])
        return np.asarray((points @ self.planes[:, :3].T <= self.planes[:, 3]).all(axis=-1))


def ball(centre: Array, radius: float) -> Boundary:
    """Boundary of a sphere."""
    return Boundary(np.empty((0, 4)), np.array([*centre, radius]))


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
        raise ValueError("its faces look inward, so its interior is all of space: turn them or leave flip_normals out")
    grid = np.round(planes / np.array([1e-4, 1e-4, 1e-4, 1e-4 * size])).astype(np.int64)
    planes = planes[np.unique(grid, axis=0, return_index=True)[1]]
    if len(planes) > MOST_PLANES:
        raise ValueError(f"its faces lie in {len(planes)} planes, and at most {MOST_PLANES} are taken; use a sphere")
    if (corners @ planes[:, :3].T > planes[:, 3] + TOLERANCE * size).any():
        raise ValueError("it is not convex; use a cube, a sphere or another convex shape")
    return Boundary(planes, None)
