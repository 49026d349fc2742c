"""A picture looked up as Mitsuba's `bitmap` does, in float64, and where a ray's way across it has kinks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reference.deterministic.ray_spans import Array, Rays
from scenes.model import Light, Texture

Index = NDArray[np.intp]


def looked_up(texture: Texture, uv: Array) -> Array:
    """Colours at texture coordinates, (..., 2) to (..., 3); row 0 is at v = 0, texel centres at (i + 1/2) / n."""
    height, width = texture.pixels.shape[:2]
    place = (uv @ texture.to_uv[:, :2].T + texture.to_uv[:, 2]) * np.array([width, height])
    if texture.nearest:
        return _texels(texture, np.floor(place))
    place = place - 0.5
    base = np.floor(place)
    x, y = np.moveaxis(place - base, -1, 0)[..., None]
    rows = [
        (1 - x) * _texels(texture, base + np.array([0, row])) + x * _texels(texture, base + np.array([1, row]))
        for row in (0, 1)
    ]
    return (1 - y) * rows[0] + y * rows[1]


def _texels(texture: Texture, number: Array) -> Array:
    """Texels by their column and row, (..., 2) to (..., 3), which may be beyond the picture."""
    places = []
    for axis, size in ((0, texture.pixels.shape[1]), (1, texture.pixels.shape[0])):
        place = number[..., axis].astype(np.int64)
        if texture.wrap == "clamp":
            place = np.clip(place, 0, size - 1)
        elif texture.wrap == "mirror":
            place = place % (2 * size)
            place = np.minimum(place, 2 * size - 1 - place)
        else:
            place = place % size
        places.append(place)
    return texture.pixels[places[1], places[0]].astype(np.float64)


def texel_crossings(light: Light, rays: Rays, ray: Index, begin: Array, end: Array) -> tuple[Index, Array]:
    """Where pieces of rays cross from one texel, or one square between four texel centres, to the next.

    Parameters
    ----------
    light : Light        a spot with a picture
    ray : (n,) int       the ray of each piece, all in front of the light
    begin, end : (n,)    [scene unit]

    Returns
    -------
    piece : (m,) int
    t : (m,)             [scene unit]
    """
    texture = light.texture
    assert texture is not None
    height, width = texture.pixels.shape[:2]
    # texel coordinates (x / z, y / z) are quotients of functions that are linear along the ray
    to_local = np.linalg.inv(light.to_world[:3, :3])
    to_uv = np.array([[0.5 / np.tan(light.cutoff_angle), 0, 0.5], [0, 0.5 / np.tan(light.cutoff_angle), 0.5]])
    to_place = np.diag([width, height]) @ (texture.to_uv[:, :2] @ to_uv + np.outer(texture.to_uv[:, 2], [0, 0, 1]))
    rows = np.vstack([to_place, [0, 0, 1]]) @ to_local
    if not texture.nearest:
        rows[:2] -= 0.5 * rows[2]
    level, slope = (rays.origin[ray] - light.position) @ rows.T, rays.direction[ray] @ rows.T
    pieces, places = [], []
    for axis in (0, 1):
        first, last = ((level[:, axis] + t * slope[:, axis]) / (level[:, 2] + t * slope[:, 2]) for t in (begin, end))
        low, high = np.ceil(np.minimum(first, last)), np.floor(np.maximum(first, last))
        # not finite at the light itself, where no line is crossed
        count = np.where(np.isfinite(high - low), np.maximum(high - low + 1, 0), 0).astype(np.intp)
        piece = np.repeat(np.arange(ray.size), count)
        line = low[piece] + np.arange(piece.size) - np.repeat(np.cumsum(count) - count, count)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (line * level[piece, 2] - level[piece, axis]) / (slope[piece, axis] - line * slope[piece, 2])
        pieces.append(piece)
        places.append(t)
    return np.concatenate(pieces), np.concatenate(places)
