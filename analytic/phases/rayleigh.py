"""Scattering by particles much smaller than the wavelength."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from analytic.phases.base import Phase

__all__ = ["Rayleigh"]


@dataclass(frozen=True)
class Rayleigh(Phase):
    """3 / (16 pi) (1 + cos^2 theta): particles much smaller than the wavelength.

    Source: Rayleigh 1871; Weng 2010, chapter 5, prints 3/4 (1 + cos^2 theta), which integrates to 4 pi.
    """

    name: ClassVar[str] = "rayleigh"

    def of_half_angle(self, cos2: NDArray[np.floating], sin2: NDArray[np.floating]) -> NDArray[np.floating]:
        """Value [1/sr] from cos^2(theta / 2) and sin^2(theta / 2), (...)."""
        return 3 / (16 * np.pi) * (1 + np.square(cos2 - sin2))

    @property
    def mean_cosine(self) -> float:
        """0: as much forward as backward."""
        return 0.0
