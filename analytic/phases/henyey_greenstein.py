"""The one-parameter forward or backward lobe of Henyey and Greenstein."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["HenyeyGreenstein"]


@dataclass(frozen=True)
class HenyeyGreenstein:
    """(1 - g^2) / (4 pi (1 + g^2 - 2 g cos theta)^(3/2)).

    Parameters
    ----------
    g : float  mean cosine, -1 < g < 1; positive scatters forward

    Raises
    ------
    ValueError
        If |g| >= 1 or g is NaN.

    Source: Henyey and Greenstein 1941, Eq. 2; g > 0 forward as in Mitsuba's `hg`.
    """

    g: float
    name: ClassVar[str] = "hg"
    kinks: ClassVar[tuple[float, ...]] = ()

    def __post_init__(self) -> None:
        if not abs(self.g) < 1:
            raise ValueError(f"g must lie strictly between -1 and 1: {self.g}")

    def evaluate(self, cos_theta: ArrayLike) -> NDArray[np.float64]:
        """Value [1/sr] at cos_theta, (...)."""
        # (1 - |g|)^2 + 2 |g| (1 -+ cos theta) does not cancel at the peak, where 1 + g^2 - 2 g cos theta does
        cosine = math.copysign(1.0, self.g) * np.asarray(cos_theta, dtype=np.float64)
        g = abs(self.g)
        base = (1 - g) ** 2 + 2 * g * (1 - cosine)
        return np.asarray((1 - g) * (1 + g) / (4 * np.pi * base * np.sqrt(base)))

    @property
    def mean_cosine(self) -> float:
        """The parameter g."""
        return self.g

    @property
    def analytic_radius(self) -> float:
        """(1 - g) / (1 + g), where the base vanishes: 1 + g^2 - 2 g cos theta = 0 at v = +-i (1 - g) / (1 + g)."""
        return min(1.0, (1 - self.g) / (1 + self.g))
