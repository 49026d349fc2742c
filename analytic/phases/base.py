"""What an airlight model may ask of a phase function."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.inputs import real_array, real_number

__all__ = ["Phase", "as_cosine", "asymmetry"]

# how far the dot product of two unit vectors of float32 may be beyond 1
BEYOND = 1e-6


class Phase(ABC):
    """A phase function: a frozen dataclass of its parameters."""

    name: ClassVar[str]

    def evaluate(self, cos_theta: ArrayLike) -> NDArray[np.float64]:
        """Value [1/sr] at cos_theta, (...), from -1 (backward) to 1 (forward); beyond by rounding counts as the end.

        Raises
        ------
        ValueError
            If cos_theta is NaN or beyond -1 or 1 by more than rounding.
        """
        cosine = as_cosine(cos_theta)
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


def as_cosine(cos_theta: ArrayLike) -> NDArray[np.float64]:
    """Cosines, (...), in float64 and from -1 to 1; ValueError where they are none."""
    cosine = real_array("cos_theta", cos_theta)
    if not np.all(np.abs(cosine) <= 1 + BEYOND):
        raise ValueError("cos_theta must lie between -1 and 1")
    return np.clip(cosine, -1, 1)


def asymmetry(name: str, value: float) -> float:
    """Parameter strictly between -1 and 1, as a Python float; ValueError by its name where it is none."""
    number = real_number(name, value)
    if not abs(number) < 1:
        raise ValueError(f"{name} must lie strictly between -1 and 1: {number}")
    return number
