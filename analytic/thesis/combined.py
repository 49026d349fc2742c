r"""Sections 4.3.3 and 4.4 of Weng 2010, Eqs. 30 to 32 and Figures 4.9 to 4.11: both formulations joined at x_h.

Eq. 16's first argument is the eye. L_m(x_h, x_b) is therefore what an eye *at x_h* sees, and Eq. 30 lacks the
transmittance between the two eyes; with it, e^{kappa_t (x_a - x_h)} [L_m(x_h, x_b) - L_m(x_h, x_a)] is L_m(x_a, x_b).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from mpmath import mp, mpf

from analytic.thesis.exponential_integral import ExponentialIntegral, ei
from analytic.thesis.first_formulation import closed_form_in_v, i_0, i_1, prefactor_repaired
from analytic.thesis.second_formulation import J_n, closed_form_in_w_repaired, j_0, j_1
from analytic.thesis.segment import Segment

MediumRadiance = Callable[[Any, Any], Any]


def eq_30_printed_sum(segment: Segment, L_m: MediumRadiance) -> Any:
    """L_m(x_a, x_h) + L_m(x_h, x_b)."""
    return L_m(segment.x_a, segment.x_h) + L_m(segment.x_h, segment.x_b)


def eq_30_printed_difference(segment: Segment, L_m: MediumRadiance) -> Any:
    """L_m(x_h, x_b) - L_m(x_h, x_a), which the print equates with the sum."""
    return L_m(segment.x_h, segment.x_b) - L_m(segment.x_h, segment.x_a)


def eq_30_repaired(segment: Segment, L_m: MediumRadiance) -> Any:
    """The difference, seen from x_a."""
    dimming = mp.exp(mpf(segment.kappa_t) * (mpf(segment.x_a) - mpf(segment.x_h)))
    return dimming * (L_m(segment.x_h, segment.x_b) - L_m(segment.x_h, segment.x_a))


def eq_31(n: int, a: Any, w: Any) -> Any:
    """j_0 (n = 0) or j_1 (n = 1) by i_0 or i_1 of the same a."""
    return i_1(a, 1 / w) - ei(a / w) if n else -i_0(a, 1 / w)


def eq_32(n: int, a: Any, w: Any, ei: ExponentialIntegral = ei) -> Any:
    """j_0 (n = 0) or j_1 (n = 1) by i_0 or i_1 of -a; needs Ei(conj z) = conj Ei(z)."""
    return i_1(-a, -1 / w, ei) - ei(a / w) if n else i_0(-a, -1 / w, ei)


def figure_4_9(n: int, H: Any, w_h: Any, w_b: Any) -> Any:
    """J_0 (n = 0) or J_1 (n = 1) before the reformulation: j_n(H, w_b) - j_n(H, -1)."""
    return J_n(n, H, w_h, w_b)


def figure_4_11_printed(n: int, H: Any, w_h: Any, w_b: Any) -> Any:
    """J_0 = j_0(H, w_b) - i_0(-H, 1) and J_1 = j_1(H, w_b) - i_1(-H, 1) - Ei(-H)."""
    return j_1(H, w_b) - i_1(-H, 1) - ei(-H) if n else j_0(H, w_b) - i_0(-H, 1)


def figure_4_11_repaired(n: int, H: Any, w_h: Any, w_b: Any) -> Any:
    """J_1 ends in + Ei(-H): by Eq. 32, j_1(H, -1) = i_1(-H, 1) - Ei(-H), which is subtracted."""
    return j_1(H, w_b) - i_1(-H, 1) + ei(-H) if n else j_0(H, w_b) - i_0(-H, 1)


def combined_airlight(
    segment: Segment, c_n: Sequence[Any], d_n: Sequence[Any], J: Callable[[int, Any, Any, Any], Any]
) -> Any:
    """L_m / (I kappa_s) by Eq. 30, repaired, the first part by w and the second by v.

    Parameters
    ----------
    segment : Segment
    c_n : sequence  coefficients of the phase function as a polynomial in v, before x_h
    d_n : sequence  as a polynomial in w, behind x_h
    J : callable    `figure_4_9`, `figure_4_11_printed` or `figure_4_11_repaired`
    """
    behind = closed_form_in_w_repaired(segment.H, mpf(-1), segment.w(segment.x_b), d_n, J)
    before = closed_form_in_v(segment.H, mpf(1), segment.v(segment.x_a), c_n)
    return prefactor_repaired(segment) * 2 * (behind - before)
