"""Solids made of tapered capsules, blended and turned into a closed surface: the same bytes on every machine.

Only operations that IEEE 754 rounds correctly are used on the way to a vertex (+ - * / and the square root, one numpy
call each, so that no compiler fuses them), sums run in a written order, and what marching cubes interpolates is
rounded to a lattice coarser than its own rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenes.meshes.triangles import Triangles

Point = tuple[float, float, float]
Bounds = tuple[Point, Point]
Axis = NDArray[np.floating]
Bead = tuple[float, float, float, float]  # a point of a curve and the radius there
LATTICE = 256.0  # vertices lie on 1/256 of a grid cell


class Capsule(NamedTuple):
    """The hull of two balls, given by centre and radius."""

    start: Point
    end: Point
    start_radius: float
    end_radius: float


class Part(NamedTuple):
    """Capsules joined sharply; the part then joins the rest with a fillet of about `blend` across."""

    capsules: list[Capsule]
    blend: float


def limb(beads: Sequence[Bead], blend: float, spans: int = 6) -> Part:
    """One tube through the given beads; the radius follows them too."""
    points = smooth_curve(beads, spans)
    return Part([Capsule(a[:3], b[:3], a[3], b[3]) for a, b in pairwise(points)], blend)


def mirrored(part: Part, about: float = 0.0, axis: int = 2) -> Part:
    """The part reflected in the plane where coordinate `axis` equals `about`."""

    def flip(point: Point) -> Point:
        x, y, z = (2.0 * about - value if i == axis else value for i, value in enumerate(point))
        return (x, y, z)

    return Part([c._replace(start=flip(c.start), end=flip(c.end)) for c in part.capsules], part.blend)


def smooth_curve(beads: Sequence[Bead], spans: int) -> list[Bead]:
    """Catmull and Rom's spline through the beads, `spans` pieces between neighbours."""
    padded = [beads[0], *beads, beads[-1]]
    curve = []
    for p0, p1, p2, p3 in zip(padded, padded[1:], padded[2:], padded[3:], strict=False):
        for step in range(spans):
            t = step / spans
            x, y, z, r = (
                b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
                for a, b, c, d in zip(p0, p1, p2, p3, strict=True)
            )
            curve.append((x, y, z, r))
    return [*curve, beads[-1]]


def unit(v: Point) -> Point:
    """The vector at length one."""
    length = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    return (v[0] / length, v[1] / length, v[2] / length)


def cross(a: Point, b: Point) -> Point:
    """Vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def along(p: Point | Bead, *terms: tuple[Point, float]) -> Point:
    """The point p plus each vector times its factor."""
    x, y, z = p[:3]
    for v, s in terms:
        x, y, z = x + v[0] * s, y + v[1] * s, z + v[2] * s
    return (x, y, z)


def surface(parts: Sequence[Part], cell: float, bounds: Bounds) -> Triangles:
    """Closed surface of the blended parts, fitted into a box.

    Parameters
    ----------
    parts : sequence of Part   joined in this order
    cell : float               side of a grid cell, in the parts' unit; details thinner than two cells are lost
    bounds : Bounds            lowest and highest corner that the surface gets, axis by axis [scene unit]
    """
    from skimage.measure import marching_cubes  # half a second to import, and needed only when a mesh is first made

    capsules = [capsule for part in parts for capsule in part.capsules]
    balls = [(p, r) for c in capsules for p, r in ((c.start, c.start_radius), (c.end, c.end_radius))]
    margin = 3.0 * cell + max(part.blend for part in parts)
    low = [min(p[axis] - r for p, r in balls) - margin for axis in range(3)]
    high = [max(p[axis] + r for p, r in balls) + margin for axis in range(3)]
    axes: list[Axis] = [
        lo + cell * np.arange(math.ceil((hi - lo) / cell) + 1) for lo, hi in zip(low, high, strict=True)
    ]
    far = 1024.0 * cell
    field = np.full([len(axis) for axis in axes], far)
    for part in parts:
        box = _box(axes, part.capsules, cell, part.blend)
        inner = [axis[here] for axis, here in zip(axes, box, strict=True)]
        distance = np.full([len(axis) for axis in inner], far)
        for capsule in part.capsules:
            near = _box(inner, [capsule], cell, part.blend)
            x, y, z = (axis[here] for axis, here in zip(inner, near, strict=True))
            distance[near] = np.minimum(distance[near], _distance(capsule, x, y, z))
        field[box] = _smooth_minimum(field[box], distance, part.blend)
    # Crossings are kept 4 % of a cell away from grid points: no two vertices fall together, so no face vanishes.
    least = 0.04 * cell
    field = np.where(np.abs(field) < least, np.where(field < 0.0, -least, least), field)
    found, faces, _, _ = marching_cubes(field.astype(np.float32), 0.0, gradient_direction="descent")
    lattice = np.rint(found.astype(np.float64) * LATTICE)
    columns = []
    for axis in range(3):
        lowest, highest = lattice[:, axis].min(), lattice[:, axis].max()
        start, end = bounds[0][axis], bounds[1][axis]
        columns.append(start + (lattice[:, axis] - lowest) * ((end - start) / (highest - lowest)))
    return Triangles(np.stack(columns, axis=1).astype(np.float32), faces.astype(np.uint32))


def _box(axes: Sequence[Axis], capsules: Sequence[Capsule], cell: float, blend: float) -> tuple[slice, ...]:
    """Grid indices around the capsules, wide enough that what is cut off has no effect on the surface."""
    wide = blend + 2.0 * cell
    slices = []
    for axis in range(3):
        low = min(min(c.start[axis] - c.start_radius, c.end[axis] - c.end_radius) for c in capsules) - wide
        high = max(max(c.start[axis] + c.start_radius, c.end[axis] + c.end_radius) for c in capsules) + wide
        first, last = np.searchsorted(axes[axis], [low, high])
        slices.append(slice(int(first), int(last)))
    return tuple(slices)


def _distance(capsule: Capsule, x: Axis, y: Axis, z: Axis) -> NDArray[np.float64]:
    """Distance of grid points to the capsule, negative inside; exact where it does not taper."""
    (ax, ay, az), (bx, by, bz) = capsule.start, capsule.end
    dx, dy, dz = bx - ax, by - ay, bz - az
    px, py, pz = (x - ax)[:, None, None], (y - ay)[None, :, None], (z - az)[None, None, :]
    squared = dx * dx + dy * dy + dz * dz
    if squared == 0.0:
        return np.sqrt(px * px + py * py + pz * pz) - capsule.start_radius
    t = np.clip((px * dx + py * dy + pz * dz) / squared, 0.0, 1.0)
    qx, qy, qz = px - t * dx, py - t * dy, pz - t * dz
    radius = capsule.start_radius + t * (capsule.end_radius - capsule.start_radius)
    return np.sqrt(qx * qx + qy * qy + qz * qz) - radius


def _smooth_minimum(a: NDArray[np.float64], b: NDArray[np.float64], blend: float) -> NDArray[np.float64]:
    """Minimum with its crease rounded by a parabola where |a - b| < blend."""
    overlap = np.maximum(blend - np.abs(a - b), 0.0)
    return np.minimum(a, b) - overlap * overlap / (4.0 * blend)
