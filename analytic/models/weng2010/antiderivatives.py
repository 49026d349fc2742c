"""The thesis's antiderivatives, Eqs. 20 to 32, operation by operation and in the floating-point type of the arguments.

Nothing is merged or rescaled here: Ei and the exponentials stand apart as in the print, which is what float32 suffers
from. The complex Ei is the principal one, so each i_0 behind the light carries a constant of pi times cos(a).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from analytic.exponential_integral import ei, scaled_e1

__all__ = ["Pair", "difference", "first_sum", "i_pair", "j_pair", "powers", "real_ei", "second_sum"]

Floats = NDArray[np.floating]
Pair = tuple[Floats, Floats]


def i_pair(a: Floats, v: Floats) -> Pair:
    """i_0(a, v) and i_1(a, v), (n,) each, from one complex Ei.

    They are antiderivatives of e^{av} / (1 + v^2) and of v times that.

    Source: Weng 2010, Eqs. 20 and 23.
    """
    value = _limited_ei(a * v, a)
    sine, cosine = np.sin(a), np.cos(a)
    return sine * value.real - cosine * value.imag, cosine * value.real + sine * value.imag


def j_pair(a: Floats, w: Floats, real: Floats) -> Pair:
    """j_0(a, w) and j_1(a, w), (n,) each, from one complex Ei and the `real` one Ei(a / w).

    They are antiderivatives of e^{a/w} / (1 + w^2) and of w times that.

    Source: Weng 2010, Eq. 26.
    """
    value = _limited_ei(a / w, a)
    sine, cosine = np.sin(a), np.cos(a)
    return cosine * value.imag - sine * value.real, cosine * value.real + sine * value.imag - real


def real_ei(x: Floats, coefficients: Sequence[float]) -> Floats:
    """Ei(x) = -E1(-x) of a negative x, (n,): the last term of Eq. 26's j_1, and J_e of Eq. 29.

    0 without an evaluation where d_0 is the only one of the `coefficients`, which neither goes with.
    """
    if not any(coefficients[1:]):
        return np.zeros_like(x)
    points = np.where(x < 0, -x, 1) + 1j * np.zeros_like(x)
    return np.where(x < 0, -np.exp(x) * scaled_e1(points).real, np.nan)


def _limited_ei(real: Floats, imaginary: Floats) -> NDArray[np.complexfloating]:
    """Principal Ei, with its limit i pi sign(Im z) at Re z = -inf; NaN where it has none, and at 0."""
    z = real + 1j * imaginary
    limit = 1j * real.dtype.type(np.pi) * np.sign(imaginary)
    value = np.where(real == -np.inf, limit, np.nan)
    usable = np.isfinite(z) & (z != 0)
    value[usable] = ei(z[usable])
    return value


def difference(last: Pair, first: Pair) -> Pair:
    """I_0 and I_1 of Eqs. 21 and 24, or J_0 and J_1 of Eqs. 27 and 29: the pair at the upper end less the lower one."""
    return last[0] - first[0], last[1] - first[1]


def first_sum(coefficients: Sequence[float], optical_h: Floats, v_a: Floats, v_b: Floats, pair: Pair) -> Floats:
    """Sum over n of c_n times the integral of e^{-Hv} v^n / (1 + v^2) from v_a to v_b, (n,); `pair` is I_0, I_1.

    Source: Weng 2010, Eq. 24, its bracket.
    """
    number = optical_h.dtype.type
    total = np.zeros_like(optical_h)
    ends: tuple[Floats, ...] = ()
    if any(coefficients[2:]):
        ends = np.exp(-optical_h * v_a), np.exp(-optical_h * v_b)
    for n, coefficient in enumerate(coefficients):
        if coefficient == 0:  # not evaluated: its sum may overflow
            continue
        inner = np.zeros_like(optical_h)
        for j in range(n - 1):
            inner += (ends[1] * v_b**j - ends[0] * v_a**j) * _c(optical_h, j, n)
        total += number(coefficient) * (inner + (-1) ** (n % 4 // 2) * pair[n % 2])
    return total


def powers(optical_h: Floats, w_a: Floats, w_b: Floats) -> Callable[[int], Floats]:
    """e^{H/w} w^{j+1} at w_b less that at w_a, (n,), as a function of j: the ends of Eq. 28."""
    at_a, at_b = np.exp(optical_h / w_a), np.exp(optical_h / w_b)
    return lambda j: at_b * w_b ** (j + 1) - at_a * w_a ** (j + 1)


def second_sum(
    coefficients: Sequence[float], optical_h: Floats, ends: Callable[[int], Floats], pair: Pair, real: Floats
) -> Floats:
    """Sum over n of d_n times the integral of e^{H/w} w^n / (1 + w^2) from w_a to w_b, (n,).

    `ends` is `powers` or Eq. 29's own, `pair` is J_0, J_1 and `real` is J_e.

    Source: Weng 2010, Eq. 29, its bracket.
    """
    number = optical_h.dtype.type
    total = np.zeros_like(optical_h)
    for n, coefficient in enumerate(coefficients):
        if coefficient == 0:
            continue
        inner = np.zeros_like(optical_h)
        for j in range(n - 1):
            inner -= ends(j) * _d(optical_h, j, n)
        inner += (-1) ** (n // 2) * pair[n % 2]
        if n > 1:
            inner += real * optical_h * _d(optical_h, 0, n)
        total += number(coefficient) * inner
    return total


def _c(optical_h: Floats, j: int, n: int) -> Floats:
    """c(a, j, n) of Eq. 23 at a = -H, so that -1/a = 1/H."""
    inverse = 1 / optical_h
    terms = np.zeros_like(optical_h)
    for i in range((n - 2 - j) % 2, n - 1 - j, 2):
        sign = (-1) ** ((n - i - j) // 2)
        terms += sign * float(math.perm(i + j, i)) * inverse ** (i + 1)
    return terms


def _d(optical_h: Floats, j: int, n: int) -> Floats:
    """d(a, j, n) of Eq. 28 at a = H."""
    terms = np.zeros_like(optical_h)
    for i in range((n - 2 - j) % 2, n - 1 - j, 2):
        sign = (-1) ** ((n - i - j) // 2)
        terms += sign / float(math.perm(i + j + 1, i + 1)) * optical_h**i
    return terms
