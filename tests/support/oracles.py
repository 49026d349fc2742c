"""Closed forms in float64 that the renderers are tested against; none of the renderers' own code enters."""

from __future__ import annotations

import itertools

import numpy as np

from analytic import airlight
from scenes.model import Light, Scene

SPHERE_CENTRE, SPHERE_RADIUS, FLOOR_HALF = np.array([0.0, 1.6, 0.0]), 0.6, 8.0


def piece_airlight(scene: Scene, light: Light, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Airlight that reaches the eye from [begin, end] of each pixel's ray, (H, W, 3); 0 where end <= begin."""
    origin, direction, _ = scene.camera.rays()
    to_light = light.position - origin
    t_h = np.einsum("hwi,hwi->hw", to_light, direction)
    h = np.linalg.norm(np.cross(to_light, direction), axis=-1)
    end = np.maximum(begin, end)
    value = airlight(h, begin - t_h, end - t_h, scene.medium, scene.phase)
    grey = np.ndim(scene.medium.sigma_t) == 0
    value = (value[..., None] if grey else value) * light.intensity
    return value * np.exp(-np.multiply.outer(begin, np.broadcast_to(scene.medium.sigma_t, 3)))


def whole_ray_airlight(scene: Scene) -> np.ndarray:
    """Airlight of point lights without any occluder, (H, W, 3)."""
    t_max = scene.camera.rays()[2]
    return sum(piece_airlight(scene, light, np.zeros_like(t_max), t_max) for light in scene.lights)


def cone_interval(scene: Scene, apex: np.ndarray, axis: np.ndarray, half_angle: float, t_max: np.ndarray):
    """Part of each ray inside one nappe of a cone of less than 90 degrees, (begin, end); empty where end <= begin."""
    origin, direction, _ = scene.camera.rays()
    q = origin - apex
    cos2 = np.cos(half_angle) ** 2
    along, height = direction @ axis, q @ axis
    a = along**2 - cos2
    b = along * height - cos2 * (direction * q).sum(-1)
    c = height**2 - cos2 * (q * q).sum(-1)
    discriminant = b * b - a * c
    root = np.sqrt(np.maximum(discriminant, 0))
    low, high = np.minimum((-b - root) / a, (-b + root) / a), np.maximum((-b - root) / a, (-b + root) / a)
    # a > 0: the ray crosses into or out of the nappe once; a < 0: it runs through one of the two nappes or past both
    begin = np.where(a > 0, np.where(along > 0, high, 0.0), low)
    end = np.where(a > 0, np.where(along > 0, t_max, low), high)
    misses = (a < 0) & ((discriminant <= 0) | (height + 0.5 * (low + high) * along < 0))
    begin, end = np.clip(begin, 0, t_max), np.clip(end, 0, t_max)
    return begin, np.where(misses, begin, end)


def spot_airlight(scene: Scene) -> np.ndarray:
    """Airlight of hard-edged spots without any occluder, (H, W, 3)."""
    t_max = scene.camera.rays()[2]
    return sum(
        piece_airlight(scene, light, *cone_interval(scene, light.position, light.direction, light.cutoff_angle, t_max))
        for light in scene.lights
    )


def soft_spot_airlight(scene: Scene, nodes: int = 100) -> np.ndarray:
    """Airlight of soft spots without any occluder, (H, W, 3), by Gauss-Legendre on the smooth parts of each ray.

    The falloff is linear in the angle from beam_width to cutoff_angle and has kinks where the ray meets either cone.
    """
    origin, direction, t_max = scene.camera.rays()
    x, weights = np.polynomial.legendre.leggauss(nodes)
    total = np.zeros((*t_max.shape, 3))
    sigma_s, sigma_t = (np.broadcast_to(s, 3) for s in (scene.medium.sigma_s, scene.medium.sigma_t))
    for light in scene.lights:
        outer = cone_interval(scene, light.position, light.direction, light.cutoff_angle, t_max)
        inner = cone_interval(scene, light.position, light.direction, light.beam_width, t_max)
        inner = [np.where(inner[1] > inner[0], edge, 0.5 * (outer[0] + outer[1])) for edge in inner]
        cuts = [outer[0], *(np.clip(edge, *outer) for edge in inner), outer[1]]
        for begin, end in itertools.pairwise(cuts):
            half = 0.5 * (end - begin)
            for node, weight in zip(x, weights, strict=True):
                t = begin + half * (1 + node)
                from_light = origin + t[..., None] * direction - light.position
                d = np.linalg.norm(from_light, axis=-1)
                angle = np.arccos(np.clip(from_light @ light.direction / d, -1, 1))
                falloff = np.clip((light.cutoff_angle - angle) / (light.cutoff_angle - light.beam_width), 0, 1)
                cosine = -np.einsum("hwi,hwi->hw", from_light, direction) / d
                power = weight * half * falloff * scene.phase.evaluate(cosine) / d**2
                total += power[..., None] * light.intensity * sigma_s * np.exp(-np.multiply.outer(t + d, sigma_t))
    return total


class SphereScene:
    """What each pixel's ray meets in sphere.xml: where it ends, and which pieces of it are lit.

    The umbra of the sphere is the tangent cone from the light, beyond the tangent circle (rays end on the sphere, so
    what the ray has of the cone before that circle is lit). A ray that passes beyond the floor's rim dips below it,
    into the pyramid that the floor shades. Both umbras are convex: each takes one interval from a ray.

    Attributes
    ----------
    scene : Scene
    t_end : (H, W)     distance to the sphere, the floor or the far plane [scene unit]
    on_sphere, on_floor : (H, W) bool
    shadows : list of (begin, end), (H, W) each; the sphere's, then the floor's
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        (light,) = scene.lights
        origin, direction, t_max = scene.camera.rays()
        q = origin - SPHERE_CENTRE
        b = (q * direction).sum(-1)
        discriminant = b * b - (q * q).sum(-1) + SPHERE_RADIUS**2
        t_sphere = np.where(discriminant > 0, -b - np.sqrt(np.maximum(discriminant, 0)), np.inf)
        with np.errstate(divide="ignore"):
            t_floor = -origin[..., 1] / direction[..., 1]
        with np.errstate(invalid="ignore"):
            across = np.abs(origin + t_floor[..., None] * direction)[..., [0, 2]].max(-1)
        t_floor = np.where((t_floor > 0) & (across <= FLOOR_HALF), t_floor, np.inf)
        self.t_end = np.minimum(np.minimum(t_sphere, t_floor), t_max)
        self.on_sphere, self.on_floor = self.t_end == t_sphere, self.t_end == t_floor

        to_centre = SPHERE_CENTRE - light.position
        distance = np.linalg.norm(to_centre)
        axis = to_centre / distance
        cone = cone_interval(scene, light.position, axis, np.arcsin(SPHERE_RADIUS / distance), self.t_end)
        # the tangent circle lies in this plane
        behind = self._half_space(axis, light.position @ axis + distance - SPHERE_RADIUS**2 / distance)
        below = self._half_space(np.array([0.0, -1.0, 0.0]), 0.0)
        rims = []
        for side in (0, 2):
            for sign in (-1, 1):
                # the plane through the light and one edge of the floor, its normal towards the floor's side
                normal = np.zeros(3)
                normal[side] = -sign * light.position[1]
                normal[1] = sign * light.position[side] - FLOOR_HALF
                rims.append(self._half_space(normal, light.position @ normal))
        self.shadows = [self._meet(cone, behind), self._meet(below, *rims)]

    def _half_space(self, normal: np.ndarray, offset: float) -> tuple[np.ndarray, np.ndarray]:
        """Where the ray has x . normal >= offset."""
        origin, direction, _ = self.scene.camera.rays()
        slope, start = direction @ normal, origin @ normal - offset
        crossing = -start / np.where(slope == 0, 1e-300, slope)
        return (
            np.where(slope > 0, np.clip(crossing, 0, self.t_end), 0.0),
            np.where(slope > 0, self.t_end, np.clip(crossing, 0, self.t_end)),
        )

    @staticmethod
    def _meet(*intervals: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        begin = np.maximum.reduce([interval[0] for interval in intervals])
        end = np.minimum.reduce([interval[1] for interval in intervals])
        return begin, np.maximum(begin, end)

    def lit(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """The lit pieces of each ray, three at most; empty ones have no length."""
        # an empty shadow is moved to the end of the ray, where it parts nothing
        shadows = [np.where(end > begin, (begin, end), self.t_end) for begin, end in self.shadows]
        first, second = np.where(shadows[0][0] <= shadows[1][0], shadows, shadows[::-1])
        pieces = [
            (np.zeros_like(self.t_end), first[0]),
            (first[1], second[0]),
            (np.maximum(first[1], second[1]), self.t_end),
        ]
        return [(begin, np.maximum(begin, end)) for begin, end in pieces]

    def scattering(self) -> np.ndarray:
        """Airlight, (H, W, 3)."""
        (light,) = self.scene.lights
        return sum(piece_airlight(self.scene, light, *piece) for piece in self.lit())

    def surface(self) -> np.ndarray:
        """Direct light on the two diffuse surfaces, attenuated on both legs, (H, W, 3)."""
        (light,) = self.scene.lights
        origin, direction, _ = self.scene.camera.rays()
        point = origin + self.t_end[..., None] * direction
        to_light = light.position - point
        d = np.linalg.norm(to_light, axis=-1)
        up = np.array([0.0, 1.0, 0.0])
        normal = np.where(self.on_sphere[..., None], (point - SPHERE_CENTRE) / SPHERE_RADIUS, up)
        cosine = np.maximum((normal * to_light).sum(-1) / d, 0)
        # a floor point is dark where its ray ends inside the sphere's umbra
        begin, end = self.shadows[0]
        dark = self.on_floor & (end == self.t_end) & (end > begin)
        reflectance = np.where(self.on_sphere[..., None], [0.7, 0.25, 0.2], 0.6)
        sigma_t = np.broadcast_to(self.scene.medium.sigma_t, 3)
        attenuated = np.exp(-np.multiply.outer(self.t_end + d, sigma_t))
        hit = (self.on_sphere | self.on_floor) & ~dark
        return (hit * cosine / d**2)[..., None] * reflectance / np.pi * light.intensity * attenuated
