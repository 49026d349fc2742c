"""Scattering by particles much smaller than the wavelength."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Rayleigh"]


@dataclass(frozen=True)
class Rayleigh:
    """3 / (16 pi) (1 + cos^2 theta): particles much smaller than the wavelength.

    Source: Rayleigh 1871; Weng 2010, chapter 5, prints 3/4 (1 + cos^2 theta), which integrates to 4 pi.
    """

    name: ClassVar[str] = "rayleigh"
    kinks: ClassVar[tuple[float, ...]] = ()

    def evaluate(self, cos_theta: ArrayLike) -> NDArray[np.float64]:
        """Value [1/sr] at cos_theta, (...)."""
        return 3 / (16 * np.pi) * (1 + np.square(np.asarray(cos_theta, dtype=np.float64)))

    @property
    def mean_cosine(self) -> float:
        """0: as much forward as backward."""
        return 0.0

    @property
    def analytic_radius(self) -> float:
        """1: cos_theta itself has its poles at v = +-i."""
        return 1.0
