r"""Section 4.3.1 of Weng 2010, Eqs. 18 to 24: the airlight by v = u + sqrt(1 + u^2), as printed and repaired.

Each function gives L_m / (I kappa_s). Printed, every prefactor but Eq. 29's reads e^{kappa_t (x_a - x_b)}; the change
of variables from Eq. 17 leaves e^{kappa_t (x_a - x_h)}. Eqs. 22 and 24 print kappa_i, which is defined nowhere and is
read as kappa_t. c_n are the coefficients of the phase function as a polynomial in v.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

from mpmath import mp, mpf

from analytic.thesis.exponential_integral import ExponentialIntegral, ei
from analytic.thesis.segment import Segment, integrate

PhaseOfCosine = Callable[[Any], Any]


def prefactor_printed(segment: Segment) -> Any:
    """e^{kappa_t (x_a - x_b)} / h, of Eqs. 18, 19, 21, 22, 24, 25 and 27."""
    return mp.exp(mpf(segment.kappa_t) * (mpf(segment.x_a) - mpf(segment.x_b))) / mpf(segment.h)


def prefactor_repaired(segment: Segment) -> Any:
    """e^{kappa_t (x_a - x_h)} / h, of Eqs. 17 and 29."""
    return mp.exp(mpf(segment.kappa_t) * (mpf(segment.x_a) - mpf(segment.x_h))) / mpf(segment.h)


def integral_over_v(segment: Segment, factor: Callable[[Any], Any]) -> Any:
    """Int e^{-H v} / (1 + v^2) factor(v) dv from v_a to v_b, numerically: the integral of Eqs. 18, 19 and 22."""
    return integrate(lambda v: mp.exp(-segment.H * v) / (1 + v * v) * factor(v), map(segment.v, segment.cuts))


def eq_18_printed(segment: Segment, phase: PhaseOfCosine) -> Any:
    """Any phase function of the scattering angle's cosine; wrong by e^{kappa_t (x_h - x_b)}."""
    return prefactor_printed(segment) * 2 * integral_over_v(segment, lambda v: phase((1 - v**2) / (1 + v**2)))


def eq_18_repaired(segment: Segment, phase: PhaseOfCosine) -> Any:
    """Eq. 18 with Eq. 17's prefactor."""
    return prefactor_repaired(segment) * 2 * integral_over_v(segment, lambda v: phase((1 - v**2) / (1 + v**2)))


def eq_19_printed(segment: Segment) -> Any:
    """Eq. 18 of the isotropic phase function."""
    return prefactor_printed(segment) * 2 / (4 * mp.pi) * integral_over_v(segment, lambda v: 1)


def eq_19_repaired(segment: Segment) -> Any:
    """Eq. 19 with Eq. 17's prefactor."""
    return prefactor_repaired(segment) * 2 / (4 * mp.pi) * integral_over_v(segment, lambda v: 1)


def i_0(a: Any, v: Any, ei: ExponentialIntegral = ei) -> Any:
    """Eq. 20: an antiderivative of e^{a v} / (1 + v^2)."""
    z = ei(mp.mpc(a * v, a))
    return mp.sin(a) * z.real - mp.cos(a) * z.imag


def i_1(a: Any, v: Any, ei: ExponentialIntegral = ei) -> Any:
    """Eq. 23: an antiderivative of v e^{a v} / (1 + v^2)."""
    z = ei(mp.mpc(a * v, a))
    return mp.cos(a) * z.real + mp.sin(a) * z.imag


def I_n(n: int, a: Any, v_a: Any, v_b: Any) -> Any:
    """I_0 of Eq. 21 and I_1 of Eq. 24: differences of i_0 or i_1."""
    antiderivative = i_1 if n else i_0
    return antiderivative(a, v_b) - antiderivative(a, v_a)


def eq_21_printed(segment: Segment) -> Any:
    """The isotropic closed form."""
    v_a, v_b = segment.v(segment.x_a), segment.v(segment.x_b)
    return prefactor_printed(segment) * 2 / (4 * mp.pi) * I_n(0, -segment.H, v_a, v_b)


def eq_21_repaired(segment: Segment) -> Any:
    """Eq. 21 with Eq. 17's prefactor."""
    v_a, v_b = segment.v(segment.x_a), segment.v(segment.x_b)
    return prefactor_repaired(segment) * 2 / (4 * mp.pi) * I_n(0, -segment.H, v_a, v_b)


@cache
def moment(segment: Segment, n: int, precision: int) -> Any:
    """Eq. 22's integral of v^n e^{-H v} / (1 + v^2), numerically, at mpmath's present precision."""
    return integral_over_v(segment, lambda v: v**n)


def eq_22_printed(segment: Segment, c_n: Sequence[Any]) -> Any:
    """Eq. 18 of a phase function that is a polynomial in v, term by term."""
    return prefactor_printed(segment) * 2 * mp.fsum(c * moment(segment, n, mp.prec) for n, c in enumerate(c_n))


def eq_22_repaired(segment: Segment, c_n: Sequence[Any]) -> Any:
    """Eq. 22 with Eq. 17's prefactor."""
    return prefactor_repaired(segment) * 2 * mp.fsum(c * moment(segment, n, mp.prec) for n, c in enumerate(c_n))


def c(a: Any, j: int, n: int) -> Any:
    """The coefficients of Eq. 23."""
    terms = (
        (-1) ** ((n - i - j) // 2) * mp.factorial(i + j) / mp.factorial(j) * (-1 / mpf(a)) ** (i + 1)
        for i in range((n - 2 - j) % 2, n - 2 - j + 1, 2)
    )
    return mp.fsum(terms)


def eq_23(n: int, a: Any, v: Any) -> Any:
    """An antiderivative of v^n e^{a v} / (1 + v^2); the upper-case I of the print, with two arguments, is i."""
    polynomial = mp.fsum(mpf(v) ** j * c(a, j, n) for j in range(n - 1))
    return mp.exp(a * v) * polynomial + (-1) ** ((n % 4) // 2) * (i_1 if n % 2 else i_0)(a, v)


def closed_form_in_v(H: Any, v_a: Any, v_b: Any, c_n: Sequence[Any]) -> Any:
    """The sum over n of Eq. 24: the integral of e^{-H v} / (1 + v^2) sum_n c_n v^n from v_a to v_b."""
    total = mpf(0)
    for n, coefficient in enumerate(c_n):
        powers = mp.fsum(
            (mp.exp(-H * v_b) * mpf(v_b) ** j - mp.exp(-H * v_a) * mpf(v_a) ** j) * c(-H, j, n) for j in range(n - 1)
        )
        total += coefficient * (powers + (-1) ** ((n % 4) // 2) * I_n(n % 2, -H, v_a, v_b))
    return total


def eq_24_printed(segment: Segment, c_n: Sequence[Any]) -> Any:
    """Eq. 22 in closed form."""
    v_a, v_b = segment.v(segment.x_a), segment.v(segment.x_b)
    return prefactor_printed(segment) * 2 * closed_form_in_v(segment.H, v_a, v_b, c_n)


def eq_24_repaired(segment: Segment, c_n: Sequence[Any]) -> Any:
    """Eq. 24 with Eq. 17's prefactor."""
    v_a, v_b = segment.v(segment.x_a), segment.v(segment.x_b)
    return prefactor_repaired(segment) * 2 * closed_form_in_v(segment.H, v_a, v_b, c_n)
