"""Which way the light's shafts run in the picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenes.model import Camera, Light


def vanishing_point(camera: Camera, light: Light) -> NDArray[np.float64]:
    """The point through which the pictures of all of a light's rays go, where they are drawn on.

    Light travels from a point, or along a direction, whose picture it is. One behind the eye has one too: light from
    there converges on it in the picture. That of a light beside the eye, or of parallel light across the view, lies at
    infinity, and the shafts are parallel.

    Returns
    -------
    (3,)
        Homogeneous (x, y, w): the point is (x / w, y / w) [pixel], (0, 0) the centre of the first pixel, x to the
        right, y downwards.
    """
    rotation = camera.to_world[:3, :3]
    towards = -light.direction if light.kind == "directional" else light.position - camera.origin
    x, y, z = rotation.T @ towards
    width, height = camera.width, camera.height
    # local +x points to the image's left, local +y up (scenes.model.Camera)
    across = 0.5 * width * (z - x / camera.tan_half_x) - 0.5 * z
    down = 0.5 * height * (z - y / camera.tan_half_y) - 0.5 * z
    return np.array([across, down, z]) / np.linalg.norm([x, y, z])


def shaft_direction(
    vanishing: NDArray[np.float64], x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The way of the shafts through points of the picture, and how far their vanishing point is.

    Parameters
    ----------
    vanishing : (3,)    as `vanishing_point` gives it
    x, y : (...)        points [pixel]

    Returns
    -------
    direction : (..., 2)    unit length, (x, y), of either sign; (0, 0) at the vanishing point itself
    distance : (...)        to the vanishing point [pixel]; infinite where that is
    """
    towards = np.stack([vanishing[0] - vanishing[2] * x, vanishing[1] - vanishing[2] * y], axis=-1)
    length = np.linalg.norm(towards, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.nan_to_num(towards / length[..., None]), np.nan_to_num(length / abs(vanishing[2]), posinf=np.inf)
