"""Occluders, cones and boxes of fog, and where a ray meets them in closed form, float64.

A ray is cut wherever what the light sees of it can change; each piece is then lit or dark as its middle is, which a
test of one point decides without any of the algebra. A root is off by some 1e-15 of the distances, or 1e-11 where a ray
grazes a cone. None of the renderers' code enters.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from scenes.model import Camera, Light

BLACK = "<bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf>"


@dataclass(frozen=True)
class Ray:
    """A camera's ray: `origin` on the near plane, unit `direction`, (3,) each, and where it ends [scene unit]."""

    origin: np.ndarray
    direction: np.ndarray
    end: float

    def at(self, t: float) -> np.ndarray:
        """The point at a distance."""
        return self.origin + t * self.direction


class Limit(Protocol):
    """What parts light from dark on a ray."""

    def cuts(self, ray: Ray, light: Light) -> list[float]:
        """Distances at which the ray may pass from light to dark or back."""

    def hides(self, light: Light, point: np.ndarray) -> bool:
        """Whether the light does not reach the point."""


@dataclass(frozen=True)
class Ball:
    """A black ball. Its shadow is the cone of tangents from the light, from the circle where they touch on."""

    centre: tuple[float, float, float]
    radius: float

    def xml(self) -> str:
        """Mitsuba's shape."""
        x, y, z = self.centre
        where = f"<point name='center' x='{x}' y='{y}' z='{z}'/><float name='radius' value='{self.radius}'/>"
        return f"<shape type='sphere'>{where}{BLACK}</shape>"

    def first_hit(self, ray: Ray) -> float:
        """Distance at which the ray ends on it; infinite where it passes."""
        away = ray.origin - self.centre
        b = away @ ray.direction
        root = b * b - away @ away + self.radius**2
        return float(-b - np.sqrt(root)) if root > 0 > b else np.inf

    def cuts(self, ray: Ray, light: Light) -> list[float]:
        """Where it crosses the cone; from the ball's lit side to the dark one no ray gets but through it."""
        axis = np.subtract(self.centre, light.position)
        distance = float(np.linalg.norm(axis))
        axis = axis / distance
        cosine = float(np.sqrt(1 - (self.radius / distance) ** 2))
        return crossings_of_cone(ray, light.position, axis, cosine)

    def hides(self, light: Light, point: np.ndarray) -> bool:
        """Whether the straight way from the light passes through it."""
        way = point - light.position
        nearest = np.clip(np.subtract(self.centre, light.position) @ way / (way @ way), 0, 1)
        return bool(np.linalg.norm(light.position + nearest * way - self.centre) < self.radius)


@dataclass(frozen=True)
class Plate:
    """A black level plate at height y from x0 to x1; along z it goes on beyond whatever a ray reaches."""

    y: float
    x0: float
    x1: float
    half_depth: float = 60.0

    def xml(self) -> str:
        """Mitsuba's shape."""
        half, middle = (self.x1 - self.x0) / 2, (self.x1 + self.x0) / 2
        return (
            "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/>"
            f"<scale x='{half}' z='{self.half_depth}'/><translate x='{middle}' y='{self.y}'/></transform>"
            f"{BLACK}</shape>"
        )

    def first_hit(self, ray: Ray) -> float:
        """Distance at which the ray ends on it; infinite where it passes."""
        (t,) = crossing_of_plane(ray, np.array([0, self.y, 0]), np.array([0, 1.0, 0])) or [-1.0]
        return t if t > 0 and self.x0 < ray.at(t)[0] < self.x1 else np.inf

    def cuts(self, ray: Ray, light: Light) -> list[float]:
        """Where it crosses the planes through the light and either edge, and the plate's own."""
        up = np.array([0, 1.0, 0])
        found = crossing_of_plane(ray, np.array([0, self.y, 0]), up)
        for x in (self.x0, self.x1):
            edge = np.array([x, self.y, light.position[2]])
            found += crossing_of_plane(ray, edge, np.cross(edge - light.position, [0, 0, 1.0]))
        return found

    def hides(self, light: Light, point: np.ndarray) -> bool:
        """Whether the straight way from the light passes through it."""
        share = (self.y - light.position[1]) / (point[1] - light.position[1])
        return bool(0 < share < 1 and self.x0 < light.position[0] + share * (point[0] - light.position[0]) < self.x1)


@dataclass(frozen=True)
class Cone:
    """The edge of the spots' light."""

    def cuts(self, ray: Ray, light: Light) -> list[float]:
        """Where it crosses the cone."""
        return crossings_of_cone(ray, light.position, light.direction, float(np.cos(light.cutoff_angle)))

    def hides(self, light: Light, point: np.ndarray) -> bool:
        """Whether the point is outside."""
        way = point - light.position
        return bool(way @ light.direction <= np.cos(light.cutoff_angle) * np.linalg.norm(way))


@dataclass(frozen=True)
class Box:
    """Fog between -half and +half of each axis; all its light comes in by the top, y = half[1]."""

    half: tuple[float, float, float]

    def xml(self) -> str:
        """Mitsuba's shape, which holds the medium `fog`."""
        x, y, z = self.half
        size = f"<transform name='to_world'><scale x='{x}' y='{y}' z='{z}'/></transform>"
        return f"<shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/>{size}</shape>"

    def within(self, ray: Ray) -> tuple[float, float]:
        """First and last distance in the fog; equal where the ray meets none."""
        faces = np.multiply.outer([-1, 1], self.half)
        with np.errstate(divide="ignore"):
            distances = (faces - ray.origin) / ray.direction
        begin = max(0.0, float(distances.min(axis=0).max()))
        return begin, max(begin, min(ray.end, float(distances.max(axis=0).min())))


def crossing_of_plane(ray: Ray, point: np.ndarray, normal: np.ndarray) -> list[float]:
    """Distance at which the ray crosses a plane, if it does."""
    slope = float(ray.direction @ normal)
    return [float((point - ray.origin) @ normal) / slope] if slope else []


def crossings_of_cone(ray: Ray, apex: np.ndarray, axis: np.ndarray, cosine: float) -> list[float]:
    """Distances at which the ray crosses a double cone of this cosine of its half-angle."""
    away = ray.origin - apex
    along, height = ray.direction @ axis, away @ axis
    a = along**2 - cosine**2
    b = along * height - cosine**2 * (ray.direction @ away)
    c = height**2 - cosine**2 * (away @ away)
    if b * b < a * c:
        return []
    # the root that cancels comes from the product of both
    large = -b - np.copysign(np.sqrt(b * b - a * c), b)
    return [float(part) for part in ([large / a] if a else []) + ([c / large] if large else [])]


def rays_of(camera: Camera, occluders: Sequence[Ball | Plate]) -> list[Ray]:
    """Rays through the pixels' centres in row order, each up to the far plane or to the first thing in its way."""
    origin, direction, t_max = (part.reshape(-1, *part.shape[2:]) for part in camera.rays())
    rays = []
    for o, d, end in zip(origin, direction, t_max, strict=True):
        ray = Ray(o, d, float(end))
        rays.append(Ray(o, d, min([ray.end, *(occluder.first_hit(ray) for occluder in occluders)])))
    return rays


def lit_pieces(
    ray: Ray, light: Light, limits: Sequence[Limit], within: tuple[float, float]
) -> list[tuple[float, float]]:
    """Lit pieces of the part `within` of a ray, (begin, end) [scene unit]; pieces may touch."""
    inner = {t for limit in limits for t in limit.cuts(ray, light) if within[0] < t < within[1]}
    pieces = itertools.pairwise([within[0], *sorted(inner), within[1]])
    return [
        (begin, end)
        for begin, end in pieces
        if end > begin and not any(limit.hides(light, ray.at((begin + end) / 2)) for limit in limits)
    ]
