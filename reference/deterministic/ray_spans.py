"""Pieces of camera rays that light can reach, in float64: inside the body of the fog and inside the cones of spots."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenes.boundary import Boundary
from scenes.model import Light, Scene

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Rays:
    """Rays through the pixel centres, in row order, or some of them.

    Attributes
    ----------
    origin, direction : (n, 3)    the direction of unit length [scene unit]
    fog_begin, fog_end : (n,)     where the fog begins and ends, as far as the eye sees [scene unit]; the first again
                                  where the ray meets none
    """

    origin: Array
    direction: Array
    fog_begin: Array
    fog_end: Array

    @classmethod
    def of_camera(cls, scene: Scene, t_end: Array, positions: Array | None = None) -> Rays:
        """Rays of the scene's camera that end at t_end, (pixels,), or those through `positions`, (h, w, 2)."""
        origin, direction, _ = (part.reshape(t_end.size, -1) for part in scene.camera.rays(positions))
        enter, leave = chord(scene.boundary, origin, direction)
        begin = np.clip(enter, 0, t_end)
        return cls(origin, direction, begin, np.clip(leave, begin, t_end))

    def __getitem__(self, which: NDArray[np.intp]) -> Rays:
        return Rays(self.origin[which], self.direction[which], self.fog_begin[which], self.fog_end[which])

    def __len__(self) -> int:
        return self.fog_end.size

    def beside(self, light: Light) -> tuple[Array, Array]:
        """Where the rays pass a light: distance h, and t_h of the light's projection, (n,) each [scene unit]."""
        to_light = light.position - self.origin
        h = np.linalg.norm(np.cross(to_light, self.direction), axis=-1)
        return h, np.einsum("ij,ij->i", to_light, self.direction)

    def reached_by(self, light: Light) -> tuple[Array, Array]:
        """Begin and end of the fog inside a spot's cone, or of all the fog, (n,) each; equal where there is none."""
        begin, end = self.fog_begin, self.fog_end
        if light.kind == "spot":
            enter, leave = cone_span(self, light, light.cutoff_angle)
            begin, end = np.maximum(begin, enter), np.minimum(end, leave)
        return begin, np.maximum(begin, end)


def chord(boundary: Boundary | None, origin: Array, direction: Array) -> tuple[Array, Array]:
    """Where a line enters a convex body and leaves it, (...) each; it misses the body if it leaves before it enters.

    Parameters
    ----------
    boundary : Boundary or None    None for fog that fills space
    origin, direction : (..., 3)   directions of unit length
    """
    enter, leave = np.full(origin.shape[:-1], -np.inf), np.full(origin.shape[:-1], np.inf)
    if boundary is None:
        return enter, leave
    if boundary.ball is not None:
        # counted from the projection of the centre, where nothing cancels
        to_centre = boundary.ball[:3] - origin
        t_c = np.einsum("...i,...i->...", to_centre, direction)
        away = np.linalg.norm(to_centre - t_c[..., None] * direction, axis=-1)
        radius = boundary.ball[3]
        half = np.sqrt(np.maximum((radius - away) * (radius + away), 0))
        return t_c - half, t_c + half
    for *normal, offset in boundary.planes:
        slope, inside = direction @ np.array(normal), offset - origin @ np.array(normal)
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = inside / slope
        leave = np.where(slope > 0, np.minimum(leave, crossing), leave)
        enter = np.where(slope < 0, np.maximum(enter, crossing), enter)
        leave = np.where((slope == 0) & (inside < 0), -np.inf, leave)
    return enter, leave


def cone_span(rays: Rays, light: Light, half_angle: float) -> tuple[Array, Array]:
    """Where rays enter and leave the cone of a spot, (n,) each, maybe infinite; equal where they miss it.

    Counted from the light's projection, s = t - t_h, the point is q + s d with q orthogonal to d, and in the double
    cone of half-angle alpha where |(q + s d) x axis|^2 <= sin^2 alpha |q + s d|^2: with the sine a narrow cone keeps
    its digits.

    Parameters
    ----------
    half_angle : float    below pi / 2 [rad]
    """
    _, t_h = rays.beside(light)
    d, axis = rays.direction, light.direction
    q = rays.origin + t_h[:, None] * d - light.position
    along_d, along_q, sine2 = d @ axis, q @ axis, np.sin(half_angle) ** 2
    d_across, q_across = np.cross(d, axis), np.cross(q, axis)
    # inside where a s^2 + 2 b s + c >= 0
    a = sine2 - (d_across * d_across).sum(-1)
    b = -(q_across * d_across).sum(-1)
    c = sine2 * (q * q).sum(-1) - (q_across * q_across).sum(-1)
    a = np.where(np.abs(a) < 1e-15, 1e-15, a)
    discriminant = b * b - a * c
    # the root without cancellation first, the other from the product of the two
    larger = -(b + np.where(b < 0, -1, 1) * np.sqrt(np.maximum(discriminant, 0)))
    with np.errstate(divide="ignore", invalid="ignore"):
        roots = np.stack([larger / a, np.where(larger == 0, 0.0, c / larger)])
    low, high = roots.min(0), roots.max(0)
    # a > 0: either end of the line is in a nappe, and the lit one lies where it runs along the axis; a < 0: the line
    # passes through one nappe, maybe the dark one behind the light, or through none
    crosses = a < 0
    enter = np.where(crosses, low, np.where(along_d > 0, high, -np.inf))
    leave = np.where(crosses, high, np.where(along_d > 0, np.inf, low))
    misses = crosses & ((discriminant <= 0) | (along_q + 0.5 * (low + high) * along_d < 0))
    return np.where(misses, t_h, t_h + enter), np.where(misses, t_h, t_h + leave)
