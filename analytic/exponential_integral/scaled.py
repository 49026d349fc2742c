"""F(z) = e^z E1(z) at any point of the plane: which expansion serves where."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.exponential_integral.continued_fraction import continued_fraction
from analytic.exponential_integral.precision import FLOAT32, FLOAT64, Precision
from analytic.exponential_integral.series import scaled_series, unscaled_series

__all__ = ["as_points", "scaled_e1"]


def scaled_e1(z: ArrayLike) -> NDArray[np.complexfloating]:
    """F(z) = e^z E1(z) in the plane cut along the negative real axis.

    Parameters
    ----------
    z : array_like, (...)
        Points other than 0, which may be infinite (F = 0). On the cut the sign of the imaginary part's zero decides:
        -x + 0i and the real number -x stand for the upper side, -x - 0i for the lower one.

    Returns
    -------
    ndarray, (...)
        complex64 if z is complex64 or float32: the operations that a shader runs, in its order (the left half plane
        has the exponential, sine and cosine of numpy). complex128 otherwise. F(conj z) = conj F(z) to the last bit.

    Raises
    ------
    ValueError
        If a point is 0 or NaN.

    Source: Abramowitz and Stegun 1964, 5.1.11 and 5.1.22; the expansions say how.
    """
    points = as_points(z)
    precision = FLOAT32 if points.dtype == np.complex64 else FLOAT64
    x, y = points.real.ravel(), points.imag.ravel()
    f, g = _upper_half_plane(x, np.abs(y), precision)
    value = np.empty(points.shape, points.dtype)
    value.real = f.reshape(points.shape)
    value.imag = np.where(np.signbit(y), -g, g).reshape(points.shape)
    return value


def as_points(z: ArrayLike) -> NDArray[np.complexfloating]:
    """The points z as complex64 if they are single precision, as complex128 otherwise; 0 and NaN are refused."""
    given = np.asarray(z)
    single = given.dtype in (np.complex64, np.float32)
    points: NDArray[np.complexfloating] = given.astype(np.complex64) if single else given.astype(np.complex128)
    if np.any(np.isnan(points) | (points == 0)):
        raise ValueError("z must not be 0 or NaN")
    return points


def _upper_half_plane(x: NDArray, y: NDArray, precision: Precision) -> tuple[NDArray, NDArray]:
    """Both parts of F(x + i y), (n,), y >= 0, each point by the expansion that suits it."""
    number = precision.dtype
    real, imaginary = np.zeros_like(x), np.zeros_like(y)
    with np.errstate(over="ignore"):
        modulus = np.hypot(x, y)
    left, huge = x < 0, modulus >= precision.largest
    inside = np.where(left, modulus < precision.far_left, True)
    inside[inside] = modulus[inside] + np.minimum(x[inside], number(0)) <= 1
    for chosen, expansion in (
        (inside & ~left, scaled_series),
        (inside & left, unscaled_series),
        (~inside & ~huge, continued_fraction),
    ):
        if np.any(chosen):
            real[chosen], imaginary[chosen] = expansion(x[chosen], y[chosen], modulus[chosen], precision)
    # F = 1/z, divided one factor at a time; infinite points keep 0
    finite = huge & np.isfinite(modulus)
    with np.errstate(under="ignore"):
        real[finite] = x[finite] / modulus[finite] / modulus[finite]
        imaginary[finite] = -(y[finite] / modulus[finite] / modulus[finite])
    return real, imaginary
