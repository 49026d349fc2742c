"""A dragon of tapered capsules: stands in for Stanford's, posed and placed like it."""

from __future__ import annotations

import math
from itertools import pairwise

from scenes.meshes.implicit import (
    Bead,
    Bounds,
    Capsule,
    Part,
    Point,
    along,
    cross,
    limb,
    mirrored,
    smooth_curve,
    surface,
    unit,
)
from scenes.meshes.triangles import Triangles

# of dragon_97k_fixed.ply and dragon_res3_fixed.ply; y is up, the head looks towards -x. The sketch below is in 1/1000.
FINE_BOUNDS: Bounds = ((-0.1083, 0.0527, -0.0504), (0.0966, 0.1972, 0.0412))
COARSE_BOUNDS: Bounds = ((-0.1077, 0.0528, -0.0501), (0.0960, 0.1966, 0.0408))

# x, y, z, radius from the back of the head to the end of the tail: an M, as Stanford's body is
SPINE: list[Bead] = [
    (-46.0, 163.0, 1.0, 11.0),
    (-36.0, 150.0, 1.0, 12.0),
    (-46.0, 131.0, 2.0, 13.5),
    (-62.0, 110.0, 4.0, 17.5),
    (-63.0, 87.0, 4.0, 19.5),
    (-40.0, 75.0, 0.0, 18.0),
    (-17.0, 93.0, -9.0, 16.5),
    (-3.0, 124.0, -20.0, 16.5),
    (22.0, 142.0, -26.0, 17.0),
    (46.0, 129.0, -20.0, 16.0),
    (46.0, 100.0, -4.0, 16.5),
    (42.0, 76.0, 7.0, 17.0),
    (62.0, 65.0, 6.0, 12.5),
    (81.0, 81.0, -2.0, 9.5),
    (82.0, 108.0, -12.0, 7.5),
    (71.0, 128.0, -17.0, 5.5),
    (76.0, 141.0, -18.0, 4.0),
]


def fine_dragon() -> Triangles:
    """A capsule dragon in place of Stanford's at 97,716 triangles."""
    return surface(_dragon(), 1.43, FINE_BOUNDS)


def coarse_dragon() -> Triangles:
    """The capsule dragon on a coarser grid, in place of Stanford's at 44,894 triangles."""
    # tips as thick as the coarser grid can hold, or they would come off
    blunt = [
        Part([c._replace(end_radius=max(c.end_radius, 1.6)) for c in part.capsules], part.blend) for part in _dragon()
    ]
    return surface(blunt, 2.1, COARSE_BOUNDS)


def _dragon() -> list[Part]:
    return [limb(SPINE, 4.0, 8), *_hide(), *_head(), *_legs(), *_tail_end()]


def _frames() -> list[tuple[Bead, Point, Point, Point]]:
    """Along the spine about every 3.6: the bead and the unit vectors tailward, dorsal and sideways."""
    fine = smooth_curve(SPINE, 40)
    frames = []
    travelled = 0.0
    for a, b in pairwise(fine):
        step = along(b, (a[:3], -1.0))
        travelled += math.sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2])
        if travelled >= 3.6:
            travelled = 0.0
            tailward = unit(step)
            # The back is on the left of the way from head to tail, seen from +z.
            side = unit(cross(tailward, (-tailward[1], tailward[0], 0.0)))
            frames.append((a, tailward, cross(side, tailward), side))
    return frames


def _hide() -> list[Part]:
    """Dorsal spikes, staggered scales on back and flanks, plates across the belly."""
    spikes, scales, plates = [], [], []
    # points of the unit circle from the back (1, 0) round to the flank, by half-angle tangents: no sine is needed
    arcs = [((1.0 - q * q) / (1.0 + q * q), 2.0 * q / (1.0 + q * q)) for q in (0.14, 0.3, 0.46, 0.64, 0.86, 1.12)]
    between = [((1.0 - q * q) / (1.0 + q * q), 2.0 * q / (1.0 + q * q)) for q in (0.22, 0.38, 0.55, 0.75, 0.98)]
    for number, (bead, tailward, dorsal, side) in enumerate(_frames()):
        r = bead[3]
        height = 1.6 + 0.1 * r if number % 2 else 2.6 + 0.17 * r
        root, tip = along(bead, (dorsal, 0.85 * r)), along(bead, (dorsal, r + height), (tailward, 0.55 * height))
        spikes.append(Capsule(root, tip, 1.3 + 0.13 * r, 1.0))
        for up, out in arcs if number % 2 else between:
            for sign in (-1.0, 1.0):
                skin = ((dorsal, up * (r - 0.5)), (side, sign * out * (r - 0.5)))
                edge = ((dorsal, up * (r - 0.4)), (side, sign * out * (r - 0.4)), (tailward, 3.0))
                scales.append(Capsule(along(bead, *skin), along(bead, *edge), 0.3, 0.9 + 0.03 * r))
        if number % 2:
            left, right = (
                along(bead, (dorsal, -0.9 * r), (side, sign * 0.42 * r), (tailward, 1.0)) for sign in (-1.0, 1.0)
            )
            plates.append(Capsule(left, right, 0.6 + 0.04 * r, 0.6 + 0.04 * r))
    return [Part(plates, 1.5), Part(scales, 0.8), Part(spikes, 1.5)]


def _head() -> list[Part]:
    """Skull, open jaws with teeth and tongue, brows, eyes, antlers, whiskers and a mane of spikes."""
    middle = 1.0
    whole = [
        limb([(-42.0, 163.0, middle, 12.5), (-58.0, 168.0, middle, 12.0), (-70.0, 169.0, middle, 10.0)], 4.0),
        limb([(-64.0, 167.0, middle, 9.0), (-82.0, 169.0, middle, 7.0), (-94.0, 172.5, middle, 6.5)], 4.0),
        limb([(-92.0, 175.0, middle, 6.0), (-97.0, 178.5, middle, 4.0)], 3.0),
        limb(
            [
                *((-54.0, 154.0, middle, 8.0), (-72.0, 147.5, middle, 6.0), (-90.0, 144.0, middle, 5.0)),
                *((-101.0, 148.0, middle, 3.0), (-106.0, 155.0, middle, 1.4)),
            ],
            3.0,
        ),
        limb([(-66.0, 155.0, middle, 3.2), (-82.0, 154.0, middle, 2.6), (-93.0, 157.5, middle, 1.5)], 1.0),
    ]
    left = [
        limb([(-91.0, 174.0, 5.5, 3.2), (-97.0, 175.0, 6.0, 2.2)], 1.5),  # nostril
        limb([(-50.0, 176.0, 8.0, 4.0), (-64.0, 179.5, 8.5, 3.6), (-74.0, 177.0, 8.0, 2.0)], 2.0),  # brow
        Part([Capsule((-68.0, 173.0, 9.0), (-68.0, 173.0, 9.0), 3.4, 3.4)], 0.6),  # eye
        limb(
            [(-46.0, 174.0, 7.0, 4.2), (-32.0, 184.0, 12.0, 3.2), (-12.0, 191.0, 18.0, 2.0), (2.0, 197.0, 20.0, 1.1)], 2
        ),
        limb([(-34.0, 183.0, 11.0, 2.6), (-31.0, 193.0, 13.0, 1.8), (-35.0, 200.0, 15.0, 1.1)], 1.5),
        limb([(-56.0, 157.0, 8.0, 4.5), (-47.0, 152.0, 10.0, 5.0), (-40.0, 152.0, 11.0, 3.5)], 3.0),  # jaw muscle
        limb(
            [
                (-95.0, 171.0, 7.0, 1.8),
                (-101.0, 164.0, 14.0, 1.5),
                (-96.0, 155.0, 22.0, 1.3),
                (-84.0, 150.0, 27.0, 1.1),
            ],
            1,
        ),
    ]
    for x, y, z, length in (
        *((-44.0, 170.0, 11.0, 26.0), (-44.0, 163.0, 12.5, 30.0), (-44.0, 156.0, 12.0, 25.0)),
        *((-46.0, 149.0, 10.0, 21.0), (-52.0, 145.0, 8.0, 16.0), (-40.0, 174.0, 6.0, 20.0)),
    ):
        rise = 0.35 * (y - 160.0)
        left.append(
            limb(
                [
                    (x, y, z, 3.6),
                    (x + length / 2, y + 0.2 * rise - 2.0, z + 5.0, 2.6),
                    (x + length, y + rise + 2.0, z + 8.0, 1.1),
                ],
                1.5,
            )
        )
    teeth = []
    for number in range(6):
        x = -70.0 - 4.6 * number
        fang = 2.2 if number == 4 else 0.0
        teeth.append(Capsule((x, 164.5 + 0.2 * number, 5.5), (x - 0.6, 159.0 - fang + 0.3 * number, 5.6), 1.8, 1.1))
        teeth.append(Capsule((x, 149.5 - 0.3 * number, 4.2), (x - 0.6, 155.0 + fang - 0.4 * number, 4.6), 1.7, 1.1))
    left.append(Part(teeth, 0.8))
    return [*whole, *left, *(mirrored(part, middle) for part in left)]


def _leg(beads: list[Bead], forward: Point, outward: Point) -> list[Part]:
    """A leg ending in a paw: four toes with claws that point `forward` and fan out, and a spur behind."""
    paw = beads[-1]
    toes = [Capsule(paw[:3], along(paw, (forward, 5.0)), paw[3], paw[3] * 0.8)]
    claws = []
    for fan in (-1.0, -0.35, 0.35, 1.0):
        knuckle = along(paw, (forward, 8.0), (outward, 6.0 * fan), ((0.0, 1.0, 0.0), 0.8))
        tip = along(paw, (forward, 14.0), (outward, 9.0 * fan), ((0.0, 1.0, 0.0), -2.6))
        toes.append(Capsule(along(paw, (outward, 3.0 * fan)), knuckle, 3.2, 2.9))
        claws.append(Capsule(knuckle, tip, 2.4, 1.1))
    ankle = beads[-2]
    claws.append(Capsule(ankle[:3], along(ankle, (forward, -9.0), ((0.0, 1.0, 0.0), 5.0)), 3.0, 1.1))
    return [limb(beads, 4.0), Part(toes, 1.5), Part(claws, 1.1)]


def _legs() -> list[Part]:
    left, ahead = (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0)
    return [
        *_leg(
            [(-58.0, 98.0, 17.0, 9.0), (-42.0, 88.0, 29.0, 8.5), (-36.0, 73.0, 33.0, 6.5), (-52.0, 59.0, 33.0, 5.0)],
            unit((-0.9, -0.1, 0.3)),
            left,
        ),
        *_leg(
            [
                (-62.0, 98.0, -11.0, 9.0),
                (-50.0, 86.0, -25.0, 8.5),
                (-60.0, 70.0, -32.0, 6.5),
                (-80.0, 59.0, -31.0, 5.0),
            ],
            unit((-0.95, -0.1, -0.2)),
            left,
        ),
        *_leg(
            [(42.0, 86.0, 16.0, 11.0), (27.0, 92.0, 25.0, 9.5), (31.0, 72.0, 31.0, 6.5), (17.0, 59.0, 31.0, 5.0)],
            ahead,
            left,
        ),
        *_leg(
            [(47.0, 92.0, -14.0, 11.0), (34.0, 88.0, -28.0, 9.5), (40.0, 70.0, -37.0, 6.5), (26.0, 59.0, -38.0, 5.0)],
            ahead,
            left,
        ),
    ]


def _tail_end() -> list[Part]:
    """Fronds that spread from the end of the tail."""
    x, y, z = SPINE[-1][:3]
    fronds = []
    for dx, dy, dz in (
        *((-6.0, 19.0, 3.0), (3.0, 20.0, -5.0), (11.0, 17.0, 4.0), (18.0, 11.0, -3.0)),
        *((19.0, 3.0, 4.0), (14.0, -6.0, -4.0), (-11.0, 11.0, -4.0)),
    ):
        bend = (x + 0.55 * dx, y + 0.5 * dy + 2.0, z + 0.8 * dz, 2.6)
        fronds.append(limb([(x, y, z, 3.2), bend, (x + dx, y + dy, z + dz, 1.1)], 1.5))
    return fronds
