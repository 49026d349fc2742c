"""The matrices of a rasteriser."""

from __future__ import annotations

import numpy as np


def view_matrix(origin: np.ndarray, forward: np.ndarray, up: np.ndarray) -> np.ndarray:
    """World to view space, looking along -z as OpenGL does, (4, 4)."""
    back = -forward / np.linalg.norm(forward)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    rotation = np.stack([right, np.cross(back, right), back])
    view = np.eye(4)
    view[:3, :3], view[:3, 3] = rotation, -rotation @ origin
    return view


def projection_matrix(tan_half_x: float, tan_half_y: float, near: float, far: float) -> np.ndarray:
    """View to clip space, (4, 4)."""
    depth = far - near
    return np.array(
        [
            [1 / tan_half_x, 0, 0, 0],
            [0, 1 / tan_half_y, 0, 0],
            [0, 0, -(far + near) / depth, -2 * far * near / depth],
            [0, 0, -1, 0],
        ]
    )


def orthographic_matrix(centre: np.ndarray, half: np.ndarray) -> np.ndarray:
    """View to clip space of parallel light, (4, 4): x and y within `half`, (2,), of `centre`, (2,); depth is 0."""
    matrix = np.diag([1 / half[0], 1 / half[1], 0.0, 1.0])
    matrix[:2, 3] = -centre / half
    return matrix
