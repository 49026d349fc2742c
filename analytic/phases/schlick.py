"""A stand-in for Henyey and Greenstein's lobe without its power of 3/2."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from analytic.phases.base import Phase, asymmetry

__all__ = ["Schlick"]

# below this |k| the mean cosine is summed: its closed form has lost a digit there, and 26 terms reach 1e-17
LARGEST_SUMMED = 0.5
TERMS = 26


@dataclass(frozen=True)
class Schlick(Phase):
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

    def __post_init__(self) -> None:
        object.__setattr__(self, "k", asymmetry("k", self.k))

    def of_half_angle(self, cos2: NDArray[np.floating], sin2: NDArray[np.floating]) -> NDArray[np.floating]:
        """Value [1/sr] from cos^2(theta / 2) and sin^2(theta / 2), (...)."""
        # 1 - k cos theta, without its cancellation at the peak
        k = abs(self.k)
        base = (1 - k) + 2 * k * (sin2 if self.k > 0 else cos2)
        return (1 - k) * (1 + k) / (4 * np.pi) / (base * base)

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
