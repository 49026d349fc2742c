"""Airlight in closed form by complex exponential integrals, for the isotropic phase function.

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
from analytic.geometry import h_times_v, negligible_h
from analytic.medium import transmittance
from analytic.phase import Phase

__all__ = ["weng2010"]


def weng2010(
    h: NDArray[np.float64],
    x_a: NDArray[np.float64],
    x_b: NDArray[np.float64],
    sigma_t: NDArray[np.float64],
    phase: Phase,
) -> NDArray[np.float64]:
    """Airlight of unit intensity and unit scattering coefficient.

    Parameters
    ----------
    h : ndarray, (n,)        distance of the light from the ray [scene unit]; 0 only beside the segment
    x_a : ndarray, (n,)      the eye, from the light's projection on the ray [scene unit]
    x_b : ndarray, (n,)      end of the segment, above x_a, may be inf [scene unit]
    sigma_t : ndarray, (n,)  extinction coefficient [1 / scene unit]
    phase : Phase            isotropic

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Raises
    ------
    ValueError
        If the phase function is not isotropic.

    Source: Weng 2010, Eq. 21, repaired and merged.
    """
    if phase.name != "isotropic":
        raise ValueError(f"phase must be isotropic for the closed form weng2010, not {phase.name}")
    result = np.empty_like(h)
    beside = h > negligible_h(x_a, x_b)
    result[beside] = _closed_form(h[beside], x_a[beside], x_b[beside], sigma_t[beside])
    through = ~beside
    result[through] = _through_light(x_a[through], x_b[through], sigma_t[through])
    return result


def _closed_form(
    h: NDArray[np.float64], x_a: NDArray[np.float64], x_b: NDArray[np.float64], sigma_t: NDArray[np.float64]
) -> NDArray[np.float64]:
    near = transmittance(sigma_t, np.hypot(h, x_a)) * _g(h, x_a, sigma_t)
    far = transmittance(sigma_t, np.hypot(h, x_b) + (x_b - x_a)) * _g(h, x_b, sigma_t)
    return (near - far) / (2 * np.pi * h)


def _g(h: NDArray[np.float64], x: NDArray[np.float64], sigma_t: NDArray[np.float64]) -> NDArray[np.float64]:
    """G(H, v) at position x; its limit in a clear medium, where E1(z) = -gamma - ln z, is the angle of v + i."""
    length = h_times_v(h, x)
    clear = sigma_t * h == 0
    depth = np.where(clear, 1.0, sigma_t)
    return np.where(clear, np.arctan2(h, length), -scaled_e1(depth * length + 1j * (depth * h)).imag)


def _through_light(
    x_a: NDArray[np.float64], x_b: NDArray[np.float64], sigma_t: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The limit h -> 0 of the closed form on a segment that does not contain the light.

    Behind the light (x > 0), G / h tends to sigma_t (1/X - F(X)) with X = 2 sigma_t x and F(X) = e^X E1(X). Before it
    the light scattered at any x has come the same way, |x_a|, and the integral is that of 1 / x^2.
    """

    def term(x: NDArray[np.float64]) -> NDArray[np.float64]:
        depth = 2 * sigma_t * np.where(np.isinf(x), 1.0, x)
        fraction = depth * scaled_e1(np.where(depth > 0, depth, 1.0)).real
        return np.where(np.isinf(x), 0.0, (1 - fraction) / (2 * x))

    before = x_b < 0
    result = np.empty_like(x_a)
    a, b, sigma = x_a[before], x_b[before], sigma_t[before]
    result[before] = np.exp(sigma * a) * ((b - a) / a / b) / (4 * np.pi)
    a, b, sigma_t = x_a[~before], x_b[~before], sigma_t[~before]
    near, far = transmittance(sigma_t, a) * term(a), transmittance(sigma_t, b + (b - a)) * term(b)
    result[~before] = (near - far) / (2 * np.pi)
    return result
