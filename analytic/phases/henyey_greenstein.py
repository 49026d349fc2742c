"""The one-parameter forward or backward lobe of Henyey and Greenstein."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from analytic.phases.base import Phase, asymmetry

__all__ = ["HenyeyGreenstein"]


@dataclass(frozen=True)
class HenyeyGreenstein(Phase):
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

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", asymmetry("g", self.g))

    def of_half_angle(self, cos2: NDArray[np.floating], sin2: NDArray[np.floating]) -> NDArray[np.floating]:
        """Value [1/sr] from cos^2(theta / 2) and sin^2(theta / 2), (...)."""
        # 1 + g^2 - 2 g cos theta, without its cancellation at the peak
        g = abs(self.g)
        base = (1 - g) ** 2 + 4 * g * (sin2 if self.g > 0 else cos2)
        return (1 - g) * (1 + g) / (4 * np.pi) / (base * np.sqrt(base))

    @property
    def mean_cosine(self) -> float:
        """The parameter g."""
        return self.g

    @property
    def analytic_radius(self) -> float:
        """(1 - g) / (1 + g), where the base vanishes: 1 + g^2 - 2 g cos theta = 0 at v = +-i (1 - g) / (1 + g)."""
        return min(1.0, (1 - self.g) / (1 + self.g))
