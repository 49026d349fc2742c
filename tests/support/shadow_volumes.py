"""Shadows of the shipped scenes that have closed forms: convex volumes, each of which takes one interval from a ray.

The numbers are those of the scene files. Floors cast shadows too, but only below themselves, where no ray gets.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from oracles import cone_interval, piece_airlight

from scenes.model import Scene

Interval = tuple[np.ndarray, np.ndarray]


def half_space(scene: Scene, normal: np.ndarray, point: np.ndarray, t_end: np.ndarray) -> Interval:
    """Part of each ray where (x - point) . normal >= 0, (begin, end); empty where end <= begin."""
    origin, direction, _ = scene.camera.rays()
    slope, start = direction @ normal, (origin - point) @ normal
    crossing = np.clip(-start / np.where(slope == 0, 1e-300, slope), 0, t_end)
    return np.where(slope > 0, crossing, 0.0), np.where(slope > 0, t_end, crossing)


def meet(*intervals: Interval) -> Interval:
    """What the intervals have in common."""
    begin = np.maximum.reduce([interval[0] for interval in intervals])
    return begin, np.maximum(begin, np.minimum.reduce([interval[1] for interval in intervals]))


def behind_polygon(scene: Scene, corners: list[tuple[float, float, float]], t_end: np.ndarray) -> Interval:
    """Part of each ray in the shadow of a convex polygon, or of one that goes on without end between two corners."""
    (light,) = scene.lights
    points = np.array(corners)
    centre = points.mean(axis=0)
    plane = np.cross(points[1] - points[0], points[-1] - points[0])
    sides = [(plane * -np.sign((light.position - centre) @ plane), points[0])]
    for a, b in zip(points, np.roll(points, -1, axis=0), strict=True):
        normal = np.cross(a - light.position, b - light.position)
        sides.append((normal * np.sign((centre - light.position) @ normal), light.position))
    return meet(*(half_space(scene, normal, point, t_end) for normal, point in sides))


def behind_ball(scene: Scene, centre: np.ndarray, radius: float, t_end: np.ndarray) -> Interval:
    """Part of each ray in the shadow of a ball: in the tangent cone, beyond the tangent circle."""
    (light,) = scene.lights
    distance = float(np.linalg.norm(centre - light.position))
    axis = (centre - light.position) / distance
    cone = cone_interval(scene, light.position, axis, float(np.arcsin(radius / distance)), t_end)
    return meet(cone, half_space(scene, axis, light.position + axis * (distance - radius**2 / distance), t_end))


def plate(x0: float, x1: float, y: float) -> list[tuple[float, float, float]]:
    """Corners of a level plate from z = -40 to 40."""
    return [(x0, y, -40), (x1, y, -40), (x1, y, 40), (x0, y, 40)]


BOARD = [(-1.32, 1.19, 4.4), (-0.52, 1.19, 4.4), (-0.52, 1.49, 4.4), (-1.32, 1.49, 4.4)]
SHADOWS: dict[str, Callable[[Scene, np.ndarray], list[Interval]]] = {
    "half_plane": lambda scene, t_end: [behind_polygon(scene, plate(-80, 0, 1.9), t_end)],
    "slit": lambda scene, t_end: [
        behind_polygon(scene, plate(-80.25, -0.25, 2.2), t_end),
        behind_polygon(scene, plate(0.25, 80.25, 2.2), t_end),
    ],
    "eye_in_shadow": lambda scene, t_end: [behind_ball(scene, np.array([0, 1.7, 0]), 0.7, t_end)],
    "light_behind_eye": lambda scene, t_end: [
        behind_ball(scene, np.array([-0.3, 1.66, 2.6]), 0.42, t_end),
        behind_polygon(scene, BOARD, t_end),
    ],
}


def shadowed_airlight(scene: Scene, t_end: np.ndarray) -> np.ndarray:
    """Airlight of a scene of SHADOWS whose rays end at t_end (H, W), (H, W, 3); its shadows do not overlap."""
    (light,) = scene.lights
    dark = [piece_airlight(scene, light, *interval) for interval in SHADOWS[scene.name](scene, t_end)]
    return piece_airlight(scene, light, np.zeros_like(t_end), t_end) - sum(dark)
