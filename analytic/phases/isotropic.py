"""Scattering that prefers no direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Isotropic"]


@dataclass(frozen=True)
class Isotropic:
    """1 / (4 pi) in every direction. Source: Weng 2010, Eq. 19."""

    name: ClassVar[str] = "isotropic"
    kinks: ClassVar[tuple[float, ...]] = ()

    def evaluate(self, cos_theta: ArrayLike) -> NDArray[np.float64]:
        """Value [1/sr] at cos_theta, (...)."""
        return np.full(np.shape(cos_theta), 1 / (4 * np.pi))

    @property
    def mean_cosine(self) -> float:
        """0: as much forward as backward."""
        return 0.0

    @property
    def analytic_radius(self) -> float:
        """1, the pole of 1 / (1 + v^2) that every integrand has."""
        return 1.0
