"""A stand-in for Henyey and Greenstein's lobe without its power of 3/2."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Schlick"]

# below this |k| the mean cosine is summed: its closed form has lost a digit there, and 26 terms reach 1e-17
LARGEST_SUMMED = 0.5
TERMS = 26


@dataclass(frozen=True)
class Schlick:
    """(1 - k^2) / (4 pi (1 - k cos theta)^2).

    Parameters
    ----------
    k : float  -1 < k < 1; positive scatters forward. k = 1.55 g - 0.55 g^3 resembles `hg`

    Raises
    ------
    ValueError
        If |k| >= 1 or k is NaN.

    Source: Blasi, Le Saec and Schlick 1993, whose k is positive for forward scattering too.
    """

    k: float
    name: ClassVar[str] = "schlick"
    kinks: ClassVar[tuple[float, ...]] = ()

    def __post_init__(self) -> None:
        if not abs(self.k) < 1:
            raise ValueError(f"k must lie strictly between -1 and 1: {self.k}")

    def evaluate(self, cos_theta: ArrayLike) -> NDArray[np.float64]:
        """Value [1/sr] at cos_theta, (...)."""
        # (1 - |k|) + |k| (1 -+ cos theta) does not cancel at the peak, where 1 - k cos theta does
        cosine = math.copysign(1.0, self.k) * np.asarray(cos_theta, dtype=np.float64)
        k = abs(self.k)
        base = (1 - k) + k * (1 - cosine)
        return np.asarray((1 - k) * (1 + k) / (4 * np.pi * base * base))

    @property
    def mean_cosine(self) -> float:
        """1/k - (1/k^2 - 1) artanh k, which near k = 0 is the sum of 2 k^(2n+1) / ((2n + 1) (2n + 3))."""
        k = self.k
        if abs(k) > LARGEST_SUMMED:
            return 1 / k - (1 - k) * (1 + k) / k**2 * math.atanh(k)
        return math.fsum(2 * k ** (2 * n + 1) / ((2 * n + 1) * (2 * n + 3)) for n in range(TERMS))

    @property
    def analytic_radius(self) -> float:
        """The square root of (1 - k) / (1 + k): 1 - k cos theta = 0 at v = +-i times that."""
        return min(1.0, math.sqrt((1 - self.k) / (1 + self.k)))
