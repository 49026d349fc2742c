"""The segments of the atlas: a grid over H and T with the same positions of the eye in every cell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.segments import Segments

__all__ = ["BESIDE", "CELLS", "INSIDE", "RANGE", "SIGMA_T", "VISIBLE_DEPTH", "Grid", "make_grid"]

CELLS = 48  # of H, and of T
RANGE = (1e-4, 50.0)  # of H and of T
# sigma_t |x_a|, on either side of the light's projection
BESIDE = np.geomspace(1e-3, 50.0, 10)
# the share of a segment that lies before the projection, where it contains it
INSIDE = np.array([0.1, 0.35, 0.65, 0.9])
# the optical depth of the light at the eye up to which a segment counts as visible: e^-12 is 6e-6
VISIBLE_DEPTH = 12.0
# drawn for each segment, so that no product with it is exact by chance [1 / scene unit]
SIGMA_T = (0.1, 10.0)
SEED = 20100


@dataclass(frozen=True, eq=False)
class Grid:
    """Cells and their segments.

    Attributes
    ----------
    optical_h : ndarray, (m,)       H = sigma_t h of the cells
    optical_length : ndarray, (m,)  T = sigma_t (x_b - x_a) of the cells
    segments : Segments, (m m p,)   float64; H varies slowest, then T, then the p positions of the eye
    """

    optical_h: NDArray[np.float64]
    optical_length: NDArray[np.float64]
    segments: Segments

    @property
    def shape(self) -> tuple[int, int, int]:
        """Numbers of H, of T and of positions."""
        cells = self.optical_h.size
        return cells, cells, len(self.segments) // cells**2

    @property
    def visible(self) -> NDArray[np.bool_]:
        """Segments at whose eye the light's optical depth is at most 12, (m m p,)."""
        return self.segments.sigma_t * self.segments.d_a <= VISIBLE_DEPTH


def make_grid(cells: int = CELLS) -> Grid:
    """Cells equally spaced in the logarithms of H and T, the ends of the range included.

    Parameters
    ----------
    cells : int  number of H, and of T
    """
    axis = np.geomspace(*RANGE, cells)
    positions = BESIDE.size * 2 + INSIDE.size
    optical_h = np.repeat(axis, cells * positions)
    optical_length = np.tile(np.repeat(axis, positions), cells)
    beside = np.broadcast_to(np.concatenate([-BESIDE[::-1], BESIDE]), (cells, BESIDE.size * 2))
    of_one_h = np.concatenate([beside, -axis[:, None] * INSIDE], axis=1)
    optical_x_a = np.tile(of_one_h.ravel(), cells)

    least, most = np.log(SIGMA_T)
    sigma_t = np.exp(np.random.default_rng(SEED).uniform(least, most, optical_h.size))
    x_a, length = optical_x_a / sigma_t, optical_length / sigma_t
    return Grid(axis, axis, Segments(optical_h / sigma_t, x_a, x_a + length, length, sigma_t))
