"""Exponential integrals of the orders 1, 2 and 3, scaled, from the evaluation of one of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.exponential_integral import scaled_e1

__all__ = ["scaled_orders"]

Complex = NDArray[np.complexfloating]

# |z| up to which E1 is evaluated and the orders 2 and 3 follow; beyond, 3 is evaluated and 2 and 1 follow. Measured up
# to here: all three to 5.3e-15 (complex64: 7e-7), about three times the error of E1 itself
FROM_BELOW = 2.0
# depth of the fraction of order 3, ceil(constant + slope / (|z| + Re z)): measured over 20,000 points, its error is
# 4.7e-16 (complex64: 1.8e-7), that of the imaginary part alone 6.7e-16 (3.7e-7)
DEPTH = {np.complex64: (6.0, 44.0), np.complex128: (15.0, 190.0)}


def scaled_orders(z: Complex) -> tuple[Complex, Complex, Complex]:
    """F_n(z) = e^z E_n(z) for n = 1, 2, 3, of the type of z.

    n F_{n+1} = 1 - z F_n: upwards it multiplies errors by |z|^2 / 2 where |z| is large, downwards by 2 / |z|^2 where it
    is small. So small |z| start at the first order and large ones at the third.

    Parameters
    ----------
    z : ndarray, (n,), complex  Re z >= 0; 0 is refused

    Returns
    -------
    three ndarrays, (n,)

    Source: Abramowitz and Stegun 1964, 5.1.14 and 5.1.22.
    """
    first, second, third = np.empty_like(z), np.empty_like(z), np.empty_like(z)
    near = np.abs(z) <= FROM_BELOW
    if np.any(near):
        point = z[near]
        first[near] = scaled_e1(point)
        second[near] = 1 - point * first[near]
        third[near] = (1 - point * second[near]) / 2
    if not np.all(near):
        point = z[~near]
        third[~near] = _third_order(point)
        second[~near] = (1 - 2 * third[~near]) / point
        first[~near] = (1 - second[~near]) / point
    return first, second, third


def _third_order(z: Complex) -> Complex:
    """F_3(z) = 1/(z+3 - 3/(z+5 - 8/(z+7 - 15/(z+9 - ...)))) from the inside out, (n,)."""
    constant, slope = DEPTH[z.dtype.type]
    depth = np.ceil(constant + slope / (np.abs(z) + z.real))
    value = np.zeros_like(z)
    for k in range(int(depth.max()), -1, -1):
        value = np.where(k <= depth, 1 / (z + (2 * k + 3) - (k + 1) * (k + 3) * value), value)
    return value
