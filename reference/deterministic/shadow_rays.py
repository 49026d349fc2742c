"""Mitsuba's answers about a scene's geometry: where camera rays end, and which places a light sees."""

from __future__ import annotations

from typing import Any

import numpy as np

from reference.deterministic.ray_spans import Array
from reference.fog_path import bounded_path, is_bounded
from reference.integrator import eye_path, from_light, mi
from reference.mitsuba_scene import instantiate
from scenes.errors import InputError
from scenes.model import Light, Scene

# isort: split
import drjit as dr  # after the integrator, which chose Dr.Jit's LLVM


class ShadowRays:
    """A scene that is asked by rays alone: camera and lights are those of the loaded scene, not Mitsuba's.

    Attributes
    ----------
    extent : float    of the largest side of the box around all surfaces [scene unit]

    Raises
    ------
    InputError
        The variant `scalar_rgb` is in use, in which a ray at a time would take hours.
    """

    def __init__(self, scene: Scene) -> None:
        if mi.variant() == "scalar_rgb":
            raise InputError("Lit intervals need Mitsuba with LLVM or CUDA; `airlight doctor` says what is missing.")
        self._camera = scene.camera
        self._mitsuba = instantiate(scene)
        self._bounded = is_bounded(self._mitsuba.scene)
        box = self._mitsuba.scene.bbox()
        sphere = box.bounding_sphere()
        self._centre, self._radius = np.array(sphere.center, np.float64).ravel(), float(sphere.radius)
        self.extent = float(np.max(np.array(box.max - box.min))) if box.valid() else 0.0

    def t_end(self) -> Array:
        """How far the ray of each pixel sees, to a surface or the far plane, (pixels,) [scene unit]."""
        origin, direction, t_max = self._camera.rays()
        ray = dr.zeros(mi.Ray3f, t_max.size)
        ray.o, ray.d = (mi.Point3f(part.reshape(-1, 3).T) for part in (origin, direction))
        ray.maxt = mi.Float(t_max.ravel())
        path = eye_path(self._mitsuba.scene, mi.Ray3f(ray), self._mitsuba.medium)
        return np.minimum(np.array(path.t_end, np.float64), t_max.ravel())

    def sees(self, light: Light, point: Any) -> Any:
        """Whether the light sees each point, Bool.

        Parameters
        ----------
        point : Point3f or Point3d
        """
        point = mi.Point3f(point)
        ds = dr.zeros(mi.DirectionSample3f, dr.width(point))
        if light.kind == "directional":
            # from beyond every surface
            away = dr.maximum(dr.norm(point - mi.Point3f(self._centre.tolist())), self._radius)
            ds.d, ds.dist = mi.Vector3f((-light.direction).tolist()), 2 * away
            ds.p = point + ds.d * ds.dist
        else:
            ds.p = mi.Point3f(light.position.tolist())
            ds.dist = dr.norm(ds.p - point)
            ds.d = (ds.p - point) / ds.dist
        ray = from_light(ds, 0.0)
        if not self._bounded:
            return ~self._mitsuba.scene.ray_test(ray)
        path = bounded_path(self._mitsuba.scene, ray, mi.Bool(True))
        return ~(path.blocked & (path.t_end < ds.dist))

    def parallel_way(self, point: Array) -> Array:
        """How long a way of parallel light Mitsuba counts before each point, (..., 3) to (...) [scene unit]."""
        return 2 * np.maximum(np.linalg.norm(point - self._centre, axis=-1), self._radius)
