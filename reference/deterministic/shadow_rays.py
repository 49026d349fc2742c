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
        self._meshes_alone = all(shape.is_mesh() for shape in self._mitsuba.scene.shapes())
        box = self._mitsuba.scene.bbox()
        sphere = box.bounding_sphere()
        self._centre, self._radius = np.array(sphere.center, np.float64).ravel(), float(sphere.radius)
        self.extent = float(np.max(np.array(box.max - box.min))) if box.valid() else 0.0

    def t_end(self, positions: Array | None = None) -> Array:
        """How far the ray of each pixel sees, to a surface or the far plane, (pixels,) [scene unit].

        Those through other `positions` in the image, (h, w, 2) as `Camera.rays` takes them, where they are given.

        Asked by the estimator's rays to the last bit: of one that grazes a silhouette either answer is right, and two
        rays that differ by a rounding see a near surface and a far one. One pixel of `yeahright` at 256 x 256 did.
        """
        width, height = self._camera.width, self._camera.height
        if positions is None:
            pixel = dr.arange(mi.UInt32, width * height)
            x, y = pixel % width + 0.5, pixel // width + 0.5
        else:
            x, y = (mi.Float(np.ascontiguousarray(part.ravel(), np.float32)) for part in np.moveaxis(positions, -1, 0))
        place = mi.Point2f(x / width, y / height)
        ray = self._mitsuba.sensor.sample_ray(0.0, 0.0, place, mi.Point2f(0.5))[0]
        path = eye_path(self._mitsuba.scene, ray, self._mitsuba.medium)
        # where nothing stops them they end on the far plane, which the loaded camera knows in float64
        return np.where(
            np.array(path.blocked), np.array(path.t_end, np.float64), self._camera.rays(positions)[2].ravel()
        )

    def sees(self, light: Light, point: Any) -> Any:
        """Whether the light sees each point (Point3f or Point3d), Bool."""
        ray, distance = self._from_light(light, mi.Point3f(point))
        if self._meshes_alone and not self._bounded:
            return ~self._mitsuba.scene.ray_test(ray)
        return self._occluder(ray) >= distance

    def to_occluder(self, light: Light, point: Any) -> Any:
        """How far from the light the first thing is that hides it from each point, Float [scene unit].

        At most as far as the point, of which it is the distance where nothing hides it.
        """
        ray, distance = self._from_light(light, mi.Point3f(point))
        return dr.minimum(self._occluder(ray), distance)

    def parallel_way(self, point: Array) -> Array:
        """How long a way of parallel light Mitsuba counts before each point, (..., 3) to (...) [scene unit]."""
        return 2 * np.maximum(np.linalg.norm(point - self._centre, axis=-1), self._radius)

    def _from_light(self, light: Light, point: Any) -> tuple[Any, Any]:
        """Ray3f from the light to each point, and its length, Float [scene unit]."""
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
        return from_light(ds, 0.0), ds.dist

    def _occluder(self, ray: Any) -> Any:
        """Distance to the first opaque thing, Float, infinite where there is none [scene unit].

        `ray_test`, which takes half the time on a mesh, would not do for a ball: there it takes the discriminant in
        float32, whose rounding shifts the ball's edge by 2^-24 D^2 / r and more, D the way from the light, r the
        radius.
        """
        if not self._bounded:
            return self._mitsuba.scene.ray_intersect_preliminary(ray, coherent=False).t
        path = bounded_path(self._mitsuba.scene, ray, mi.Bool(True))
        return dr.select(path.blocked, path.t_end, dr.inf)
