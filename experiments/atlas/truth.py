"""The atlas's truth, held against the oracle on a few of its segments."""

from __future__ import annotations

import numpy as np

from analytic.phase import Phase
from experiments.atlas.errors import make_case
from experiments.atlas.grid import Grid

__all__ = ["CHECKED", "worst_of_truth"]

CHECKED = 40  # segments of each phase function
SEED = 16


def worst_of_truth(grid: Grid, phase: Phase, count: int = CHECKED) -> float:
    """Largest relative error of the truth on `count` segments drawn from the grid.

    The segments are those rounded to float32: the sum of two such numbers is exact in float64 over the whole grid, so
    that x_b is no other segment's end.
    """
    import mpmath

    from analytic.oracle import exact_airlight

    case = make_case(grid, phase, "float32")
    s = case.segments.astype(np.float64)
    errors = []
    for i in np.random.default_rng(SEED).choice(len(s), count, replace=False):
        h, x_a, x_b, sigma_t = (float(values[i]) for values in (s.h, s.x_a, s.x_b, s.sigma_t))
        exact = exact_airlight(h, x_a, x_b, sigma_t, phase).value
        errors.append(float(abs(mpmath.mpf(float(case.truth[i])) / exact - 1)))
    return max(errors)
