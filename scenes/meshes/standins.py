"""Stand-ins of tapered capsules for the meshes that scenes may name and that are not ours to ship.

Each has the bounding box and up axis of the mesh it stands in for, and about its number of triangles.
"""

from __future__ import annotations

import math
from random import Random

from scenes.meshes.implicit import Bead, Bounds, Capsule, Part, Point, limb, mirrored, surface
from scenes.meshes.triangles import Triangles

# bounding boxes of the meshes' files
YEAHRIGHT_CC2: Bounds = ((-8.3047, 0.0755, -13.5102), (8.1928, 15.0662, 15.2493))
YEAHRIGHT_CC1: Bounds = ((-8.3128, 0.0675, -13.5406), (8.2173, 15.1232, 15.2588))
BUNNY: Bounds = ((-0.7702, -0.7685, -0.5972), (0.7795, 0.7699, 0.6014))
ARMADILLO: Bounds = ((-0.4344, -0.5716, -0.3748), (0.4031, 0.4263, 0.3780))
SPOT: Bounds = ((-0.4634, -0.7302, -0.6996), (0.4642, 1.0174, 1.0776))
SCORPION: Bounds = ((-3.3147, 0.0607, -3.8240), (3.2987, 6.5053, 3.9640))
FERTILITY: Bounds = ((-75.6563, -76.5288, -36.8150), (123.5350, 67.7828, 36.4514))
TEAPOT: Bounds = ((-3.0, 0.0, -2.0), (3.434, 3.15, 2.0))


def fine_wires() -> Triangles:
    """A blob of bent wires in place of YeahRight at 188,672 triangles."""
    return surface(_wires(0.19), 0.1274, YEAHRIGHT_CC2)


def coarse_wires() -> Triangles:
    """The blob of bent wires, thicker for a coarser grid, in place of YeahRight at 47,168 triangles."""
    return surface(_wires(0.25), 0.272, YEAHRIGHT_CC1)


def _wires(thinnest: float) -> list[Part]:
    """A random tree of bent wires inside an ellipsoid, and 127 wires more, each of which closes one more loop."""
    joints, extra = 135, 127
    draw = Random(1).random
    centre, radii = (0.0, 7.5, 1.0), (7.9, 7.2, 13.8)
    points: list[Point] = []
    while len(points) < joints:
        x, y, z = (2.0 * draw() - 1.0 for _ in range(3))
        if x * x + y * y + z * z < 1.0:
            points.append((centre[0] + radii[0] * x, centre[1] + radii[1] * y, centre[2] + radii[2] * z))
    ends = [(i, _nearest(points, i, range(i))) for i in range(1, joints)]
    while len(ends) < joints - 1 + extra:
        i = int(draw() * joints)
        others = [j for j in range(joints) if j != i and (i, j) not in ends and (j, i) not in ends]
        ends.append((i, _nearest(points, i, others)))
    parts = []
    for i, j in ends:
        a, b = points[i], points[j]
        bow = 0.45 * math.sqrt(_squared(a, b))
        middle = [(p + q) / 2.0 + bow * (2.0 * draw() - 1.0) for p, q in zip(a, b, strict=True)]
        thick = thinnest + 0.12 * draw()
        beads: list[Bead] = [(*a, thick), (middle[0], middle[1], middle[2], 0.8 * thick), (*b, thick)]
        parts.append(limb(beads, 0.3, 5))
    return parts


def _squared(a: Point, b: Point) -> float:
    dx, dy, dz = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return dx * dx + dy * dy + dz * dz


def _nearest(points: list[Point], i: int, others: range | list[int]) -> int:
    return min(others, key=lambda j: _squared(points[i], points[j]))


def _with_mirror(whole: list[Part], one_side: list[Part], axis: int = 0) -> list[Part]:
    """Parts in the middle, and parts that appear on both sides of the plane where `axis` is 0."""
    return [*whole, *one_side, *(mirrored(part, axis=axis) for part in one_side)]


def rabbit() -> Triangles:
    """A sitting rabbit in place of Stanford's bunny."""
    whole = [
        limb([(-0.40, -0.20, 0.0, 0.32), (-0.10, -0.22, 0.0, 0.40), (0.24, -0.24, 0.0, 0.46)], 0.15),
        limb([(-0.38, 0.05, 0.0, 0.24), (-0.52, 0.22, 0.0, 0.25), (-0.64, 0.16, 0.0, 0.16)], 0.12),
        limb([(0.62, -0.50, 0.0, 0.13), (0.70, -0.44, 0.0, 0.12)], 0.06),
    ]
    side = [
        limb([(0.30, -0.42, 0.28, 0.25), (0.05, -0.62, 0.34, 0.14), (-0.15, -0.66, 0.33, 0.10)], 0.1),
        limb([(-0.38, -0.40, 0.18, 0.16), (-0.46, -0.62, 0.18, 0.11), (-0.58, -0.67, 0.17, 0.09)], 0.08),
        limb([(-0.48, 0.38, 0.10, 0.09), (-0.30, 0.58, 0.22, 0.12), (-0.08, 0.74, 0.34, 0.06)], 0.06),
    ]
    return surface(_with_mirror(whole, side, axis=2), 0.0170, BUNNY)


def biped() -> Triangles:
    """A horned biped with raised arms in place of Stanford's armadillo."""
    whole = [
        limb([(0.0, -0.08, -0.05, 0.13), (0.0, 0.10, -0.08, 0.17), (0.0, 0.24, -0.04, 0.13)], 0.05),
        limb([(0.0, 0.28, 0.06, 0.10), (0.0, 0.24, 0.17, 0.07), (0.0, 0.20, 0.26, 0.035)], 0.03),
        limb([(0.0, -0.14, -0.12, 0.07), (0.0, -0.24, -0.24, 0.04), (0.0, -0.26, -0.36, 0.015)], 0.03),
    ]
    side = [
        limb(
            [(0.12, 0.18, 0.02, 0.075), (0.24, 0.14, 0.08, 0.06), (0.30, 0.24, 0.20, 0.055), (0.34, 0.32, 0.25, 0.04)],
            0.03,
        ),
        limb(
            [
                (0.09, -0.12, -0.03, 0.095),
                (0.18, -0.28, 0.02, 0.075),
                (0.17, -0.44, -0.03, 0.06),
                (0.18, -0.53, 0.0, 0.04),
            ],
            0.03,
        ),
        limb([(0.06, 0.34, 0.06, 0.03), (0.10, 0.42, 0.05, 0.03), (0.12, 0.47, 0.04, 0.012)], 0.015),
        Part(
            [
                Capsule((0.34, 0.32, 0.25), (0.34 + 0.03 * i, 0.42 - 0.012 * i * i, 0.28), 0.02, 0.012)
                for i in range(-1, 4)
            ],
            0.012,
        ),
        Part([Capsule((0.18, -0.53, 0.0), (0.18 + 0.035 * i, -0.56, 0.13), 0.035, 0.015) for i in range(-1, 2)], 0.012),
    ]
    return surface(_with_mirror(whole, side), 0.0122, ARMADILLO)


def cow() -> Triangles:
    """A short-legged cow in place of Keenan Crane's Spot."""
    whole = [
        limb([(0.0, 0.0, 0.65, 0.32), (0.0, -0.02, 0.25, 0.34), (0.0, 0.05, -0.05, 0.32)], 0.15),
        limb([(0.0, 0.15, -0.05, 0.28), (0.0, 0.42, -0.15, 0.22), (0.0, 0.66, -0.22, 0.24)], 0.15),
        limb([(0.0, 0.62, -0.30, 0.24), (0.0, 0.50, -0.52, 0.18)], 0.12),
        limb([(0.0, 0.15, 0.95, 0.06), (0.0, 0.08, 1.05, 0.03)], 0.05),
    ]
    side = [
        limb([(0.17, -0.15, 0.70, 0.19), (0.20, -0.45, 0.74, 0.14), (0.20, -0.60, 0.74, 0.14)], 0.1),
        limb([(0.17, -0.15, 0.00, 0.19), (0.20, -0.45, -0.02, 0.14), (0.20, -0.60, -0.02, 0.14)], 0.1),
        limb([(0.16, 0.72, -0.12, 0.08), (0.30, 0.76, -0.10, 0.09), (0.43, 0.78, -0.10, 0.05)], 0.06),
        limb([(0.10, 0.84, -0.16, 0.06), (0.12, 0.94, -0.15, 0.05), (0.13, 1.00, -0.14, 0.03)], 0.05),
    ]
    return surface(_with_mirror(whole, side), 0.0265, SPOT)


def scorpion() -> Triangles:
    """A scorpion in place of YahooJAPAN's."""
    whole = [limb([(0.0, 1.3, 1.6, 0.45), (0.0, 1.4, 0.3, 0.75), (0.0, 1.3, -1.2, 0.5)], 0.3)]
    tail = [(1.5, -2.0), (1.9, -2.7), (2.6, -3.2), (3.4, -3.4), (4.2, -3.2), (4.9, -2.7), (5.4, -2.0)]
    for (y0, z0), (y1, z1) in zip([(1.3, -1.2), *tail], tail, strict=False):
        whole.append(limb([(0.0, y0, z0, 0.24), (0.0, (y0 + y1) / 2, (z0 + z1) / 2, 0.36), (0.0, y1, z1, 0.24)], 0.1))
    whole.append(limb([(0.0, 5.6, -1.7, 0.45), (0.0, 6.0, -1.3, 0.3), (0.0, 6.4, -1.3, 0.12)], 0.1))
    side = [
        limb([(0.4, 1.2, 1.6, 0.25), (1.5, 1.5, 1.9, 0.25), (1.9, 1.2, 2.6, 0.3)], 0.15),
        limb([(1.9, 1.1, 2.5, 0.3), (1.8, 0.8, 3.1, 0.48), (1.3, 0.5, 3.9, 0.12)], 0.1),
        limb([(2.2, 0.9, 2.8, 0.3), (2.4, 0.7, 3.3, 0.22), (1.9, 0.5, 3.9, 0.12)], 0.1),
    ]
    for z in (1.1, 0.4, -0.3, -1.0):
        reach = (z - 0.2) * 0.9
        side.append(
            limb(
                [
                    *((0.5, 1.1, z, 0.24), (1.5, 1.7, z + 0.4 * reach, 0.2)),
                    *((2.4, 1.0, z + 0.8 * reach, 0.17), (3.1, 0.2, z + reach, 0.13)),
                ],
                0.12,
            )
        )
    return surface(_with_mirror(whole, side), 0.132, SCORPION)


def embrace() -> Triangles:
    """Two heads and a ring of arms over a pierced base, genus 5, in place of Fertility (genus 4)."""
    whole = [
        limb(
            [(-40.0, -64.0, 0.0, 12.0), (-55.0, -35.0, 0.0, 22.0), (-66.0, 0.0, 0.0, 11.0), (-58.0, 35.0, 0.0, 9.0)], 6
        ),
        limb([(-58.0, 35.0, 0.0, 10.0), (-50.0, 48.0, 0.0, 17.0)], 5.0),
        limb([(-40.0, -62.0, 0.0, 13.0), (30.0, -42.0, 0.0, 14.0), (105.0, -10.0, 0.0, 15.0)], 6.0),
        limb(
            [
                *((-20.0, -45.0, 0.0, 18.0), (0.0, -10.0, 0.0, 16.0), (30.0, 22.0, 0.0, 14.0)),
                *((70.0, 15.0, 0.0, 15.0), (108.0, -8.0, 0.0, 14.0)),
            ],
            6.0,
        ),
        limb([(28.0, 20.0, 0.0, 14.0), (12.0, 36.0, 0.0, 9.0), (-12.0, 50.0, 0.0, 12.0)], 5.0),
    ]
    side = [
        limb([(-62.0, 20.0, 9.0, 8.0), (-40.0, -4.0, 28.0, 7.0), (-10.0, 2.0, 27.0, 6.5), (14.0, 26.0, 8.0, 7.0)], 3.0),
        limb(
            [(16.0, 34.0, 8.0, 6.0), (-12.0, 22.0, 18.0, 5.0), (-48.0, 26.0, 14.0, 5.0), (-62.0, 22.0, 4.0, 6.0)], 3.0
        ),
    ]
    return surface(_with_mirror(whole, side, axis=2), 4.28, FERTILITY)


def teapot() -> Triangles:
    """A closed teapot in place of Utah's, whose own mesh is open at the lid."""
    stack = [(0.30, 1.00), (0.75, 1.15), (1.20, 1.10), (1.60, 0.95), (2.00, 0.75)]
    ring = [limb([(c * out, y, s * out, 0.55) for c, s in _octagon()], 0.5) for y, out in stack]
    core = Part([Capsule((0.0, 0.45, 0.0), (0.0, 2.0, 0.0), 0.9, 0.9)], 0.5)
    whole = [
        core,
        *ring,
        limb([(0.0, 2.4, 0.0, 0.5), (0.0, 2.8, 0.0, 0.12), (0.0, 3.0, 0.0, 0.22)], 0.2),
        limb([(1.3, 0.9, 0.0, 0.45), (2.2, 1.2, 0.0, 0.3), (2.6, 2.0, 0.0, 0.22), (3.2, 2.4, 0.0, 0.2)], 0.2),
        limb([(-1.4, 2.0, 0.0, 0.16), (-2.6, 2.1, 0.0, 0.16), (-2.8, 1.5, 0.0, 0.16), (-1.6, 0.6, 0.0, 0.16)], 0.15),
    ]
    return surface(whole, 0.146, TEAPOT)


def _octagon() -> list[tuple[float, float]]:
    """Corners of the unit octagon, the first one again at the end."""
    d = math.sqrt(0.5)
    corners = [(1.0, 0.0), (d, d), (0.0, 1.0), (-d, d), (-1.0, 0.0), (-d, -d), (0.0, -1.0), (d, -d)]
    return [*corners, corners[0]]
