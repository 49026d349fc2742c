"""A ball of wire netting around an icosahedron of wire: bars that cut light into many shafts."""

from __future__ import annotations

import math
from random import Random

from scenes.meshes.implicit import Bead, Bounds, Part, Point, along, limb, surface, unit
from scenes.meshes.triangles import Triangles

BOUNDS: Bounds = ((-1.0, 0.0, -1.0), (1.0, 2.0, 1.0))
# about half as wide as a wire at its thinnest; the grid breaks what is thinner than a cell
CELL = 0.02


def wire_mesh() -> Triangles:
    """A ball of bent wires with an icosahedron held inside, in a box of side 2 that stands on y = 0."""
    return surface(_wires(), CELL, BOUNDS)


def _wires() -> list[Part]:
    """The edges of an icosahedron divided twice, each bent; those of a plain one inside it; and struts between."""
    draw = Random(5).random
    outer, outer_edges = _ball(2)
    inner, inner_edges = _ball(0)

    def wire(a: Point, b: Point, bow: float, radius: float) -> Part:
        middle = along(a, (b, 1.0))
        x, y, z = (0.5 * m + bow * (2.0 * draw() - 1.0) for m in middle)
        beads: list[Bead] = [(*a, radius), (x, y, z, 0.85 * radius), (*b, radius)]
        return limb(beads, 0.02, 3)

    small = [along((0.0, 0.0, 0.0), (p, 0.55)) for p in inner]
    parts = [wire(outer[i], outer[j], 0.05, 0.0225) for i, j in outer_edges]
    parts += [wire(small[i], small[j], 0.05, 0.03) for i, j in inner_edges]
    # the inner ball's corners are corners of the outer one too
    return parts + [wire(near, far, 0.05, 0.0225) for near, far in zip(small, outer, strict=False)]


def _ball(times: int) -> tuple[list[Point], list[tuple[int, int]]]:
    """Corners, on the unit sphere, and edges of an icosahedron whose edges are halved `times` times."""
    golden = (1.0 + math.sqrt(5.0)) / 2.0
    signs = [(p, q) for p in (-1.0, 1.0) for q in (-golden, golden)]
    corners = [unit(c) for p, q in signs for c in ((0.0, p, q), (p, q, 0.0), (q, 0.0, p))]
    # an edge of the icosahedron inscribed in the unit sphere is 1.05 long, the next distance 1.70
    faces = [
        (i, j, k)
        for i in range(12)
        for j in range(i)
        for k in range(j)
        if max(_squared(corners[i], corners[j]), _squared(corners[j], corners[k]), _squared(corners[i], corners[k])) < 2
    ]
    for _ in range(times):
        halves: dict[tuple[int, int], int] = {}
        for pair in [pair for face in faces for pair in _sides(face)]:
            if pair not in halves:
                halves[pair] = len(corners)
                corners.append(unit(along(corners[pair[0]], (corners[pair[1]], 1.0))))
        finer = []
        for face in faces:
            ij, jk, ki = (halves[pair] for pair in _sides(face))
            i, j, k = face
            finer += [(i, ij, ki), (j, ij, jk), (k, jk, ki), (ij, jk, ki)]
        faces = finer
    return corners, sorted({pair for face in faces for pair in _sides(face)})


def _sides(face: tuple[int, int, int]) -> list[tuple[int, int]]:
    i, j, k = face
    return [(min(pair), max(pair)) for pair in ((i, j), (j, k), (k, i))]


def _squared(a: Point, b: Point) -> float:
    x, y, z = along(a, (b, -1.0))
    return x * x + y * y + z * z
