"""Where along rays the scattered light has kinks, which a quadrature should not have inside its pieces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.kinks import kinks_along_ray
from reference.deterministic.ray_spans import Array, Rays, cone_span
from reference.deterministic.spot_picture import texel_crossings
from scenes.model import Light, Scene

Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Stretches:
    """Stretches of rays in any order.

    Attributes
    ----------
    ray : (n,) int       index of the ray
    begin, end : (n,)    [scene unit]
    """

    ray: Index
    begin: Array
    end: Array

    def __getitem__(self, which: NDArray[np.bool_]) -> Stretches:
        return Stretches(self.ray[which], self.begin[which], self.end[which])


def cut(pieces: Stretches, piece: Index, t: Array) -> Stretches:
    """Cut pieces, by their numbers, at places; those that lie outside count for nothing."""
    inside = (t > pieces.begin[piece]) & (t < pieces.end[piece])
    number = np.concatenate([np.arange(pieces.ray.size), piece[inside]])
    begin = np.concatenate([pieces.begin, t[inside]])
    order = np.lexsort([begin, number])
    number, begin = number[order], begin[order]
    last = np.append(number[1:] != number[:-1], True)
    end = np.where(last, pieces.end[number], np.append(begin[1:], np.inf))
    kept = end > begin
    return Stretches(pieces.ray[number[kept]], begin[kept], end[kept])


def cut_at_beam(pieces: Stretches, rays: Rays, light: Light) -> Stretches:
    """Cut at the edge of a spot's full intensity."""
    if light.kind != "spot" or light.beam_width == light.cutoff_angle:
        return pieces
    edges = np.concatenate([edge[pieces.ray] for edge in cone_span(rays, light, light.beam_width)])
    return cut(pieces, np.tile(np.arange(pieces.ray.size), 2), edges)


def cut_at_kinks(pieces: Stretches, rays: Rays, scene: Scene, light: Light) -> Stretches:
    """Cut at all other kinks: of a tabulated phase function, of a spot's picture, and of the fog's boundary."""
    number = np.arange(pieces.ray.size)
    found = []
    if scene.phase.kinks and light.kind != "directional":
        h, t_h = (part[pieces.ray, None] for part in rays.beside(light))
        places = t_h + h * kinks_along_ray(scene.phase)
        found.append((np.repeat(number, places.shape[1]), places.ravel()))
    if light.texture is not None:
        found.append(texel_crossings(light, rays, pieces.ray, pieces.begin, pieces.end))
    if scene.boundary is not None and len(scene.boundary.planes):
        found += _changes_of_face(pieces, rays, scene.boundary.planes, light)
    if not found:
        return pieces
    piece, t = (np.concatenate(part) for part in zip(*found, strict=True))
    return cut(pieces, piece, t)


def cut_by_depth(pieces: Stretches, sigma_t: float) -> Stretches:
    """Cut towards both ends, each part half as long as its neighbour, until the shortest has an optical depth below 1.

    All the light of a thick piece is at one of its ends, where equal parts would hardly find it.
    """
    length = pieces.end - pieces.begin
    halvings = np.ceil(np.log2(np.maximum(sigma_t * length, 1))).astype(np.intp)
    number = np.repeat(np.arange(length.size), halvings)
    power = np.arange(number.size) - np.repeat(np.cumsum(halvings) - halvings, halvings) + 1
    step = length[number] * 0.5**power
    places = np.concatenate([pieces.begin[number] + step, pieces.end[number] - step])
    return cut(pieces, np.tile(number, 2), places)


def _changes_of_face(pieces: Stretches, rays: Rays, planes: Array, light: Light) -> list[tuple[Index, Array]]:
    """Where another face of a polytope takes over as the one through which the light comes to the ray.

    Through the plane of face i the light comes after the share a / (a + c) of its way, a the place's distance inside
    the plane and c the light's outside it; parallel light after the length a / c, c the rate at which it nears the
    plane. Both grow with q = a / c, which is linear along the ray; the face with the least q decides.
    """
    normal, offset = planes[:, :3], planes[:, 3]
    c = -normal @ light.direction if light.kind == "directional" else normal @ light.position - offset
    normal, offset, c = normal[c > 0], offset[c > 0], c[c > 0]
    if not c.size:
        return []
    number = np.arange(pieces.ray.size)
    level = (offset - rays.origin[pieces.ray] @ normal.T) / c
    slope = -(rays.direction[pieces.ray] @ normal.T) / c
    face = np.lexsort([slope, level + slope * pieces.begin[:, None]], axis=-1)[:, 0]
    found = []
    # a face that falls less never takes over, so each does once at most
    for _ in range(c.size - 1):
        mine = np.arange(number.size), face
        falls = slope < slope[mine][:, None]
        gap, rate = level - level[mine][:, None], slope[mine][:, None] - slope
        meets = np.divide(gap, rate, out=np.full_like(gap, np.inf), where=falls)
        face = meets.argmin(axis=1)
        t = meets[np.arange(number.size), face]
        going = t < pieces.end[number]
        number, level, slope, face = number[going], level[going], slope[going], face[going]
        found.append((number, t[going]))
    return found
