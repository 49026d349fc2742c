"""Blue noise by void and cluster (Ulichney 1993, "The void-and-cluster method for dither array generation")."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# standard deviation of the Gaussian that tells how crowded a place is [pixel]: Ulichney's value
CROWDING = 1.5
# which share of the pixels the pattern starts with: a tenth is far enough from full for points to find their places
FIRST_SHARE = 0.1
# a point's own crowding, in whole numbers: rounding would leave it to the machine which of two places that are equally
# crowded comes first. What the Gaussian has beyond nine pixels is less than one unit, and so none.
UNITS = 1 << 24


def void_and_cluster(size: int, seed: int) -> NDArray[np.int64]:
    """Rank the pixels of a square tile so that the first n of them are spread evenly, whatever n is.

    Parameters
    ----------
    size : int    pixels on a side of the tile, which repeats without a seam; 4 at least
    seed : int    of the points that the pattern starts with

    Returns
    -------
    (size, size)
        Each of 0 to size^2 - 1 once. The same on every machine.

    Raises
    ------
    ValueError
        `size` is too small.
    """
    if size < 4:
        raise ValueError(f"size must be 4 or more, and is {size}")
    start = _Pattern(size)
    # RandomState's numbers are the same in all of numpy's versions
    for place in np.random.RandomState(seed).permutation(size * size)[: max(1, int(FIRST_SHARE * size * size))]:
        start.put(int(place))
    while (cluster := start.tightest_cluster()) != start.largest_void_after_removing(cluster):
        start.take(cluster)
        start.put(start.largest_void())
    ranks = np.empty(size * size, np.int64)
    # the points of the even pattern from the last to the first: those go first that are crowded most
    rest = start.copy()
    for rank in reversed(range(start.count)):
        place = rest.tightest_cluster()
        rest.take(place)
        ranks[place] = rank
    # Then the others. Once half is full, Ulichney looks for the empty place that is crowded most by empty ones: it is
    # the one that is crowded least by full ones, since both together crowd every place alike.
    for rank in range(start.count, size * size):
        place = start.largest_void()
        start.put(place)
        ranks[place] = rank
    return ranks.reshape(size, size)


class _Pattern:
    """Points on a torus, and how crowded each place is."""

    def __init__(self, size: int) -> None:
        self.size, self.count = size, 0
        self.full = np.zeros(size * size, bool)
        self.crowding = np.zeros((size, size), np.int64)
        apart = np.minimum(np.arange(size), size - np.arange(size))
        squared = apart[:, None] ** 2 + apart**2
        self._bump = np.rint(UNITS * np.exp(-squared / (2 * CROWDING**2))).astype(np.int64)

    def copy(self) -> _Pattern:
        other = _Pattern(self.size)
        other.count, other.full, other.crowding = self.count, self.full.copy(), self.crowding.copy()
        return other

    def put(self, place: int) -> None:
        self._change(place, 1)

    def take(self, place: int) -> None:
        self._change(place, -1)

    def tightest_cluster(self) -> int:
        return int(np.argmax(np.where(self.full, self.crowding.ravel(), -1)))

    def largest_void(self) -> int:
        return int(np.argmin(np.where(self.full, np.iinfo(np.int64).max, self.crowding.ravel())))

    def largest_void_after_removing(self, place: int) -> int:
        self.take(place)
        void = self.largest_void()
        self.put(place)
        return void

    def _change(self, place: int, by: int) -> None:
        self.full[place] = by > 0
        self.count += by
        self.crowding += by * np.roll(self._bump, divmod(place, self.size), axis=(0, 1))
