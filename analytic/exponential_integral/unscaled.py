"""Ei(z), the exponential integral as the thesis writes it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import expi

from analytic.exponential_integral.scaled import as_points, scaled_e1

__all__ = ["ei"]

# e^x overflows from 709.78 on, and with it scipy's Ei: infinite parts of the wrong sign, then NaN. Ei ~ e^z / z itself
# does so from about 716 on.
LARGEST_EXPONENT = 709.0


def ei(z: ArrayLike) -> NDArray[np.complexfloating]:
    """Ei(z) = -E1(-z) + i pi sign(Im z), real on the real axis.

    So Ei(conj z) = conj Ei(z) everywhere, which the thesis's Eq. 32 supposes. The positive real axis is no cut; across
    the negative one Ei jumps by 2 pi i, and on it the value is the mean of both sides, -E1(|z|).

    Parameters
    ----------
    z : array_like, (...)  finite points other than 0

    Returns
    -------
    ndarray, (...)
        complex64 if z is complex64 or float32: made of `scaled_e1`, an exponential, a sine and a cosine, as a shader
        would. There the imaginary part beside the positive real axis is no more than rounding, and from |z| = 24 on,
        where |Ei| > 1e9, it is off by up to pi. complex128 otherwise: scipy's; made of `scaled_e1` too on the real
        axis, for scipy's sum cancels on the negative one (1e-12 of the value is lost at -5), and where e^z overflows.
        Where Ei overflows, its parts are infinite.

    Raises
    ------
    ValueError
        If a point is 0, infinite or NaN.

    Source: Weng 2010, Eqs. 20 and 32; Abramowitz and Stegun 1964, 5.1.7.
    """
    points = as_points(z)
    if not np.all(np.isfinite(points)):
        raise ValueError("z must be finite")
    if points.dtype == np.complex64:
        return _from_scaled_e1(points)
    ours = (points.imag == 0) | (points.real > LARGEST_EXPONENT)
    value = np.asarray(expi(np.where(ours, 1, points)))
    value[ours] = _from_scaled_e1(points[ours])
    return value


def _from_scaled_e1(points: NDArray[np.complexfloating]) -> NDArray[np.complexfloating]:
    """-e^z F(-z) + i pi sign(Im z), the exponential as the square of e^{z/2} so that it does not overflow before Ei."""
    x, y = points.real, points.imag
    scaled = scaled_e1(-points)
    f, g = scaled.real, scaled.imag
    half = x.dtype.type(0.5)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        root, cosine, sine = np.exp(half * x), np.cos(y), np.sin(y)
        real, imaginary = -root * (root * (f * cosine - g * sine)), -root * (root * (f * sine + g * cosine))
    value = np.empty(points.shape, points.dtype)
    value.real = real
    value.imag = np.where(y == 0, y, imaginary + np.sign(y) * x.dtype.type(np.pi))
    return value
