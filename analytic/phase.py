"""Phase functions: how scattered light spreads over directions.

cos_theta is the cosine of the angle between the directions in which light travels before and after it is scattered;
+1 is forward. Every function integrates to 1 over the sphere and is given in 1/sr.

A new one is a frozen dataclass with the members of `Phase` and one line in `PHASES`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["PHASES", "HenyeyGreenstein", "Isotropic", "Phase", "Rayleigh", "phase"]


class Phase(Protocol):
    """What an airlight model may ask of a phase function."""

    name: ClassVar[str]

    def evaluate(self, cos_theta: ArrayLike) -> NDArray[np.float64]:
        """Value [1/sr] at cos_theta, (...), from -1 (backward) to 1 (forward)."""

    @property
    def mean_cosine(self) -> float:
        """Average of cos_theta over the sphere, weighted by the function."""

    @property
    def analytic_radius(self) -> float:
        """Radius about v = 0 in which the function of v, cos_theta = (1 - v^2) / (1 + v^2), is analytic; at most 1.

        It is the width of the forward peak in v = tan(theta / 2): quadratures choose their spacing by it.
        """


@dataclass(frozen=True)
class Isotropic:
    """1 / (4 pi) in every direction. Source: Weng 2010, Eq. 19."""

    name: ClassVar[str] = "isotropic"

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


@dataclass(frozen=True)
class Rayleigh:
    """3 / (16 pi) (1 + cos^2 theta): particles much smaller than the wavelength.

    Source: Rayleigh 1871; Weng 2010, chapter 5, prints 3/4 (1 + cos^2 theta), which integrates to 4 pi.
    """

    name: ClassVar[str] = "rayleigh"

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


PHASES: dict[str, type[Phase]] = {
    Isotropic.name: Isotropic,
    Rayleigh.name: Rayleigh,
    HenyeyGreenstein.name: HenyeyGreenstein,
}


def phase(name: str, **parameters: float) -> Phase:
    """Phase function by its name in Mitsuba's scene format.

    Parameters
    ----------
    name : str          "isotropic", "rayleigh" or "hg"
    **parameters : float  what that function takes: `g` for "hg", nothing for the others

    Returns
    -------
    Phase  with `evaluate(cos_theta)` [1/sr] and `mean_cosine`

    Raises
    ------
    ValueError
        If the name is unknown, or a parameter is missing, not one of that function's, or out of its range.

    Examples
    --------
    >>> float(phase("hg", g=0.6).mean_cosine)
    0.6
    """
    if name not in PHASES:
        raise ValueError(f"name must be one of {', '.join(sorted(PHASES))}: {name!r}")
    wanted = [field.name for field in fields(PHASES[name])]  # type: ignore[arg-type]
    for parameter in parameters:
        if parameter not in wanted:
            raise ValueError(f"{parameter} is not a parameter of the phase function {name!r}")
    for parameter in wanted:
        if parameter not in parameters:
            raise ValueError(f"{parameter} is needed by the phase function {name!r}")
    return PHASES[name](**parameters)
