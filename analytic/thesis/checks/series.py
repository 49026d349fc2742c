"""What a Taylor series about v = 0 and w = 0, as Eqs. 22 and 29 ask for, does with two phase functions."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from mpmath import mp, mpf

from analytic.thesis.checks.entry import CLOSED_FORM_DIGITS, relative, shown
from analytic.thesis.checks.parameters import HG, RAYLEIGH, airlight
from analytic.thesis.combined import combined_airlight, figure_4_11_repaired
from analytic.thesis.first_formulation import eq_24_repaired
from analytic.thesis.segment import Segment

__all__ = ["henyey_greenstein_series", "in_short", "rayleigh_series", "series_error", "what_the_series_does"]

TERMS = (4, 8, 16, 32)
G = mpf(0.6)
# H = 0.1 and u from -10 to 10, and the same up to u = -2, where v is at most 0.24
AROUND = Segment(1.0, 0.0, -10.0, 10.0, 0.1)
BEFORE = Segment(1.0, 0.0, -10.0, -2.0, 0.1)


def _product(left: Sequence[Any], right: Sequence[Any]) -> list[Any]:
    return [mp.fsum(left[k] * right[n - k] for k in range(n + 1)) for n in range(len(left))]


def _binomial(scale: Any, power: Any, count: int) -> list[Any]:
    """Coefficients of (1 + scale q)^power."""
    return [mp.binomial(power, k) * scale**k for k in range(count)]


def _in_v(coefficients: Sequence[Any], count: int) -> list[Any]:
    """A series in q = v^2 as one in v, of `count` terms."""
    return [coefficients[n // 2] if n % 2 == 0 else mpf(0) for n in range(count)]


def rayleigh_series(count: int) -> list[Any]:
    """Of 3 / (8 pi) (1 + v^4) / (1 + v^2)^2; the same in w."""
    inverse = _binomial(1, -2, count)
    numerator = [mpf(n in (0, 2)) for n in range(count)]
    return [3 / (8 * mp.pi) * c for c in _in_v(_product(numerator, inverse), count)]


def henyey_greenstein_series(g: Any, count: int) -> list[Any]:
    """Of the lobe in v; with -g, in w."""
    factor = (1 - g**2) / (4 * mp.pi * (1 - g) ** 3)
    lobe = _binomial(((1 + g) / (1 - g)) ** 2, mpf(-3) / 2, count)
    return [factor * c for c in _in_v(_product(_binomial(1, mpf(3) / 2, count), lobe), count)]


def series_error(segment: Segment, c_n: Sequence[Any], d_n: Sequence[Any], phase: Any) -> Any:
    """Relative error of the repaired closed form of these terms: combined where the segment holds x_h, else Eq. 24."""
    with mp.workdps(CLOSED_FORM_DIGITS):
        if segment.x_a < segment.x_h < segment.x_b:
            value = combined_airlight(segment, c_n, d_n, figure_4_11_repaired)
        else:
            value = eq_24_repaired(segment, c_n)
        return relative(value, airlight(segment, phase))


@cache
def _rayleigh_error(segment: Segment, count: int) -> Any:
    with mp.workdps(CLOSED_FORM_DIGITS):
        return series_error(segment, rayleigh_series(count), rayleigh_series(count), RAYLEIGH.exact)


@cache
def _henyey_greenstein_error(segment: Segment, count: int) -> Any:
    with mp.workdps(CLOSED_FORM_DIGITS):
        c_n, d_n = henyey_greenstein_series(G, count), henyey_greenstein_series(-G, count)
        return series_error(segment, c_n, d_n, HG.exact)


def in_short() -> str:
    """The errors of the longest series, as a sentence."""
    return (
        f"Of phase functions that are no polynomial the Taylor series does what Eq. 22's does: {TERMS[-1]} terms "
        f"around x_h leave {shown(_rayleigh_error(AROUND, TERMS[-1]))} (Rayleigh) and "
        f"{shown(_henyey_greenstein_error(AROUND, TERMS[-1]))} (HG 0.6)."
    )


def what_the_series_does() -> str:
    """The errors for 4, 8, 16 and 32 terms, as a sentence."""

    def errors(segment: Segment) -> str:
        both = ("Rayleigh", _rayleigh_error), ("HG 0.6", _henyey_greenstein_error)
        return "; ".join(f"{name} {', '.join(shown(error(segment, count)) for count in TERMS)}" for name, error in both)

    counts = ", ".join(map(str, TERMS))
    return (
        "Other phase functions are expanded about v = 0 (w = 0), where the nearest poles are +-i, while a segment that "
        f"holds x_h is integrated to v = 1 (w = -1): the relative error of {counts} terms at H = 0.1, u from -10 to "
        f"10, is {errors(AROUND)}. On the part up to u = -2 it is {errors(BEFORE)}."
    )
