"""Phase functions of spheres, from Mie's coefficients to a table.

|S_1|^2 + |S_2|^2 is a polynomial in mu = cos theta, so its Legendre moments follow exactly from values at Chebyshev's
nodes and hold all there is to know. (Gauss's nodes cost more to find, and their weights suffer from the nodes' rounding
near mu = 1: for x = 1000 the integral was wrong by 5e-8.) A table of equally spaced cosines cannot follow a large
sphere's forward peak, which is 1/x wide in theta; sampling it there would spoil the normalisation (by a factor of 3 for
x = 100 and 1001 cosines). So a value of the table is the mean of the phase function over the hat that it stands for in
linear interpolation,

    table_j = int p(mu) hat_j(mu) dmu / int hat_j(mu) dmu,

which keeps the integral exactly, and widens the peak to the table's step. The hats' integrals are second differences
of F(mu) = int_-1^mu int_-1^m p(m') dm' dm, known from the moments without any quadrature.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray
from scipy.fft import dct, idct

__all__ = ["intensity_moments", "table"]

BLOCK = 512  # nodes at a time: memory grows with the largest order, not with its square


def intensity_moments(
    coefficients: Sequence[tuple[NDArray[np.complex128], NDArray[np.complex128]]], number: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Legendre moments of the light that a cloud scatters.

    A sphere of N orders needs 2 N + 1 nodes, so sizes are summed in octaves of N: small ones are many and need few.

    Parameters
    ----------
    coefficients : k pairs of ndarray     a_n and b_n of each size, n = 1, 2, ...
    number : ndarray, (m, k)              spheres of each size, for each of m clouds

    Returns
    -------
    ndarray, (m, l)  int P_l(mu) (|S_1|^2 + |S_2|^2) dmu: P_0's is k^2 / pi times the scattering cross-section

    Source: Bohren and Huffman 1983, Eqs. 4.46, 4.47 and 4.74. S_1 + S_2 and S_1 - S_2 need one sum each.
    """
    orders = np.array([len(a) for a, _ in coefficients])
    octaves = np.frexp(orders)[1]
    moments = np.zeros((len(number), 2 * orders.max() + 1))
    for octave in np.unique(octaves):
        members = np.flatnonzero(octaves == octave).tolist()
        highest = int(orders[members].max())
        found = _octave_moments([coefficients[member] for member in members], number[:, members], highest)
        moments[:, : 2 * highest + 1] += found
    return moments


def _octave_moments(
    coefficients: Sequence[tuple[NDArray[np.complex128], NDArray[np.complex128]]],
    number: NDArray[np.float64],
    orders: int,
) -> NDArray[np.float64]:
    """What `intensity_moments` returns, for sizes of at most `orders` orders."""
    n = np.arange(1, orders + 1)
    factor = (2 * n + 1) / (n * (n + 1))
    total, difference = (np.zeros((len(coefficients), orders), dtype=np.complex128) for _ in range(2))
    for row, (a, b) in enumerate(coefficients):
        total[row, : len(a)], difference[row, : len(a)] = np.add(a, b), np.subtract(a, b)
    total, difference = total * factor, difference * factor
    intensity = np.concatenate(
        [number @ _intensities(total, difference, mu) for mu in _blocks(_chebyshev_nodes(2 * orders + 1))], axis=1
    )
    # that many values fix a polynomial of degree 2 orders; times P_l it has twice the degree, and needs twice the nodes
    more = 4 * orders + 1
    padded = np.zeros((len(number), more))
    padded[:, : 2 * orders + 1] = dct(intensity, axis=1) * (more / (2 * orders + 1))
    # Fejer's first rule: its weights have the cosine series of the integrals of Chebyshev's polynomials
    degree = np.arange(0, more, 2)
    integrals = np.zeros(more)
    integrals[::2] = 2 / (1.0 - degree**2)
    weighted = idct(padded, axis=1) * dct(integrals, type=3) / more
    blocks = zip(_blocks(weighted.T), _blocks(_chebyshev_nodes(more)), strict=True)
    return np.sum([values.T @ legvander(mu, 2 * orders) for values, mu in blocks], axis=0)


def _intensities(
    total: NDArray[np.complex128], difference: NDArray[np.complex128], mu: NDArray[np.float64]
) -> NDArray[np.float64]:
    """|S_1|^2 + |S_2|^2 of each size, (k, mu): half of |S_1 + S_2|^2 + |S_1 - S_2|^2."""
    pi, tau = _angular_functions(mu, total.shape[1])
    added, subtracted = pi + tau, pi - tau
    parts = [part @ added for part in (total.real, total.imag)]
    parts += [part @ subtracted for part in (difference.real, difference.imag)]
    return np.sum(np.square(parts), axis=0) / 2


def _chebyshev_nodes(count: int) -> NDArray[np.float64]:
    return np.cos((np.arange(count) + 0.5) * (np.pi / count))


def _blocks(values: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    return [values[start : start + BLOCK] for start in range(0, len(values), BLOCK)]


def table(moments: NDArray[np.float64], angles: int) -> NDArray[np.float64]:
    """Phase functions [1/sr] at `angles` equally spaced mu from -1 to 1, (m, angles), from moments, (m, l), the first
    one 1.
    """
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
