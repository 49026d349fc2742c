"""Where the rays through the pixel centres end, and how the surface lies there, by Mitsuba's ray casting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.integrator import eye_path, mi
from reference.mitsuba_scene import instantiate
from scenes.errors import InputError
from scenes.model import Scene

# isort: split
import drjit as dr  # after the integrator, which chose Dr.Jit's LLVM


@dataclass(frozen=True, eq=False)
class FirstSurfaces:
    """What each pixel's ray ends on, row 0 at the top; boundaries of the fog let it pass.

    Attributes
    ----------
    depth : (H, W)        from the ray's beginning on the near plane to the surface, or to the far plane [scene unit]
    normal : (H, W, 3)    geometric normal, unit length, towards the eye; 0 where there is no surface
    hit : (H, W)          whether there is one
    """

    depth: NDArray[np.float64]
    normal: NDArray[np.float64]
    hit: NDArray[np.bool_]


def first_surfaces(scene: Scene) -> FirstSurfaces:
    """Cast a ray through the centre of each pixel.

    Raises
    ------
    InputError
        The variant `scalar_rgb` is in use, in which a ray at a time would take hours.
    """
    if mi.variant() == "scalar_rgb":
        raise InputError("Depths need Mitsuba with LLVM or CUDA; `airlight doctor` says what is missing.")
    made, camera = instantiate(scene), scene.camera
    shape = camera.height, camera.width
    pixel = dr.arange(mi.UInt32, camera.height * camera.width)
    x, y = pixel % camera.width + 0.5, pixel // camera.width + 0.5
    place = mi.Point2f(x / camera.width, y / camera.height)
    ray = made.sensor.sample_ray(0.0, 0.0, place, mi.Point2f(0.5))[0]
    path = eye_path(made.scene, ray, made.medium)
    # once more, from behind the last boundary of the fog, for the surface itself
    last = mi.Ray3f(ray)
    last.o, last.maxt = ray(path.t_last), dr.inf
    si = made.scene.ray_intersect(last, mi.RayFlags.Minimal, False, path.blocked)
    hit = np.array(path.blocked & si.is_valid()).reshape(shape)
    facing = dr.select(dr.dot(si.n, ray.d) < 0, si.n, -si.n)
    normal = np.moveaxis(np.array(facing, np.float64).reshape(3, *shape), 0, -1)
    # where nothing stops them they end on the far plane, which the loaded camera knows in float64
    depth = np.where(hit, np.array(path.t_end, np.float64).reshape(shape), camera.rays()[2])
    return FirstSurfaces(depth, np.where(hit[..., None], normal, 0.0), hit)
