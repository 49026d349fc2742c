"""How well a median of rounds is known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
CONFIDENCE = 0.95
# of fewer rounds not even the smallest and the largest enclose the median so surely: 5 miss it once in 2^4
FEWEST_ROUNDS = 6


def median_interval(values: Array) -> tuple[float, float]:
    """Interval that holds the median of whatever `values` were drawn from, whatever its shape.

    The k-th smallest and the k-th largest value. The median lies outside only where fewer than k of n values fell on
    one side of it, which a fair coin decides (the sign test); k is as large as leaves `CONFIDENCE`.

    Parameters
    ----------
    values : (n,)    n at least `FEWEST_ROUNDS`

    Raises
    ------
    ValueError
        There are fewer.
    """
    from scipy.stats import binom

    ordered, n = np.sort(values), len(values)
    if n < FEWEST_ROUNDS:
        raise ValueError(f"values must be {FEWEST_ROUNDS} or more, not {n}.")
    # the smallest k that happens more than (1 - CONFIDENCE) / 2 of the time: fewer than k do not
    k = int(binom.ppf((1 - CONFIDENCE) / 2, n, 0.5))
    return float(ordered[k - 1]), float(ordered[n - k])
