"""What an airlight model may ask of a phase function."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["Phase"]


class Phase(ABC):
    """A phase function: a frozen dataclass of its parameters."""

    name: ClassVar[str]

    def evaluate(self, cos_theta: ArrayLike) -> NDArray[np.float64]:
        """Value [1/sr] at cos_theta, (...), from -1 (backward) to 1 (forward)."""
        cosine = np.asarray(cos_theta, dtype=np.float64)
        return np.asarray(self.of_half_angle((1 + cosine) / 2, (1 - cosine) / 2))

    @abstractmethod
    def of_half_angle(self, cos2: NDArray[np.floating], sin2: NDArray[np.floating]) -> NDArray[np.floating]:
        """Value [1/sr] from cos^2(theta / 2) and sin^2(theta / 2), (...), in their floating-point type.

        A sharp peak keeps its digits in them, where 1 - cos_theta loses them to the rounding of cos_theta: by
        v = tan(theta / 2) they are 1 / (1 + v^2) and v^2 / (1 + v^2).
        """

    @property
    @abstractmethod
    def mean_cosine(self) -> float:
        """Average of cos_theta over the sphere, weighted by the function."""

    @property
    def analytic_radius(self) -> float:
        """Radius about v = 0 in which the function of v, cos_theta = (1 - v^2) / (1 + v^2), is analytic; at most 1.

        It is the width of the forward peak in v = tan(theta / 2): quadratures choose their spacing by it. 1 unless said
        otherwise: cos_theta itself has its poles at v = +-i. Of a function with kinks, it is that of the pieces.
        """
        return 1.0

    @property
    def kinks(self) -> tuple[float, ...]:
        """Cosines, ascending, between which the function is analytic; a quadrature has to stop at each."""
        return ()
