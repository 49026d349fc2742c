"""Power series of the exponential integral: real arithmetic, both parts apart, in the upper half plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.exponential_integral.precision import FLOAT32, Precision

__all__ = ["scaled_series", "unscaled_series"]

EULER_GAMMA = 0.57721566490153286
# 2 arctan(t) = t P(t^2) for 0 <= t <= tan(pi/8): interpolation at Chebyshev nodes, relative error 1.9e-8. Shading
# languages promise little for their own arc tangent (Vulkan: 4096 ulp), so the shader and its twin here share this one.
ARCTANGENT = (2.0, -0.666655719, 0.399481654, -0.27696979, 0.159525841)


def scaled_series(x: NDArray, y: NDArray, modulus: NDArray, precision: Precision) -> tuple[NDArray, NDArray]:
    """F(z) = sum_n z^n / n! (H_n - gamma - ln z), H_n the harmonic numbers, by Horner's rule.

    Parameters
    ----------
    x, y, modulus : ndarray, (n,)   parts of z, in the first quadrant, and |z| <= 1
    precision : Precision           of the arrays

    Returns
    -------
    ndarray, (n,), twice  both parts of F

    Source: Abramowitz and Stegun 1964, 5.1.11, times e^z, with e^z Ein(z) = sum H_n z^n / n! (DLMF 6.6.4 with 6.2.4).
    """
    number = precision.dtype
    harmonic = np.concatenate([[0.0], np.cumsum(1.0 / np.arange(1, precision.terms + 1))])
    log_real, log_imaginary = _gamma_plus_logarithm(x, y, modulus, precision)
    f, g = number(harmonic[-1]) - log_real, -log_imaginary
    for n in range(precision.terms, 0, -1):
        inverse = number(1.0 / n)
        f, g = (
            (f * x - g * y) * inverse + (number(harmonic[n - 1]) - log_real),
            (f * y + g * x) * inverse - log_imaginary,
        )
    return f, g


def unscaled_series(x: NDArray, y: NDArray, modulus: NDArray, precision: Precision) -> tuple[NDArray, NDArray]:
    """F(z) = e^z (-gamma - ln z - sum_{n > 0} (-z)^n / (n n!)) by Horner's rule.

    Near the cut the terms are of one sign. In general they are e^{|z| + Re z} times as large as their sum, hence the
    condition |z| + Re z <= 1, which costs a factor e at most.

    Parameters
    ----------
    x, y, modulus : ndarray, (n,)   parts of z, in the second quadrant with |z| + Re z <= 1, and |z|
    precision : Precision           of the arrays

    Returns
    -------
    ndarray, (n,), twice  both parts of F

    Source: Abramowitz and Stegun 1964, 5.1.11.
    """
    number = precision.dtype
    constant, slope = precision.unscaled_terms
    terms = np.ceil(number(constant) + number(slope) * modulus)
    # with w = -z the sum is w s_1, s_n = 1/n + w / (n+1) s_{n+1}
    f, g = np.zeros_like(x), np.zeros_like(y)
    for n in range(int(terms.max()), 0, -1):
        inverse, inverse_next = number(1.0 / n), number(1.0 / (n + 1))
        inside = n <= terms
        f, g = (
            np.where(inside, inverse - (f * x - g * y) * inverse_next, f),
            np.where(inside, -(f * y + g * x) * inverse_next, g),
        )
    log_real, log_imaginary = _gamma_plus_logarithm(x, y, modulus, precision)
    f, g = (f * x - g * y) - log_real, (f * y + g * x) - log_imaginary
    scale, cosine, sine = np.exp(x), np.cos(y), np.sin(y)
    return scale * (f * cosine - g * sine), scale * (f * sine + g * cosine)


def _gamma_plus_logarithm(x: NDArray, y: NDArray, modulus: NDArray, precision: Precision) -> tuple[NDArray, NDArray]:
    """Both parts of gamma + ln z."""
    angle = _argument(x, y, modulus) if precision is FLOAT32 else np.arctan2(y, x)
    return np.log(modulus) + precision.dtype(EULER_GAMMA), angle


def _argument(x: NDArray, y: NDArray, modulus: NDArray) -> NDArray:
    """Angle of x + i y in the upper half plane: the half-angle formula, then the polynomial of arctan."""
    number = x.dtype.type
    across = np.abs(x)
    small, large = np.minimum(across, y), np.maximum(across, y)
    t = small / (large + modulus)
    s = t * t
    polynomial = np.full_like(t, ARCTANGENT[-1])
    for coefficient in ARCTANGENT[-2::-1]:
        polynomial = polynomial * s + number(coefficient)
    angle = t * polynomial
    angle = np.where(y > across, number(0.5 * np.pi) - angle, angle)
    return np.where(x < 0, number(np.pi) - angle, angle)
