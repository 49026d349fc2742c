"""The continued fraction of the exponential integral: real arithmetic, both parts apart, in the upper half plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.exponential_integral.precision import Precision

__all__ = ["continued_fraction"]


def continued_fraction(x: NDArray, y: NDArray, modulus: NDArray, precision: Precision) -> tuple[NDArray, NDArray]:
    """F(z) = 1/(z+1 - 1/(z+3 - 4/(z+5 - 9/(z+7 - ...)))) from the inside out, as deep as z asks for.

    Its tails are f_k = 1/(z + 2k + 1 - (k+1)^2 f_{k+1}). The innermost one is not dropped but replaced by the fixed
    point of 1 = f (z + 2k + 1 - k (k+1) f), because f_k ~ (1 - sqrt(z/k)) / k makes (k+1)^2 f_{k+1} ~ k (k+1) f_k. At
    |z| = 1 that lowers the depth needed for float32 from 39 to 24.

    Cut off at depth n it is the n-point Gauss-Laguerre quadrature of int_0^inf e^{-t} / (z + t) dt. Its error falls as
    e^{-4 sqrt(n) Re sqrt(z)} and 2 (Re sqrt(z))^2 = |z| + Re z, which sets the depth in the left half plane. Far out a
    few points are enough even on the cut, because all of them lie well before the pole at t = -z.

    Parameters
    ----------
    x, y, modulus : ndarray, (n,)   parts of z, in the upper half plane, and |z|; in the left half plane
                                    |z| + Re z > 1 or |z| >= precision.far_left, in the right one |z| > 1
    precision : Precision           of the arrays

    Returns
    -------
    ndarray, (n,), twice  both parts of F

    Source: Abramowitz and Stegun 1964, 5.1.22, even part; the tail and the depths are this module's.
    """
    number = precision.dtype
    left = x < 0
    tailed = modulus < np.where(left, number(precision.far_left), number(precision.far_right))
    depth = np.where(left, number(precision.far_left_depth), number(precision.far_right_depth))
    constant, slope = precision.depth
    convergence = modulus[tailed] + np.minimum(x[tailed], number(0))
    depth[tailed] = np.ceil(number(constant) + number(slope) / convergence)
    f, g = np.zeros_like(x), np.zeros_like(y)
    f[tailed], g[tailed] = _fixed_point(x[tailed], y[tailed], depth[tailed])
    for k in range(int(depth.max()) - 1, -1, -1):
        square = number((k + 1) * (k + 1))
        a, b = x + number(2 * k + 1) - square * f, y - square * g
        scale = number(1) / (a * a + b * b)
        inside = k < depth
        f, g = np.where(inside, a * scale, f), np.where(inside, -b * scale, g)
    return f, g


def _fixed_point(x: NDArray, y: NDArray, k: NDArray) -> tuple[NDArray, NDArray]:
    """The smaller root of k (k+1) f^2 - b f + 1 = 0, b = z + 2k + 1, which is 2 / (b + sqrt(b^2 - 4 k (k+1))).

    The discriminant is written as z^2 + 2 z (2k+1) + 1, which does not cancel. Its root is the one in b's quadrant:
    both factors b -+ 2 sqrt(k (k+1)) lie in the upper half plane, and so does the product of their principal roots.
    """
    number = x.dtype.type
    p = number(2) * k + number(1)
    b = x + p
    root_x, root_y = _square_root(x * x - y * y + number(2) * x * p + number(1), number(2) * y * np.abs(b))
    a, c = b + np.where(b < 0, -root_x, root_x), y + root_y
    scale = number(2) / (a * a + c * c)
    return a * scale, -c * scale


def _square_root(a: NDArray, b: NDArray) -> tuple[NDArray, NDArray]:
    """Principal root of a + i b for b >= 0; halves of one sign are added, never subtracted."""
    half = a.dtype.type(0.5)
    larger = np.sqrt(half * (np.sqrt(a * a + b * b) + np.abs(a)))
    smaller = half * b / larger
    return np.where(a >= 0, larger, smaller), np.where(a >= 0, smaller, larger)
