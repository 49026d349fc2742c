"""Phase functions as polynomials on either side of the light: Taylor coefficients, and near-minimax ones.

Before the light's projection v = tan(theta / 2) lies in (0, 1] and cos theta = (1 - v^2) / (1 + v^2) (Eq. 18); behind
it w = -1/v lies in [-1, 0) and cos theta = (w^2 - 1) / (w^2 + 1) (Eq. 25). So what is expanded in |w| is the phase
function with forward and backward exchanged, and d_n = (-1)^n times its coefficients because w is negative.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from analytic.inputs import whole_number
from analytic.phase import Phase

__all__ = ["POLYNOMIAL_PHASES", "near_minimax", "taylor"]

# those that stay themselves, turned round, when their parameter changes its sign: no table
POLYNOMIAL_PHASES = ("isotropic", "rayleigh", "hg", "schlick", "cornette_shanks")
CIRCLE = 0.7  # radius of the circle of integration in v^2, as a share of the distance of the nearest singularity
POINTS = 256  # on the circle: 0.7^256 = 2e-40 of the function is aliased
MOST_TERMS = 100
FINE = 400  # Chebyshev points, four times as many as a fit may have coefficients
ROUNDING = 1e-14  # share of the largest Chebyshev coefficient; measured: 1.5e-16 is left of the isotropic function's

Coefficients = tuple[Sequence[float], Sequence[float]]


@lru_cache(maxsize=64)
def taylor(phase: Phase, terms: int) -> Coefficients:
    """Coefficients c_n and d_n of the expansions about v = 0 and w = 0, n below `terms`.

    Cauchy's integral over a circle in v^2 by the fast Fourier transform, for both functions are even: odd ones are 0.
    Measured: relative error 5e-13 up to n = 12.

    Parameters
    ----------
    phase : Phase  one of `POLYNOMIAL_PHASES`
    terms : int    number of coefficients, N of Eqs. 22 and 29; 1 to 100

    Returns
    -------
    (c, d)  two sequences of `terms` floats [1/sr]

    Raises
    ------
    ValueError
        If terms is below 1 or above 100.

    Source: Weng 2010, Eqs. 22 and 29.
    """
    terms = whole_number("terms", terms, 1, MOST_TERMS)
    front, back = (_taylor(side, terms) for side in (phase, _turned(phase)))
    return front, back


def _taylor(phase: Phase, terms: int) -> list[float]:
    """Coefficients of one side, odd ones 0."""
    radius = CIRCLE * phase.analytic_radius**2
    square = radius * np.exp(2j * np.pi * np.arange(POINTS) / POINTS)
    even = np.fft.fft(_value(phase, square)).real / POINTS
    return [float(even[n // 2] / radius ** (n // 2)) if n % 2 == 0 else 0.0 for n in range(terms)]


@lru_cache(maxsize=64)
def near_minimax(phase: Phase, terms: int) -> Coefficients:
    """Coefficients c_n and d_n of polynomials in v and w whose largest relative error over a side is nearly the least.

    Least squares of the relative error at Chebyshev points of [0, 1], in Chebyshev polynomials, then turned into
    powers. Odd powers are used too: they converge faster on [0, 1] than even ones alone.

    Terms for a largest relative error of 1 % / 0.1 % on both sides, measured: Rayleigh 5 / 7, HG 0.3 5 / 8, HG 0.6
    9 / 13, HG 0.9 21 / 30, Schlick 0.9 10 / 14, Cornette-Shanks 0.8 14 / 20. Those 30 as Chebyshev polynomials: as
    powers their coefficients reach 1e17, and HG 0.9 gets no better than 0.8 %, by 21 terms.

    Parameters
    ----------
    phase : Phase  one of `POLYNOMIAL_PHASES`
    terms : int    number of coefficients, 1 to 100

    Returns
    -------
    (c, d)  two sequences of `terms` floats [1/sr]

    Raises
    ------
    ValueError
        If terms is below 1 or above 100.
    """
    terms = whole_number("terms", terms, 1, MOST_TERMS)
    front, back = (_fit(side, terms) for side in (phase, _turned(phase)))
    return front, [(-1) ** n * coefficient for n, coefficient in enumerate(back)]


def _fit(phase: Phase, terms: int) -> list[float]:
    """Coefficients of one side."""
    points = np.cos(np.pi * (np.arange(FINE) + 0.5) / FINE)
    columns = np.polynomial.chebyshev.chebvander(points, terms - 1)
    weights = 1 / _value(phase, ((points + 1) / 2) ** 2)
    fit = np.linalg.lstsq(columns * weights[:, None], np.ones(FINE), rcond=None)[0]
    fit[np.abs(fit) < ROUNDING * np.abs(fit).max()] = 0  # what rounding left would be magnified by (n-2)! / H^(n-1)
    series = np.polynomial.Chebyshev(fit, domain=[0, 1])
    powers = series.convert(kind=np.polynomial.Polynomial, domain=[-1, 1]).coef
    return np.pad(powers, (0, terms - powers.size)).tolist()


def _turned(phase: Phase) -> Phase:
    """The phase function with forward and backward exchanged, which a change of its parameter's sign does."""
    # every phase function is a dataclass, which its base class cannot say
    opposite = {field.name: -getattr(phase, field.name) for field in fields(phase)}  # type: ignore[arg-type]
    return replace(phase, **opposite)  # type: ignore[type-var]


def _value(phase: Phase, square: NDArray) -> NDArray:
    """Value [1/sr] at tan^2(theta / 2), real or complex."""
    inverse = 1 / (1 + square)
    return phase.of_half_angle(inverse, square * inverse)
