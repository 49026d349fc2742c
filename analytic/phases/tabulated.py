"""A phase function that was measured or computed elsewhere, as a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.inputs import real_array
from analytic.phases.base import Phase, as_cosine

__all__ = ["Tabulated"]


@dataclass(frozen=True)
class Tabulated(Phase):
    """Piecewise linear in cos theta.

    The order is that of Mitsuba's `tabphase`. Measured in 3.9.1 (`llvm_ad_rgb` and `scalar_rgb`): handed the values
    0.5, 1, 1.5, 2, 5, that plugin gives 0.2195/sr = 5 / (2 pi 3.625) where light keeps its direction (wo = -wi), as
    `hg` with g = 0.8 has its 3.58/sr there, and a tenth of it where light turns back (wo = wi). So the last value
    is the forward one in both, and a table passes from one to the other as it is.

    Parameters
    ----------
    values : sequence of float, (n,)  at n >= 2 equally spaced cos theta from -1 (backward) to +1 (forward), in any
        unit; kept normalised [1/sr]

    Raises
    ------
    ValueError
        If there are fewer than two values, or one is negative, infinite or NaN, or all are zero.

    Notes
    -----
    Where the table falls to 0, a value close to it is as accurate as cos theta itself allows: 1e-16 of the largest,
    and to the last digit at a right angle (`evaluate`), where cos theta is small, and at both ends (`of_half_angle`).
    """

    values: Sequence[float]
    name: ClassVar[str] = "tabulated"

    def __post_init__(self) -> None:
        table = real_array("values", self.values)
        if table.ndim != 1 or table.size < 2:
            raise ValueError(f"values must be two numbers or more in a row: {self.values!r}")
        if not np.all(np.isfinite(table)) or np.any(table < 0):
            raise ValueError("values must be finite and not negative")
        if not table.any():
            raise ValueError("values must not all be zero")
        # first to at most 1, for the sum of huge or tiny ones overflows or underflows; then 2 pi times the trapezoids
        table = table / table.max()
        trapezoids = (table.sum() - (table[0] + table[-1]) / 2) * 2 / (table.size - 1)
        object.__setattr__(self, "values", tuple((table / (2 * np.pi * trapezoids)).tolist()))

    @property
    def _nodes(self) -> NDArray[np.float64]:
        """Cosines of the values, (n,)."""
        last = len(self.values) - 1
        return (2 * np.arange(last + 1) - last) / last

    def evaluate(self, cos_theta: ArrayLike) -> NDArray[np.float64]:
        """Value [1/sr] at cos_theta, (...)."""
        # a mean of both neighbours keeps its digits where one of them is 0
        cosine = as_cosine(cos_theta)
        nodes, values = self._nodes, np.asarray(self.values)
        i = np.clip(np.searchsorted(nodes, cosine, "right") - 1, 0, nodes.size - 2)
        from_low, to_high = cosine - nodes[i], nodes[i + 1] - cosine
        return np.asarray((values[i] * to_high + values[i + 1] * from_low) / (from_low + to_high))

    def of_half_angle(self, cos2: NDArray[np.floating], sin2: NDArray[np.floating]) -> NDArray[np.floating]:
        """Value [1/sr] from cos^2(theta / 2) and sin^2(theta / 2), (...), counted from the nearer end."""
        last = len(self.values) - 1
        values = np.asarray(self.values, dtype=np.asarray(cos2).dtype)
        place = np.asarray(np.minimum(cos2, sin2) * last)
        i = np.minimum(place.astype(int), last - 1)
        to_far = place - i.astype(place.dtype)
        forward = sin2 < cos2
        near, far = values[np.where(forward, last - i, i)], values[np.where(forward, last - i - 1, i + 1)]
        return near * (1 - to_far) + far * to_far

    @property
    def mean_cosine(self) -> float:
        """The integral of cos theta times the table, which is a parabola between two values; exact."""
        cosine, value = self._nodes, np.asarray(self.values)
        # Simpson's rule has no error below the fourth power; the middle of a parabola's factors is their mean
        middle = (cosine[1:] + cosine[:-1]) * (value[1:] + value[:-1])
        moments = cosine[1:] * value[1:] + cosine[:-1] * value[:-1] + middle
        return float(2 * np.pi * moments.sum() / (3 * (value.size - 1)))

    @property
    def kinks(self) -> tuple[float, ...]:
        """Cosines of the inner values at which the slope changes."""
        bends = np.diff(self.values, 2) != 0
        return tuple(self._nodes[1:-1][bends].tolist())
