"""The plane through a ray and a light: in it lies every shadow ray of the ray's points, so all that decides them.

Coordinates are (x, y), x along the ray from its origin, y towards the light, in the scene's unit: the light is at
(x_h, h) of Weng 2010, Figure 4.6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenes.model import Light, Mesh, Scene

Array = NDArray[np.float64]

# a hit nearer than this share of the way to a point is the surface that the point stands on
OWN_SURFACE = 1e-6
# how far beside a corner, as the light sees it, is before it and behind it [rad]
BESIDE = 1e-7


@dataclass(frozen=True, eq=False)
class RayPlane:
    """What lies in the plane of one ray and one light.

    Attributes
    ----------
    light : (2,)           its place
    cuts : (n, 2, 2)       where surfaces cut the plane, straight pieces from end to end
    wedge : (2,) or None   directions between which a spot shines [rad]; None for a point light, or a spot whose cone
                           the plane holds more than half a turn of
    """

    light: Array
    cuts: Array
    wedge: Array | None

    @classmethod
    def of_ray(cls, scene: Scene, light: Light, origin: Array, direction: Array) -> RayPlane:
        """Cut a scene by the plane through a ray, `direction` being of unit length, and a light beside it.

        Raises
        ------
        ValueError
            The light lies on the ray, and no plane is the plane of both.
        """
        to_light = light.position - origin
        x_h = float(to_light @ direction)
        across = to_light - x_h * direction
        h = float(np.linalg.norm(across))
        if h < 1e-9 * np.linalg.norm(to_light):
            raise ValueError("light must lie beside the ray, not on it")
        frame = np.stack([direction, across / h, np.cross(direction, across / h)])
        cuts = [_cut(mesh, origin, frame) for mesh in scene.meshes]
        found = np.concatenate(cuts) if cuts else np.empty((0, 2, 2))
        return cls(np.array([x_h, h]), found, _wedge(light, frame))

    def sees(self, points: Array) -> NDArray[np.bool_]:
        """Whether the light reaches places (m, 2): inside its cone, and nothing in between; (m,)."""
        way = np.asarray(points, float) - self.light
        seen = self.first_hit(way) > 1 - OWN_SURFACE
        if self.wedge is None:
            return seen
        turn = np.mod(np.arctan2(way[:, 1], way[:, 0]) - self.wedge[0], 2 * np.pi)
        return seen & (turn <= self.wedge[1] - self.wedge[0])

    def first_hit(self, ways: Array) -> Array:
        """How many times `ways` (m, 2) from the light end on the first surface, (m,); inf where there is none."""
        begin, edge = self.cuts[:, 0] - self.light, self.cuts[:, 1] - self.cuts[:, 0]
        hits = np.full(len(ways), np.inf)
        for i, way in enumerate(ways):
            with np.errstate(divide="ignore", invalid="ignore"):
                # light + s way = begin + r edge
                denominator = _cross(way, edge)
                s, r = _cross(begin, edge) / denominator, _cross(begin, way) / denominator
            hits[i] = np.min(s, initial=np.inf, where=(r >= 0) & (r <= 1) & (s > 0))
        return hits

    def lit_outline(self, reach: float) -> Array:
        """Corners of all that the light reaches within a distance, (k, 2), around the light [scene unit]."""
        corners = (self.cuts.reshape(-1, 2) - self.light) if len(self.cuts) else np.empty((0, 2))
        turns = np.arctan2(corners[:, 1], corners[:, 0])
        around = np.linspace(-np.pi, np.pi, 721)
        turns = np.concatenate([turns - BESIDE, turns + BESIDE, around])
        first, last = (-np.pi, np.pi) if self.wedge is None else self.wedge
        turns = np.sort(first + np.mod(turns - first, 2 * np.pi))
        turns = np.concatenate([[first], turns[turns < last], [last]])
        ways = np.column_stack([np.cos(turns), np.sin(turns)])
        outline = self.light + np.minimum(self.first_hit(ways), reach)[:, None] * ways
        return outline if self.wedge is None else np.vstack([self.light, outline])

    def shadow_lines(self, reach: float) -> Array:
        """Where shadow polygons cut the plane, (k, 2, 2): from a silhouette's point to the next surface behind it.

        Parameters
        ----------
        reach : float    from the light, at which they end where no surface stops them [scene unit]
        """
        outline = self.lit_outline(reach)
        ways = outline - self.light
        far = np.linalg.norm(ways, axis=1)
        beside = np.abs(_cross(ways[:-1], ways[1:])) < 4 * BESIDE * far[:-1] * far[1:]
        # a jump of the distance from one side of a corner to the other
        jump = beside & (np.abs(np.diff(far)) > 1e-3 * np.maximum(far[:-1], far[1:]))
        lines = np.stack([outline[:-1][jump], outline[1:][jump]], axis=1)
        near_first = np.argsort(np.linalg.norm(lines - self.light, axis=2), axis=1)
        return np.take_along_axis(lines, near_first[..., None], axis=1)


def _cross(a: Array, b: Array) -> Array:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _cut(mesh: Mesh, origin: Array, frame: Array) -> Array:
    """Where a mesh's triangles cut the plane of the first two rows of `frame`, (n, 2, 2)."""
    x, y, above = frame @ (mesh.vertices.astype(float) - origin).T
    corners = mesh.faces.astype(np.intp)
    sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=-1)
    # a vertex in the plane counts as above it, so that a triangle has two sides cut or none
    crossed = (above[sides[..., 0]] >= 0) != (above[sides[..., 1]] >= 0)
    begin, end = sides[crossed].T
    share = above[begin] / (above[begin] - above[end])
    return np.stack([x[begin] + share * (x[end] - x[begin]), y[begin] + share * (y[end] - y[begin])], -1).reshape(
        -1, 2, 2
    )


def _wedge(light: Light, frame: Array) -> Array | None:
    """Directions of the plane that lie in a spot's cone, first and last [rad]; equal where the plane misses it."""
    if light.kind != "spot":
        return None
    along = frame[:2] @ light.direction
    cosine, length = np.cos(light.cutoff_angle), float(np.linalg.norm(along))
    if cosine <= -length:
        return None
    half = np.arccos(np.clip(cosine / max(length, 1e-300), -1, 1))
    middle = np.arctan2(along[1], along[0])
    return np.array([middle - half, middle + half])
