"""From an error to its place on a colour bar: linear, or logarithmic with a linear piece about zero."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from matplotlib.colors import Normalize

# of a scale's end: smaller powers of ten are not normal numbers, and some are none
LEAST = 1e-300


@dataclass(frozen=True)
class Scale:
    """One scale for all pictures of a comparison, in the unit of the errors that it shows.

    Attributes
    ----------
    limit : float           the error at the bar's end; what is larger takes the colour of the bar's arrow
    signed : bool           from -limit to limit; else from 0
    linear : float | None   logarithmic beyond this error, linear up to it; None: linear all over

    Raises
    ------
    ValueError
        `limit` is not positive and finite, or `linear` is not between 0 and `limit`.
    """

    limit: float
    signed: bool
    linear: float | None = None

    def __post_init__(self) -> None:
        if not 0 < self.limit < math.inf:
            raise ValueError(f"limit must be positive and finite, and is {self.limit}.")
        if self.linear is not None and not 0 < self.linear < self.limit:
            raise ValueError(f"linear must be between 0 and limit = {self.limit}, and is {self.linear}.")

    @property
    def lowest(self) -> float:
        """The error at the bar's other end."""
        return -self.limit if self.signed else 0.0

    def place(self, errors: ArrayLike) -> NDArray[np.float64]:
        """Place on the bar: 0 at its lower end, 1 at its upper, outside of that beyond them.

        The linear piece from 0 to `linear` takes as much room as one decade of the rest.
        """
        errors = np.asarray(errors, np.float64)
        along = np.abs(errors) / self.limit
        if self.linear is not None:
            scaled = np.abs(errors) / self.linear
            decades = math.log10(self.limit / self.linear)
            along = np.where(scaled <= 1, scaled, 1 + np.log10(np.maximum(scaled, 1))) / (1 + decades)
        along = np.copysign(along, errors)
        return (1 + along) / 2 if self.signed else along

    def ticks(self) -> list[float]:
        """Errors worth a label: zero, both ends, and the decades or the quarters between."""
        if self.linear is None:
            positive = [self.limit * quarter / 4 for quarter in range(1, 5)]
        else:
            decades = round(math.log10(self.limit / self.linear), 9)
            positive = [self.limit / 10**decade for decade in reversed(range(math.floor(decades) + 1))]
        return [-tick for tick in reversed(positive)] * self.signed + [0.0, *positive]

    def norm(self) -> Normalize:
        """The same places for matplotlib."""
        from matplotlib.colors import Normalize, SymLogNorm

        if self.linear is None:
            return Normalize(self.lowest, self.limit)
        # matplotlib's linscale counts the linear piece in decades times 1 - 1 / base
        return SymLogNorm(self.linear, linscale=0.9, vmin=self.lowest, vmax=self.limit, base=10)


def round_up(value: float) -> float:
    """The next number of 1, 2 or 5 times a power of ten, not below `value`, nor below `LEAST`."""
    value = max(value, LEAST)
    power = 10.0 ** math.floor(math.log10(value))
    # 1.0000000001: what division leaves of 1, 2 or 5 is not taken to the next
    return next(step * power for step in (1.0, 2.0, 5.0, 10.0) if value <= 1.0000000001 * step * power)
