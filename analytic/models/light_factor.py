"""e^{-sigma_t d} of the way between the light and the eye, d = sqrt(h^2 + x^2), to the last digit of float32.

An exponent that is rounded once is off by half a unit in its last place, and e^{-12} by 7e-7 in float32: as much as
all else in a model. So the root's remainder and the product's are carried along, each by the exact product of Dekker
1971, and enter as the factor 1 - remainder. A shader has the exact product in one operation, fma(a, b, -(a b)).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["light_factor"]

# e^{-DARK / 2} is 0 in float64
DARK = 2000.0


def light_factor(
    h: NDArray[np.floating], x: NDArray[np.floating], sigma_t: NDArray[np.floating]
) -> NDArray[np.floating]:
    """e^{-sigma_t sqrt(h^2 + x^2)}, (n,), in the type of the arguments.

    Parameters
    ----------
    h : ndarray, (n,)        distance of the light from the ray, above 0 [scene unit]
    x : ndarray, (n,)        the eye, from the light's projection on the ray [scene unit]
    sigma_t : ndarray, (n,)  extinction coefficient [1 / scene unit]

    Source: the attenuation of Weng 2010, Eq. 18, repaired.
    """
    # in units of a power of two, which changes no digit, so that no square overflows or vanishes
    _, power = np.frexp(np.maximum(h, np.abs(x)))
    h, x = np.ldexp(h, -power), np.ldexp(np.abs(x), -power)
    with np.errstate(over="ignore"):
        sigma_t = np.minimum(np.ldexp(sigma_t, power), DARK)
    large, small = _product(np.maximum(h, x), np.maximum(h, x)), _product(np.minimum(h, x), np.minimum(h, x))
    d = np.sqrt(large[0] + small[0])
    square = _product(d, d)
    # h^2 + x^2 - d^2: the leading parts cancel without rounding
    rest = ((large[0] - square[0]) + small[0]) + (large[1] + small[1] - square[1])
    depth, remainder = _product(sigma_t, d)
    return np.exp(-depth) * (1 - (remainder + sigma_t * (rest / (2 * d))))


def _product(a: NDArray[np.floating], b: NDArray[np.floating]) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """The product rounded, and what the rounding left out, exactly, each (n,)."""
    product = a * b
    (a_high, a_low), (b_high, b_low) = _halves(a), _halves(b)
    return product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low


def _halves(a: NDArray[np.floating]) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
    """Leading and trailing half of the digits, each (n,), whose products are exact."""
    digits = np.finfo(a.dtype).nmant + 1
    scaled = a * float(2 ** ((digits + 1) // 2) + 1)
    high = scaled - (scaled - a)
    return high, a - high
