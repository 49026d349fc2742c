r"""Section 4.3.2 of Weng 2010, Eqs. 25 to 29: the airlight by w = u - sqrt(1 + u^2) = -1 / v, as printed and repaired.

Each function gives L_m / (I kappa_s). d_n are the coefficients of the phase function as a polynomial in w.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from mpmath import mp, mpf

from analytic.thesis.exponential_integral import ExponentialIntegral, ei
from analytic.thesis.first_formulation import PhaseOfCosine, prefactor_printed, prefactor_repaired
from analytic.thesis.segment import Segment, integrate

DifferenceOfJ = Callable[[int, Any, Any, Any], Any]


def integral_over_w(segment: Segment, factor: Callable[[Any], Any]) -> Any:
    """Int e^{H / w} / (1 + w^2) factor(w) dw from w_a to w_b, numerically: the integral of Eq. 25."""
    return integrate(lambda w: mp.exp(segment.H / w) / (1 + w * w) * factor(w), map(segment.w, segment.cuts))


def eq_25_printed(segment: Segment, phase: PhaseOfCosine) -> Any:
    """Any phase function of the scattering angle's cosine; wrong by e^{kappa_t (x_h - x_b)}."""
    return prefactor_printed(segment) * 2 * integral_over_w(segment, lambda w: phase((w**2 - 1) / (w**2 + 1)))


def eq_25_repaired(segment: Segment, phase: PhaseOfCosine) -> Any:
    """Eq. 25 with Eq. 17's prefactor."""
    return prefactor_repaired(segment) * 2 * integral_over_w(segment, lambda w: phase((w**2 - 1) / (w**2 + 1)))


def j_0(a: Any, w: Any, ei: ExponentialIntegral = ei) -> Any:
    """Eq. 26: an antiderivative of e^{a / w} / (1 + w^2)."""
    z = ei(mp.mpc(a / w, a))
    return -mp.sin(a) * z.real + mp.cos(a) * z.imag


def j_1(a: Any, w: Any, ei: ExponentialIntegral = ei) -> Any:
    """Eq. 26: an antiderivative of w e^{a / w} / (1 + w^2)."""
    z = ei(mp.mpc(a / w, a))
    return mp.cos(a) * z.real + mp.sin(a) * z.imag - ei(a / w)


def J_n(n: int, a: Any, w_a: Any, w_b: Any) -> Any:
    """J_0 of Eq. 27 and J_1 of Eq. 29: differences of j_0 or j_1."""
    antiderivative = j_1 if n else j_0
    return antiderivative(a, w_b) - antiderivative(a, w_a)


def J_e(H: Any, w_a: Any, w_b: Any) -> Any:
    """Ei(H / w_b) - Ei(H / w_a), of Eq. 29."""
    return ei(H / w_b) - ei(H / w_a)


def eq_27_printed(segment: Segment) -> Any:
    """The isotropic closed form, of -H."""
    w_a, w_b = segment.w(segment.x_a), segment.w(segment.x_b)
    return prefactor_printed(segment) * 2 / (4 * mp.pi) * J_n(0, -segment.H, w_a, w_b)


def eq_27_repaired(segment: Segment) -> Any:
    """Eq. 27 with Eq. 17's prefactor and J_0(H, w_a, w_b): Eq. 25 has e^{H / w}, so a is H."""
    w_a, w_b = segment.w(segment.x_a), segment.w(segment.x_b)
    return prefactor_repaired(segment) * 2 / (4 * mp.pi) * J_n(0, segment.H, w_a, w_b)


def d(a: Any, j: int, n: int) -> Any:
    """The coefficients of Eq. 28."""
    terms = (
        (-1) ** ((n - i - j) // 2) * mp.factorial(j) / mp.factorial(i + j + 1) * mpf(a) ** i
        for i in range((n - 2 - j) % 2, n - 2 - j + 1, 2)
    )
    return mp.fsum(terms)


def eq_28(n: int, a: Any, w: Any) -> Any:
    """An antiderivative of w^n e^{a / w} / (1 + w^2)."""
    polynomial = mp.fsum(mpf(w) ** (j + 1) * d(a, j, n) for j in range(n - 1))
    rest = (-1) ** (n // 2) * (j_1 if n % 2 else j_0)(a, w)
    return -mp.exp(a / w) * polynomial + rest + (ei(a / w) * a * d(a, 0, n) if n > 1 else 0)


def _closed_form(
    H: Any, w_a: Any, w_b: Any, d_n: Sequence[Any], exponential: Callable[[Any, Any, int], Any], J: DifferenceOfJ
) -> Any:
    total = mpf(0)
    for n, coefficient in enumerate(d_n):
        powers = mp.fsum((exponential(H, w_b, j) - exponential(H, w_a, j)) * d(H, j, n) for j in range(n - 1))
        real = J_e(H, w_a, w_b) * H * d(H, 0, n) if n > 1 else 0
        total += coefficient * (-powers + (-1) ** (n // 2) * J(n % 2, H, w_a, w_b) + real)
    return total


def closed_form_in_w_printed(H: Any, w_a: Any, w_b: Any, d_n: Sequence[Any]) -> Any:
    """The sum over n of Eq. 29, w^{j+1} inside the exponent: e^{(H / w) w^{j+1}}."""
    return _closed_form(H, w_a, w_b, d_n, lambda H, w, j: mp.exp(H / w * mpf(w) ** (j + 1)), J_n)


def closed_form_in_w_repaired(H: Any, w_a: Any, w_b: Any, d_n: Sequence[Any], J: DifferenceOfJ = J_n) -> Any:
    """The same with e^{H / w} w^{j+1}: the integral of e^{H / w} / (1 + w^2) sum_n d_n w^n from w_a to w_b."""
    return _closed_form(H, w_a, w_b, d_n, lambda H, w, j: mp.exp(H / w) * mpf(w) ** (j + 1), J)


def eq_29_printed(segment: Segment, d_n: Sequence[Any]) -> Any:
    """The closed form of a phase function that is a polynomial in w; its prefactor is the right one."""
    w_a, w_b = segment.w(segment.x_a), segment.w(segment.x_b)
    return prefactor_repaired(segment) * 2 * closed_form_in_w_printed(segment.H, w_a, w_b, d_n)


def eq_29_repaired(segment: Segment, d_n: Sequence[Any]) -> Any:
    """Eq. 29 with w^{j+1} beside the exponential."""
    w_a, w_b = segment.w(segment.x_a), segment.w(segment.x_b)
    return prefactor_repaired(segment) * 2 * closed_form_in_w_repaired(segment.H, w_a, w_b, d_n)
