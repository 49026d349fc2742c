"""What a shadow map says of a ray, by brute force in float64: none of the traversal's code enters.

A ray is cut wherever it meets a plane through the light and a border between two texels, of every tile. The middle of
each part tells its texel, by the largest of its three coordinates or by the tile's matrix, and the part is lit as far
as the texel's distance reaches.
"""

from __future__ import annotations

import itertools

import numpy as np

from gpu_impl.passes.shadow_map import CUBE_FACES, ShadowMap
from scenes.model import Light

Interval = tuple[float, float]


def texel_intervals(
    shadow_map: ShadowMap, stored: np.ndarray, light: Light, origin: np.ndarray, direction: np.ndarray, end: float
) -> list[Interval]:
    """Lit intervals of one ray, (begin, end) each, neighbours merged.

    Parameters
    ----------
    stored : (size, tiles * size)       the map's distances, float64
    origin, direction : (3,)            float64; the direction of unit length
    """
    begin, end = _in_cone(light, origin, direction, end)
    if begin >= end:
        return []
    axes = _axes(shadow_map, light, origin, direction)
    cuts = [begin, end, *_border_crossings(axes, shadow_map.size)]
    cuts = np.unique(np.clip(cuts, begin, end))
    found: list[Interval] = []
    for part in itertools.pairwise(cuts):
        distance = _stored_at(axes, stored, shadow_map.size, 0.5 * sum(part))
        lit = _within(light, origin, direction, distance)
        piece = max(part[0], lit[0]), min(part[1], lit[1])
        if piece[0] >= piece[1]:
            continue
        if found and found[-1][1] == piece[0]:
            found[-1] = found[-1][0], piece[1]
        else:
            found.append(piece)
    return found


def _axes(shadow_map: ShadowMap, light: Light, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Homogeneous position (x, y, w) in each tile at t = 0, and how it changes with t, (tiles, 2, 3)."""
    if len(shadow_map.matrices) == 1:
        matrix = shadow_map.matrices[0].astype(np.float64)[[0, 1, 3]]
        at = matrix @ [*origin, 1.0]
        # a light is the apex of its own map, whatever float32 made of the matrix
        at -= 0 if light.kind == "directional" else matrix @ [*light.position, 1.0]
        return np.array([[at, matrix[:, :3] @ direction]])
    frames = []
    for forward, up in CUBE_FACES:
        right = np.cross(forward, up)
        frames.append([right, up, forward])
    return np.einsum("fij,kj->fki", np.array(frames, float), [origin - light.position, direction])


def _border_crossings(axes: np.ndarray, size: int) -> np.ndarray:
    place = (2.0 * np.arange(size + 1) - size) / size
    crossings = []
    for (x0, y0, w0), (dx, dy, dw) in axes:
        for at, slope in ((x0, dx), (y0, dy)):
            with np.errstate(divide="ignore", invalid="ignore"):
                crossings.append((place * w0 - at) / (slope - place * dw))
    found = np.concatenate(crossings)
    return found[np.isfinite(found)]


def _stored_at(axes: np.ndarray, stored: np.ndarray, size: int, t: float) -> float:
    positions = axes[:, 0] + t * axes[:, 1]
    # the tile along whose axis the point lies furthest
    tile = int(np.argmax(positions[:, 2]))
    x, y, w = positions[tile]
    if max(abs(x), abs(y)) >= w * (1 + 1e-9 * (len(axes) > 1)):
        return np.inf
    column, row = np.minimum((0.5 + 0.5 * np.array([x, y]) / w) * size, size - 1).astype(int)
    return float(stored[row, tile * size + column])


def _within(light: Light, origin: np.ndarray, direction: np.ndarray, distance: float) -> Interval:
    """Where the ray is no further from the light."""
    away = origin - light.position
    if light.kind == "directional":
        slope, room = direction @ light.direction, distance - away @ light.direction
        return (-np.inf, room / slope) if slope > 0 else (room / slope, np.inf)
    t_h = -away @ direction
    square = distance**2 - (away + t_h * direction) @ (away + t_h * direction)
    half = np.sqrt(square) if square > 0 else -np.inf
    return t_h - half, t_h + half


def _in_cone(light: Light, origin: np.ndarray, direction: np.ndarray, end: float) -> Interval:
    """The part of a ray inside a spot's cone of less than 90 degrees."""
    if light.kind != "spot":
        return 0.0, end
    away, cosine = origin - light.position, np.cos(light.cutoff_angle)
    along, height = direction @ light.direction, away @ light.direction
    a, b = along**2 - cosine**2, along * height - cosine**2 * (away @ direction)
    c = height**2 - cosine**2 * (away @ away)
    roots = np.sort(np.roots([a, 2 * b, c]).real) if b * b > a * c else np.empty(0)
    cuts = np.clip([0.0, *roots, end], 0.0, end)
    inside = [
        part
        for part in itertools.pairwise(cuts)
        if part[1] > part[0] and _angle_cosine(light, away + 0.5 * sum(part) * direction) > cosine
    ]
    return inside[0] if inside else (0.0, 0.0)


def _angle_cosine(light: Light, away: np.ndarray) -> float:
    return float(away @ light.direction / np.linalg.norm(away))
