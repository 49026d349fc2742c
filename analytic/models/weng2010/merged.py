"""Weng's closed form as it should be evaluated: exponents merged, two exponential integrals, isotropic.

Weng 2010, Eqs. 20 and 21, after Pegoraro and Parker 2009. Repaired: the prefactor is e^{kappa_t (x_a - x_h)}, where
Eq. 21 prints e^{kappa_t (x_a - x_b)}. Merged: with i_0(-H, v) = -Im(e^{iH} Ei(-H (v + i))) and
G(H, v) = -Im(e^z E1(z)), z = H (v + i), each term keeps its own decaying exponential and nothing overflows:

    L = I sigma_s / (2 pi h) (e^{-sigma_t d_a} G(H, v_a) - e^{-sigma_t (d_b + x_b - x_a)} G(H, v_b)).

The subtraction is what limits it, as it limits every antiderivative: a segment that is short, or that ends well before
the light's projection, loses about as many digits as the two terms share.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.exponential_integral import scaled_e1
from analytic.models.model import AirlightModel
from analytic.phase import Phase
from analytic.segments import Segments, h_times_v

__all__ = ["MODEL", "weng2010"]


def weng2010(segments: Segments, phase: Phase) -> NDArray[np.floating]:
    """Airlight of unit intensity and unit scattering coefficient.

    Parameters
    ----------
    segments : Segments, (n,)
    phase : Phase              isotropic

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Source: Weng 2010, Eq. 21, repaired and merged.
    """
    s = segments
    near = np.exp(-s.sigma_t * s.d_a) * _g(s.h, s.x_a, s.sigma_t)
    far = np.exp(-s.depth_through_b) * _g(s.h, s.x_b, s.sigma_t)
    return (near - far) / (2 * np.pi * s.h)


def _g(h: NDArray[np.floating], x: NDArray[np.floating], sigma_t: NDArray[np.floating]) -> NDArray[np.floating]:
    """G(H, v) at position x; its limit in a clear medium, where E1(z) = -gamma - ln z, is the angle of v + i."""
    length = h_times_v(h, x)
    clear = sigma_t * h == 0
    extinction = np.where(clear, sigma_t.dtype.type(1), sigma_t)
    return np.where(clear, np.arctan2(h, length), -scaled_e1(extinction * length + 1j * (extinction * h)).imag)


MODEL = AirlightModel(
    name="weng2010",
    function=weng2010,
    citation="Weng 2010, Eq. 21, repaired and merged; Pegoraro and Parker 2009",
    domain="isotropic; within 7 eps (1 + sigma_t d_a) of the moduli of its two terms, so it loses the digits that both "
    "ends share (short segments, segments before the light). Visible segments off by more than 1 %: none in float64, "
    "0.5 % in float32 (8 % of those before the light, none around or behind it)",
    cost="2 complex exponential integrals, 2 exponentials, 2 square roots",
    phases=("isotropic",),
)
