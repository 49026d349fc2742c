"""Sections 4.3 and 4.4 of the thesis as they are printed, errors and all.

A reader who follows the thesis gets this. What it says where it says two things, and how that is read here:

- Figure 4.8 chooses: the second formulation where the light's projection lies before the segment, the first where it
  lies behind it, the combined one (Eq. 30) inside.
- The prefactor is e^{kappa_t (x_a - x_b)} in Eqs. 21, 24 and 27, e^{kappa_t (x_a - x_h)} in Eq. 29. Eq. 24's kappa_i
  is read as kappa_t, there being no other.
- Each part of Eq. 30 is an equation of its own with its own ends in the place of x_a and x_b: nothing attenuates from
  x_h to the eye.
- Eq. 27 takes J_0(-H, ...); Figures 4.9 and 4.11, which are about the combined formulation, J_0(H, ...). So -H where
  the projection lies before the segment, H where it lies inside.
- Inside, the terms at x_h are Figure 4.11's, j_1(H, -1) = i_1(-H, 1) + Ei(-H) included: three complex Ei. That error
  shows for odd powers of w alone, and a Taylor series about w = 0 has none: cos theta is even in v and in w.
- Eq. 29's w^{j+1} is inside the exponent.
- The phase function is a Taylor series about v = 0 and w = 0 (Eqs. 22 and 29), with as many terms as one likes.
- u, v and w are computed as they are defined, u + sqrt(1 + u^2) with its cancellation.

What overflows stays overflown, and NaN stays NaN.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from analytic.models.model import AirlightModel
from analytic.models.weng2010.antiderivatives import difference, first_sum, i_pair, j_pair, real_ei, second_sum
from analytic.models.weng2010.polynomials import POLYNOMIAL_PHASES, taylor
from analytic.phase import Phase
from analytic.segments import Segments

__all__ = ["MODEL", "printed"]

Floats = NDArray[np.floating]


def printed(segments: Segments, phase: Phase, *, terms: int = 5) -> Floats:
    """Airlight of unit intensity and unit scattering coefficient, as printed: wrong, see the audit.

    Parameters
    ----------
    segments : Segments, (n,)
    phase : Phase              one of `POLYNOMIAL_PHASES`
    terms : int                N of Eqs. 22 and 29, for phase functions other than the isotropic one; 1 to 100

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]; negative, infinite or NaN where the print is, as in
        a clear medium

    Raises
    ------
    ValueError
        If terms is below 1 or above 100.

    Source: Weng 2010, Eqs. 21, 24, 27, 29 and 30 and Figures 4.8 and 4.11.
    """
    s, isotropic = segments, phase.name == "isotropic"
    front, back = taylor(phase, 1 if isotropic else terms)
    before, behind = s.x_b <= 0, s.x_a >= 0
    around = ~before & ~behind
    result = np.empty_like(s.h)
    with np.errstate(all="ignore"):
        result[before] = _before(s[before], front)
        result[behind] = _behind(s[behind], back, isotropic)
        result[around] = _around(s[around], front, back, isotropic)
        return 2 * result / s.h


def _before(s: Segments, front: Sequence[float]) -> Floats:
    """Eqs. 21 and 24, without 2 / h."""
    v_a, v_b = _v(s.x_a / s.h), _v(s.x_b / s.h)
    pair = difference(i_pair(-s.optical_h, v_b), i_pair(-s.optical_h, v_a))
    return np.exp(-s.sigma_t * s.length) * first_sum(front, s.optical_h, v_a, v_b, pair)


def _behind(s: Segments, back: Sequence[float], isotropic: bool) -> Floats:
    """Eq. 27 or Eq. 29, without 2 / h."""
    w_a, w_b = _w(s.x_a / s.h), _w(s.x_b / s.h)
    h = -s.optical_h if isotropic else s.optical_h
    real_a, real_b = real_ei(h / w_a, back), real_ei(h / w_b, back)
    pair = difference(j_pair(h, w_b, real_b), j_pair(h, w_a, real_a))
    prefactor = np.exp(s.sigma_t * (-s.length if isotropic else s.x_a))
    return prefactor * second_sum(back, h, _printed_powers(h, w_a, w_b), pair, real_b - real_a)


def _around(s: Segments, front: Sequence[float], back: Sequence[float], isotropic: bool) -> Floats:
    """Eq. 30, L_m(x_h, x_b) - L_m(x_h, x_a), with Figure 4.11, without 2 / h."""
    h, one = s.optical_h, np.ones_like(s.h)
    v_a, w_b = _v(s.x_a / s.h), _w(s.x_b / s.h)
    real_h, real_b = real_ei(-h, back), real_ei(h / w_b, back)
    i_h, j_b = i_pair(-h, one), j_pair(h, w_b, real_b)
    pair = j_b[0] - i_h[0], j_b[1] - i_h[1] - real_h
    first = second_sum(back, h, _printed_powers(h, -one, w_b), pair, real_b - real_h)
    if isotropic:
        first *= np.exp(-s.sigma_t * s.x_b)
    second = first_sum(front, h, one, v_a, difference(i_pair(-h, v_a), i_h))
    return first - np.exp(-s.sigma_t * s.x_a) * second


def _v(u: Floats) -> Floats:
    """Section 4.3."""
    return u + np.sqrt(1 + u * u)


def _w(u: Floats) -> Floats:
    """Section 4.3."""
    return u - np.sqrt(1 + u * u)


def _printed_powers(optical_h: Floats, w_a: Floats, w_b: Floats) -> Callable[[int], Floats]:
    """Eq. 29, w^{j+1} inside the exponent."""
    return lambda j: np.exp(optical_h / w_b * w_b ** (j + 1)) - np.exp(optical_h / w_a * w_a ** (j + 1))


MODEL = AirlightModel(
    name="weng2010:printed",
    function=printed,
    citation="Weng 2010, sections 4.3 and 4.4, as printed",
    domain="none: off by more than 1 % on 99.9 % of visible segments, isotropic or not",
    cost="3 complex exponential integrals where the segment contains the light's projection, 2 elsewhere",
    phases=POLYNOMIAL_PHASES,
)
