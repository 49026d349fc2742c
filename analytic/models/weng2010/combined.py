"""The thesis's combined formulation, repaired: the phase function a polynomial on each side of the light.

Weng 2010, section 4.3, after Pegoraro, Schott and Parker 2009. With H = sigma_t h and the eye at x_a, all positions
relative to the light's projection,

    L = I sigma_s / h e^{sigma_t x_a} 2 (sum c_n int e^{-Hv} v^n / (1 + v^2) dv
                                         + sum d_n int e^{H/w} w^n / (1 + w^2) dw),

v over the part of the segment before the projection (first formulation, v from v_a to at most 1), w over the part
behind it (second formulation, w from at least -1 to w_b). Where it departs from the print: the prefactor is
e^{kappa_t (x_a - x_h)} throughout, which also gives Eq. 30 the transmittance that it lacks; the second formulation
takes J(H, ...), not Eq. 27's J(-H, ...); Eq. 29's w^{j+1} stands outside the exponent; Figure 4.11 ends in + Ei(-H).
v and w are computed without cancellation, for the thesis does not say how.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from analytic.models.weng2010.antiderivatives import (
    Pair,
    difference,
    first_sum,
    i_pair,
    j_pair,
    powers,
    real_ei,
    second_sum,
)
from analytic.segments import Segments

__all__ = ["combined"]

Floats = NDArray[np.floating]


def combined(segments: Segments, front: Sequence[float], back: Sequence[float], *, reuse: bool) -> Floats:
    """Airlight of unit intensity and unit scattering coefficient.

    Parameters
    ----------
    segments : Segments, (n,)
    front : sequence of float  c_n, the phase function in powers of v [1/sr]
    back : sequence of float   d_n, the phase function in powers of w [1/sr]
    reuse : bool               three complex Ei where the segment contains the light's projection (Figure 4.11) instead
        of four (Figure 4.9): j(H, -1) is taken from i(-H, 1)

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Source: Weng 2010, Eqs. 24, 29 and 30 and Figures 4.8, 4.9 and 4.11, repaired.
    """
    s, h = segments, segments.optical_h
    clear = h == 0
    before, behind = (s.x_b <= 0) & ~clear, (s.x_a >= 0) & ~clear
    around = ~(before | behind | clear)
    integral = np.zeros_like(h)
    # what float32 makes of huge depths (inf, or inf times 0) is the form's own loss: it is handed on, without a warning
    with np.errstate(all="ignore"):
        v_a, v_b, w_a, w_b = s.v_a, s.v_b, -1 / s.v_a, -1 / s.v_b
        integral[before] = _before(h[before], v_a[before], v_b[before], front)
        integral[behind] = _behind(h[behind], w_a[behind], w_b[behind], back)
        integral[around] = _around(h[around], v_a[around], w_b[around], front, back, reuse)
        integral[clear] = _without_extinction(np.minimum(v_a[clear], 1), np.minimum(v_b[clear], 1), front)
        integral[clear] += _without_extinction(np.maximum(w_a[clear], -1), np.maximum(w_b[clear], -1), back)
        return 2 * np.exp(s.sigma_t * s.x_a) * integral / s.h


def _before(optical_h: Floats, v_a: Floats, v_b: Floats, front: Sequence[float]) -> Floats:
    """First formulation, Eqs. 21 and 24."""
    pair = difference(i_pair(-optical_h, v_b), i_pair(-optical_h, v_a))
    return first_sum(front, optical_h, v_a, v_b, pair)


def _behind(optical_h: Floats, w_a: Floats, w_b: Floats, back: Sequence[float]) -> Floats:
    """Second formulation, Eqs. 27 and 29."""
    real_a, real_b = real_ei(optical_h / w_a, back), real_ei(optical_h / w_b, back)
    pair = difference(j_pair(optical_h, w_b, real_b), j_pair(optical_h, w_a, real_a))
    return second_sum(back, optical_h, powers(optical_h, w_a, w_b), pair, real_b - real_a)


def _around(
    optical_h: Floats, v_a: Floats, w_b: Floats, front: Sequence[float], back: Sequence[float], reuse: bool
) -> Floats:
    """Both, meeting at v_h = 1 and w_h = -1: Eq. 30."""
    one = np.ones_like(optical_h)
    real_h, real_b = real_ei(-optical_h, back), real_ei(optical_h / w_b, back)
    i_h = i_pair(-optical_h, one)
    j_h: Pair = (i_h[0], i_h[1] - real_h) if reuse else j_pair(optical_h, -one, real_h)
    before = first_sum(front, optical_h, v_a, one, difference(i_h, i_pair(-optical_h, v_a)))
    pair = difference(j_pair(optical_h, w_b, real_b), j_h)
    return before + second_sum(back, optical_h, powers(optical_h, -one, w_b), pair, real_b - real_h)


def _without_extinction(start: Floats, end: Floats, coefficients: Sequence[float]) -> Floats:
    """The limit H -> 0 of either sum: the integral of the polynomial over 1 + v^2 by long division, (n,).

    int v^n / (1 + v^2) = v^{n-1} / (n-1) - int v^{n-2} / (1 + v^2), down to arctan v or ln(1 + v^2) / 2.
    """
    number = start.dtype.type
    integrals = [np.arctan(end) - np.arctan(start), (np.log1p(end * end) - np.log1p(start * start)) / 2]
    for n in range(2, len(coefficients)):
        integrals.append((end ** (n - 1) - start ** (n - 1)) / (n - 1) - integrals[n - 2])
    return sum(
        (number(c) * part for c, part in zip(coefficients, integrals, strict=False)),
        np.zeros_like(start),
    )
