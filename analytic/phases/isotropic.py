"""Scattering that prefers no direction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from analytic.phases.base import Phase

__all__ = ["Isotropic"]


@dataclass(frozen=True)
class Isotropic(Phase):
    """1 / (4 pi) in every direction. Source: Weng 2010, Eq. 19."""

    name: ClassVar[str] = "isotropic"

    def of_half_angle(self, cos2: NDArray[np.floating], sin2: NDArray[np.floating]) -> NDArray[np.floating]:
        """Value [1/sr] from cos^2(theta / 2) and sin^2(theta / 2), (...)."""
        return np.full_like(cos2, 1 / (4 * np.pi))

    @property
    def mean_cosine(self) -> float:
        """0: as much forward as backward."""
        return 0.0
