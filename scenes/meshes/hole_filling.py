"""Holes of a triangle mesh closed with triangles of least area.

Source: Barequet and Sharir 1995, "Filling gaps in the boundary of a polyhedron": the triangulation of a boundary
polygon with the least total area, by dynamic programming. Added here: no diagonal may be an edge that the mesh has
elsewhere, which would get four triangles.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.int64]
Loop = list[int]


def close_holes(positions: NDArray[np.float64], faces: Indices) -> tuple[NDArray[np.float64], Indices]:
    """The mesh without boundary.

    Parameters
    ----------
    positions : (V, 3) float64   positions, rounded to float32
    faces : (F, 3) int64         faces; no two of them have a side in the same direction

    Returns
    -------
    positions (V', 3) and faces (F', 3), new ones after the old; a hole whose every triangulation would use an edge
    of the mesh gets a vertex in its middle.
    """
    count = len(positions)
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    keys = np.sort(np.minimum(start, end) * count + np.maximum(start, end))
    edges = {divmod(key, count) for key in keys.tolist()}
    added: list[tuple[int, int, int]] = []
    middles: list[NDArray[np.float64]] = []
    for loop in _boundary(faces, count):
        triangles = _least_area(positions[loop], _forbidden(loop, edges))
        if triangles is None:
            middle = count + len(middles)
            middles.append(positions[loop].mean(axis=0).astype(np.float32).astype(np.float64))
            added += [(a, b, middle) for a, b in zip(loop, loop[1:] + loop[:1], strict=True)]
            continue
        for triangle in triangles:
            a, b, c = (loop[i] for i in triangle)
            added.append((a, b, c))
            # a diagonal of this hole must not be one of the next
            edges |= {(min(pair), max(pair)) for pair in ((a, b), (b, c), (c, a))}
    return (
        np.concatenate([positions, np.array(middles).reshape(-1, 3)]),
        np.concatenate([faces, np.array(added, np.int64).reshape(-1, 3)]),
    )


def _boundary(faces: Indices, count: int) -> list[Loop]:
    """The holes' outlines, in the direction in which the sides of the missing faces run, no vertex twice in one."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    lone = ~np.isin(end * count + start, start * count + end)
    # by vertex: where the missing sides that leave it go to; several at a vertex where holes touch
    leaving: dict[int, list[int]] = {}
    for a, b in zip(start[lone].tolist(), end[lone].tolist(), strict=True):
        leaving.setdefault(b, []).append(a)
    loops: list[Loop] = []
    for first in sorted(leaving):
        walk: Loop = [first]
        while leaving[walk[-1]]:
            vertex = leaving[walk[-1]].pop()
            if vertex in walk:
                # what lies between the two visits is an outline by itself
                cut = walk.index(vertex)
                loops.append(walk[cut:])
                walk = walk[: cut + 1]
            else:
                walk.append(vertex)
    return loops


def _forbidden(loop: Loop, edges: set[tuple[int, int]]) -> NDArray[np.bool_]:
    """(n, n): whether a diagonal between two corners of a hole is an edge of the mesh already."""
    table = [[(min(a, b), max(a, b)) in edges for b in loop] for a in loop]
    return np.array(table)


def _least_area(points: NDArray[np.float64], forbidden: NDArray[np.bool_]) -> list[tuple[int, int, int]] | None:
    """Triangles that close the polygon `points` (n, 3) with the least area, or None where every way is forbidden."""
    n = len(points)
    cost = np.zeros((n, n))
    split = np.zeros((n, n), np.int64)
    for span in range(2, n):
        for i in range(n - span):
            k = i + span
            between = np.arange(i + 1, k)
            areas = np.linalg.norm(np.cross(points[between] - points[i], points[k] - points[i]), axis=1) / 2.0
            totals = cost[i, between] + cost[between, k] + areas
            best = int(totals.argmin())
            split[i, k] = between[best]
            # the last one is the polygon's own side, which the mesh has on its other side
            closed = forbidden[i, k] and span < n - 1
            cost[i, k] = np.inf if closed else totals[best]
    if not np.isfinite(cost[0, n - 1]):
        return None
    triangles, open_ = [], [(0, n - 1)]
    while open_:
        i, k = open_.pop()
        if k - i > 1:
            j = int(split[i, k])
            triangles.append((i, j, k))
            open_ += [(i, j), (j, k)]
    return triangles
