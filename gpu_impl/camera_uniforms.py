"""The camera as shaders see it: uniforms of camera_ray.glsl, and the rasteriser's matrix."""

from __future__ import annotations

from typing import Any

import numpy as np

from gpu_impl.matrices import projection_matrix
from scenes.model import Camera


def camera_uniforms(camera: Camera) -> dict[str, Any]:
    """Uniforms of camera_ray.glsl."""
    return {
        "camera_to_world": camera.to_world,
        "tan_half": (camera.tan_half_x, camera.tan_half_y),
        "clip_planes": (camera.near, camera.far),
        "image_size": (camera.width, camera.height),
    }


def world_to_clip(camera: Camera) -> np.ndarray:
    """World to clip space, with image row 0 at the first row of the target."""
    # Mitsuba's camera looks along +z with +x to the left; OpenGL's along -z with +x to the right
    view = np.diag([-1.0, 1.0, -1.0, 1.0]) @ np.linalg.inv(camera.to_world)
    projection = projection_matrix(camera.tan_half_x, camera.tan_half_y, camera.near, camera.far)
    return np.diag([1.0, -1.0, 1.0, 1.0]) @ projection @ view
