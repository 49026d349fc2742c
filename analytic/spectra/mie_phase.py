"""Phase functions of spheres, from Mie's coefficients to a table.

|S_1|^2 + |S_2|^2 is a polynomial in mu = cos theta, so its Legendre moments follow exactly from a Gauss-Legendre rule
and hold all there is to know. A table of equally spaced cosines cannot follow a large sphere's forward peak, which is
1/x wide in theta; sampling it there would spoil the normalisation (by a factor of 3 for x = 100 and 1001 cosines). So a
value of the table is the mean of the phase function over the hat that it stands for in linear interpolation,

    table_j = int p(mu) hat_j(mu) dmu / int hat_j(mu) dmu,

which keeps the integral exactly, and widens the peak to the table's step. The hats' integrals are second differences
of F(mu) = int_-1^mu int_-1^m p(m') dm' dm, known from the moments without any quadrature.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander
from numpy.typing import NDArray

__all__ = ["intensity_moments", "table"]


def intensity_moments(
    coefficients: Sequence[tuple[NDArray[np.complex128], NDArray[np.complex128]]], number: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Legendre moments of the light that a cloud scatters, the first one 1.

    Parameters
    ----------
    coefficients : k pairs of ndarray     a_n and b_n of each size, n = 1, 2, ...
    number : ndarray, (m, k)              spheres of each size, for each of m clouds

    Returns
    -------
    ndarray, (m, l)  int P_l(mu) p(mu) dmu, p of integral 1 in mu: (1, g, ...)

    Source: Bohren and Huffman 1983, Eqs. 4.46, 4.47 and 4.74. S_1 + S_2 and S_1 - S_2 need one sum each.
    """
    orders = max(len(a) for a, _ in coefficients)
    mu, weights = leggauss(2 * orders + 1)  # exact to degree 4 orders + 1: the intensity's 2 orders, and P_l's
    pi, tau = _angular_functions(mu, orders)
    n = np.arange(1, orders + 1)
    factor = (2 * n + 1) / (n * (n + 1))
    total, difference = (np.zeros((len(coefficients), orders), dtype=np.complex128) for _ in range(2))
    for row, (a, b) in enumerate(coefficients):
        total[row, : len(a)], difference[row, : len(a)] = np.add(a, b), np.subtract(a, b)
    intensity = sum(
        part**2
        for amplitude, angular in ((total, pi + tau), (difference, pi - tau))
        for part in ((amplitude.real * factor) @ angular, (amplitude.imag * factor) @ angular)
    )
    moments = (number @ intensity * weights) @ legvander(mu, 2 * orders)
    return moments / moments[:, :1]


def table(moments: NDArray[np.float64], angles: int) -> NDArray[np.float64]:
    """Phase functions [1/sr] at `angles` equally spaced mu from -1 to 1, (m, angles), from moments, (m, l)."""
    mu = np.linspace(-1.0, 1.0, angles)
    step = 2 / (angles - 1)
    degree = moments.shape[1] - 1
    # int_-1^mu P_l = (P_{l+1} - P_{l-1}) / (2 l + 1), with P_{-1} = -1; and once more the same
    legendre = legvander(mu, degree + 2)
    for last in (degree + 1, degree):
        before = np.concatenate([-legendre[:, :1], legendre[:, :last]], axis=1)
        legendre = (legendre[:, 1 : last + 2] - before) / (2 * np.arange(last + 1) + 1)
    twice = (moments * (np.arange(degree + 1) + 0.5)) @ legendre.T
    rise = np.diff(twice, axis=1)
    # beyond its ends p is 0: twice is flat before the first hat and rises by `step` a step after the last
    rise = np.concatenate([np.zeros_like(rise[:, :1]), rise, np.full_like(rise[:, :1], step)], axis=1)
    hats = np.diff(rise, axis=1) / step
    hats[:, [0, -1]] *= 2
    return hats / step / (2 * np.pi)


def _angular_functions(mu: NDArray[np.float64], orders: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """pi_n and tau_n, (orders, mu), n = 1, 2, ... (Bohren and Huffman 1983, Eq. 4.47)."""
    pi = np.zeros((orders + 1, mu.size))
    pi[1] = 1.0
    for n in range(2, orders + 1):
        pi[n] = ((2 * n - 1) * mu * pi[n - 1] - n * pi[n - 2]) / (n - 1)
    order = np.arange(1, orders + 1)[:, None]
    return pi[1:], order * mu * pi[1:] - (order + 1) * pi[:-1]
