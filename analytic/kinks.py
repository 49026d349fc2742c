"""Segments cut where a phase function has kinks, for quadratures, which take smooth pieces alone."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.phase import Phase

__all__ = ["Pieces", "cut", "kinks_along_ray"]

PIECES = 1 << 16  # held at once


@dataclass(frozen=True, eq=False)
class Pieces:
    """What is left of some segments between kinks.

    Attributes
    ----------
    owner : ndarray, (m,)             the segment that each piece belongs to
    before, behind : ndarray, (m,)    the kinks at which it begins and ends, where it is not the first or the last
    is_first, is_last : ndarray, (m,) whether it begins or ends with the segment
    """

    owner: NDArray[np.intp]
    before: NDArray[np.intp]
    behind: NDArray[np.intp]
    is_first: NDArray[np.bool_]
    is_last: NDArray[np.bool_]


def kinks_along_ray(phase: Phase) -> NDArray[np.float64]:
    """Where the kinks are on a ray, u = (x - x_h) / h ascending: cos theta = -u / sqrt(1 + u^2)."""
    cosines = np.asarray(phase.kinks)[::-1]
    return -cosines / np.sqrt((1 - cosines) * (1 + cosines))


def cut(kinks: NDArray[np.floating], u_a: NDArray[np.floating], u_b: NDArray[np.floating]) -> Iterator[Pieces]:
    """The pieces of segments from u_a to u_b, each (n,), about `PIECES` at a time; of one segment all together."""
    first, last = np.searchsorted(kinks, u_a, "right"), np.searchsorted(kinks, u_b, "left")
    cuts = np.maximum(last - first, 0)
    begins = np.cumsum(cuts + 1) - (cuts + 1)
    bounds = np.flatnonzero(np.diff(begins // PIECES, prepend=-1))
    for start, stop in itertools.pairwise([*bounds.tolist(), begins.size]):
        owner = np.repeat(np.arange(start, stop), cuts[start:stop] + 1)
        number = np.arange(owner.size) + begins[start] - begins[owner]
        behind = first[owner] + number
        before, behind = (np.clip(place, 0, kinks.size - 1) for place in (behind - 1, behind))
        yield Pieces(owner, before, behind, number == 0, number == cuts[owner])
