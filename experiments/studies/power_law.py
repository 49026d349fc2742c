"""How a quantity grows: the exponent of a power law, with its confidence interval."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

CONFIDENCE = 0.95
# two points lie on a line whatever they are, and say nothing about its slope's error
FEWEST_POINTS = 3


@dataclass(frozen=True)
class Fit:
    """The line through points on logarithmic axes, y = factor x^exponent.

    Attributes
    ----------
    exponent : float
    low, high : float    the interval that holds the exponent with probability `CONFIDENCE`
    n : int              how many points it was fitted to
    factor : float       y at x = 1; of several groups the geometric mean's
    """

    exponent: float
    low: float
    high: float
    n: int
    factor: float

    def __call__(self, x: ArrayLike) -> np.ndarray:
        """The law's y at x, both (n,)."""
        return self.factor * np.asarray(x, float) ** self.exponent

    def __str__(self) -> str:
        """The exponent and its interval, for tables."""
        return f"{self.exponent:.2f} [{self.low:.2f}, {self.high:.2f}]"


def power_law(x: ArrayLike, y: ArrayLike, groups: Sequence[Hashable] | None = None) -> Fit:
    """Fit the slope of log y over log x by least squares; its interval is Student's.

    The interval takes the scatter about the line for independent errors of log y. Where the points bend, it is the
    slope's over the range that was measured, and says nothing beyond.

    Parameters
    ----------
    x, y : (n,)      above 0; n at least `FEWEST_POINTS`, and 2 more than groups
    groups : (n,)    points of one group share a factor of their own, and all groups the exponent: scenes that cost
                     different amounts and grow alike. None for one group.

    Raises
    ------
    ValueError
        There are too few points, x is the same in each group, or a value is not positive and finite.

    Source: Draper and Smith 1998, Applied Regression Analysis, sections 1.4 and 14.1 (dummy variables for the groups,
    which the groups' means take out beforehand).
    """
    from scipy.stats import t

    x, y = np.asarray(x, float), np.asarray(y, float)
    if x.ndim != 1 or x.shape != y.shape or (groups is not None and len(groups) != len(x)):
        raise ValueError("x, y and groups must be lists of one length.")
    for name, values in (("x", x), ("y", y)):
        if not (np.isfinite(values).all() and (values > 0).all()):
            raise ValueError(f"{name} must be positive and finite: a power law has no other values.")
    groups = [None] * len(x) if groups is None else groups
    freedom = len(x) - len(set(groups)) - 1
    if len(x) < FEWEST_POINTS or freedom < 1:
        raise ValueError(f"x must have {FEWEST_POINTS} values or more, and more than groups by 2, not {len(x)}.")
    if len(set(zip(groups, x.tolist(), strict=True))) == len(set(groups)):
        raise ValueError("x must not be all the same within its groups.")
    member = _membership(groups)
    log_x, log_y = np.log(x), np.log(y)
    within_x, within_y = (values - member @ (values @ member / member.sum(axis=0)) for values in (log_x, log_y))
    spread = within_x @ within_x
    slope = float(within_x @ within_y / spread)
    residual = within_y - slope * within_x
    reach = float(t.ppf((1 + CONFIDENCE) / 2, freedom) * np.sqrt(residual @ residual / freedom / spread))
    return Fit(slope, slope - reach, slope + reach, len(x), float(np.exp(np.mean(log_y - slope * log_x))))


def _membership(groups: Sequence[Hashable]) -> np.ndarray:
    """1 where a point is of a group, (points, groups)."""
    names = list(dict.fromkeys(groups))
    return np.array([[float(group == name) for name in names] for group in groups])
