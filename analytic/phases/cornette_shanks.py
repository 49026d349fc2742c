"""Henyey and Greenstein's lobe with Rayleigh's factor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from analytic.phases.base import Phase
from analytic.phases.henyey_greenstein import HenyeyGreenstein

__all__ = ["CornetteShanks"]


@dataclass(frozen=True)
class CornetteShanks(Phase):
    """3 (1 - g^2) (1 + cos^2 theta) / (8 pi (2 + g^2) (1 + g^2 - 2 g cos theta)^(3/2)).

    It is `rayleigh` at g = 0.

    Parameters
    ----------
    g : float  -1 < g < 1; positive scatters forward. It is not the mean cosine

    Raises
    ------
    ValueError
        If |g| >= 1 or g is NaN.

    Source: Cornette and Shanks 1992, Eq. 8.
    """

    g: float
    name: ClassVar[str] = "cornette_shanks"

    def __post_init__(self) -> None:
        object.__setattr__(self, "g", HenyeyGreenstein(self.g).g)

    def of_half_angle(self, cos2: NDArray[np.floating], sin2: NDArray[np.floating]) -> NDArray[np.floating]:
        """Value [1/sr] from cos^2(theta / 2) and sin^2(theta / 2), (...)."""
        # 1 + cos^2 has the average 1 + (1 + 2 g^2) / 3 under `hg`
        return (
            3 / (4 + 2 * self.g**2) * (1 + np.square(cos2 - sin2)) * HenyeyGreenstein(self.g).of_half_angle(cos2, sin2)
        )

    @property
    def mean_cosine(self) -> float:
        """3 g (4 + g^2) / (5 (2 + g^2))."""
        return 3 * self.g * (4 + self.g**2) / (5 * (2 + self.g**2))

    @property
    def analytic_radius(self) -> float:
        """That of `hg`: the factor 1 + cos^2 theta adds poles at v = +-i alone."""
        return HenyeyGreenstein(self.g).analytic_radius
