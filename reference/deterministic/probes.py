"""Probes along rays, each of which a light sees or does not, and the lit pieces between them."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.deterministic.equiangular_variable import angle_between, place_at
from reference.deterministic.packets import packed
from reference.deterministic.ray_spans import Array, Rays
from reference.deterministic.shadow_rays import ShadowRays
from reference.integrator import mi
from scenes.model import Light

# isort: split
import drjit as dr  # after the integrator, which chose Dr.Jit's LLVM

Index = NDArray[np.intp]

NONE = np.empty(0, np.intp)
# one wavefront holds at most this many probes, which bounds its memory to a few hundred MB
WAVEFRONT = 1 << 22
# of the largest coordinate: float32 tells no places apart that are closer
RESOLUTION = 2.0**-24
# of the size of the scene: measured, Embree's robust edges are wider than the surface's by 0.55 of this at most (7.9e-6
# of plates of 120)
BLUR = 2.0**-23
# by so many blurs along the ray an edge may be elsewhere for a ray aside
WIDENING = 32.0
TINY = float(np.finfo(np.float64).tiny)
# halvings after which float64 tells none apart either
MOST_HALVINGS = 53
# in units of what float32 resolves: so far before its end a ray is probed for the last time, lest the surface that it
# ends on shades itself
MARGIN = 64.0


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of rays.

    Attributes
    ----------
    ray : (n,) int                   index of the ray
    begin, end : (n,)                [scene unit]
    begin_error, end_error : (n,)    by how much they may be off [scene unit]
    """

    ray: Index
    begin: Array
    end: Array
    begin_error: Array
    end_error: Array

    def __getitem__(self, which: NDArray[np.bool_]) -> Pieces:
        return Pieces(*(getattr(self, one.name)[which] for one in fields(self)))

    @classmethod
    def joined(cls, *parts: Pieces) -> Pieces:
        """All of them, one part after the other."""
        return cls(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(cls)))


@dataclass(frozen=True, eq=False)
class Changes:
    """Changes of visibility along rays, from one probe to the next.

    Attributes
    ----------
    ray : (n,) int         index of the ray
    low, high : (n,)       the two probes [scene unit]
    goes_dark : (n,) bool  the light sees the first and not the second; otherwise the second alone
    """

    ray: Index
    low: Array
    high: Array
    goes_dark: NDArray[np.bool_]

    def __getitem__(self, which: NDArray[np.bool_]) -> Changes:
        return Changes(*(getattr(self, one.name)[which] for one in fields(self)))

    @classmethod
    def joined(cls, *parts: Changes) -> Changes:
        """All of them."""
        return cls(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(cls)))


class Prober:
    """Asks which places of rays one light sees.

    Attributes
    ----------
    reached : (rays,) bool     rays with fog that the light can reach
    resolution : (rays,)       to which a place on the ray is known [scene unit]
    """

    def __init__(self, shadow_rays: ShadowRays, rays: Rays, light: Light) -> None:
        self._shadow_rays, self._rays, self._light = shadow_rays, rays, light
        self._begin, self._end = rays.reached_by(light)
        self.reached = self._end > self._begin
        ends = (rays.origin + place[:, None] * rays.direction for place in (self._begin, self._end))
        self.resolution = np.maximum(RESOLUTION * np.maximum(*(np.abs(end).max(-1) for end in ends)), TINY)
        self._blur = np.maximum(BLUR * shadow_rays.extent, 2 * self.resolution)
        self._begins_lit = np.zeros(self.reached.size, np.bool_)
        self._last = np.maximum(self._begin, self._end - MARGIN * self.resolution)
        h, self._t_h = rays.beside(light)
        self._angle, self._h = angle_between(h, self._begin - self._t_h, self._last - self._t_h)

    def changes(self, which: Index, steps: int) -> tuple[Changes, Index]:
        """Changes along the rays `which`, parted into equal steps, in wavefronts of bounded size.

        Parameters
        ----------
        steps : int    even

        Returns
        -------
        changes : Changes
        finer : (m,) int    those of the rays of which half as many steps show fewer changes
        """
        tile = max(1, WAVEFRONT // (steps + 1))
        found, finer = [Changes(NONE, np.empty(0), np.empty(0), np.empty(0, np.bool_))], [NONE]
        for first in range(0, which.size, tile):
            rays = which[first : first + tile]
            t, lit = self._probes(rays, steps)
            seen = np.array(lit).reshape(rays.size, steps + 1)
            differs, coarsely = seen[:, 1:] != seen[:, :-1], seen[:, 2::2] != seen[:, :-2:2]
            finer.append(rays[differs.sum(1) > coarsely.sum(1)])
            row, step = np.nonzero(differs)
            self._begins_lit[rays] = seen[:, 0]
            probe = row * (steps + 1) + step
            low, high = (np.array(dr.gather(mi.Float64, t, packed(mi.UInt32, one))) for one in (probe, probe + 1))
            found.append(Changes(rays[row], low, high, seen[row, step]))
        return Changes.joined(*found), np.concatenate(finer)

    def lit_pieces(self, which: Index, changes: Changes) -> Pieces:
        """What is lit of the rays `which`, of all of whose changes each is bisected first."""
        place, goes_dark = self._bisected(changes), changes.goes_dark
        error = self._errors(changes, place)
        odd = np.bincount(changes.ray, minlength=self._begins_lit.size) % 2 == 1
        first, last = which[self._begins_lit[which]], which[(self._begins_lit ^ odd)[which]]
        # the fog and the cone are those of float32 numbers; a surface may be met anywhere behind the last probe
        ray, begin, begin_error = _in_order(
            (first, changes.ray[~goes_dark]),
            (self._begin[first], place[~goes_dark]),
            (2 * self.resolution[first], error[~goes_dark]),
        )
        _, end, end_error = _in_order(
            (last, changes.ray[goes_dark]),
            (self._end[last], place[goes_dark]),
            (self._end[last] - self._last[last], error[goes_dark]),
        )
        return Pieces(ray, begin, end, begin_error, end_error)[end > begin]

    def _errors(self, changes: Changes, place: Array) -> Array:
        """By how much changes that were found at these places may be off, (n,) [scene unit].

        An edge is known to the blur, which grows on the way from the light as its shadow does. Along the ray that is
        the more the flatter the ray meets the side of the shadow, of whose slopes in two directions one is known, and
        rays a blur aside, to either hand, show the other.
        """
        blur, way = self._blur[changes.ray] * self._lever(changes), self._way_to_light(changes.ray, place)
        across = np.linalg.norm(np.cross(way, self._rays.direction[changes.ray]), axis=-1)
        along = blur * np.linalg.norm(way, axis=-1) / np.maximum(across, TINY)
        wide = replace(
            changes,
            low=np.maximum(changes.low - WIDENING * along, self._begin[changes.ray]),
            high=np.minimum(changes.high + WIDENING * along, self._last[changes.ray]),
        )
        moved = [np.abs(self._bisected(wide, side * blur) - place) for side in (-1, 1)]
        return np.hypot(np.maximum(*moved), along)

    def _lever(self, changes: Changes) -> Array:
        """How much wider the edge's shadow is at each change than the edge itself, (n,)."""
        dark = np.where(changes.goes_dark, changes.high, changes.low)
        if self._light.kind == "directional" or not dark.size:
            return np.ones(dark.size)
        row = dr.arange(mi.UInt32, dark.size)
        origin, direction = self._spread_rays(changes.ray, row)
        occluder = np.array(self._shadow_rays.to_occluder(self._light, origin + direction * packed(mi.Float64, dark)))
        return np.linalg.norm(self._way_to_light(changes.ray, dark), axis=-1) / np.maximum(occluder, TINY)

    def _probes(self, which: Index, steps: int) -> tuple[Any, Any]:
        """Places, Float64 [scene unit], and whether the light sees them, Bool; ray by ray."""
        # opaque, so that one kernel serves all steps
        number, probes = dr.arange(mi.UInt32, which.size * (steps + 1)), dr.opaque(mi.UInt32, steps + 1)
        row = number // probes
        share = mi.Float64(number - row * probes) / mi.Float64(probes - 1)
        origin, direction = self._spread_rays(which, row)
        begin, last = _spread(self._begin[which], row), _spread(self._last[which], row)
        if self._light.kind == "directional":
            t = begin + share * (last - begin)
        else:
            t_h, h, angle = (_spread(part[which], row) for part in (self._t_h, self._h, self._angle))
            t = t_h + place_at(dr.tan(share * angle), h, begin - t_h)
        t = dr.select(share == 1, last, dr.clip(t, begin, last))
        lit = self._shadow_rays.sees(self._light, origin + direction * t)
        dr.eval(t, lit)
        return t, lit

    def _spread_rays(self, which: Index, row: Any) -> tuple[Any, Any]:
        """Origin and direction, Point3d each."""
        return _spread3(self._rays.origin[which], row), _spread3(self._rays.direction[which], row)

    def _bisected(self, changes: Changes, aside: Array | float = 0.0) -> Array:
        """Where each change is, (n,), or would be if rays ran a little `aside`, (n,), of themselves [scene unit].

        Aside means across the plane of the ray and the light's way to it.
        """
        if not changes.ray.size:
            return np.empty(0)
        widths = (changes.high - changes.low) / self.resolution[changes.ray]
        halvings = min(MOST_HALVINGS, int(np.ceil(np.log2(max(widths.max(), 2)))))
        way = self._way_to_light(changes.ray, 0.5 * (changes.low + changes.high))
        across = np.cross(way, self._rays.direction[changes.ray])
        across *= (aside / np.maximum(np.linalg.norm(across, axis=-1), TINY))[:, None]
        row, lit = dr.arange(mi.UInt32, changes.ray.size), packed(mi.Bool, changes.goes_dark)
        origin, direction = self._spread_rays(changes.ray, row)
        origin += _spread3(across, row)

        def halve(low: Any, high: Any, left: Any) -> tuple[Any, Any, Any]:
            middle = 0.5 * (low + high)
            as_low = self._shadow_rays.sees(self._light, origin + direction * middle) == lit
            return dr.select(as_low, middle, low), dr.select(as_low, high, middle), left - 1

        low, high = (packed(mi.Float64, found) for found in (changes.low, changes.high))
        state = (low, high, dr.full(mi.UInt32, halvings, changes.ray.size))
        low, high, _ = dr.while_loop(state, lambda low, high, left: left > 0, halve)
        return np.array(0.5 * (low + high))

    def _way_to_light(self, ray: Index, place: Array) -> Array:
        """From places on rays, (n,) each, to the light, (n, 3); of any length if it is infinitely far."""
        if self._light.kind == "directional":
            return np.broadcast_to(-self._light.direction, (ray.size, 3))
        return self._light.position - self._rays.origin[ray] - place[:, None] * self._rays.direction[ray]


def _spread(values: Array, row: Any) -> Any:
    return dr.gather(mi.Float64, mi.Float64(values), row)


def _spread3(values: Array, row: Any) -> Any:
    return mi.Point3d(*(_spread(np.ascontiguousarray(values[:, axis]), row) for axis in range(3)))


def _in_order(ray: tuple[Index, Index], place: tuple[Array, Array], error: tuple[Array, Array]) -> tuple[Any, ...]:
    """Places on rays, from two lists, sorted by ray and place."""
    joined = [np.concatenate(part) for part in (ray, place, error)]
    order = np.lexsort([joined[1], joined[0]])
    return tuple(part[order] for part in joined)
