"""The airlight and the phase functions in mpmath, to 30 digits."""

from __future__ import annotations

import itertools

import mpmath
import numpy as np


def isotropic(cosine):
    return 1 / (4 * mpmath.pi)


def rayleigh(cosine):
    return 3 / (16 * mpmath.pi) * (1 + cosine**2)


def henyey_greenstein(g):
    g = mpmath.mpf(g)
    return lambda cosine: (1 - g**2) / (4 * mpmath.pi * (1 + g**2 - 2 * g * cosine) ** mpmath.mpf("1.5"))


def schlick(k):
    k = mpmath.mpf(k)
    return lambda cosine: (1 - k**2) / (4 * mpmath.pi * (1 - k * cosine) ** 2)


def cornette_shanks(g):
    hg = henyey_greenstein(g)
    return lambda cosine: 3 * (1 + cosine**2) / (4 + 2 * mpmath.mpf(g) ** 2) * hg(cosine)


def tabulated(values):
    table = [mpmath.mpf(value) for value in values]
    last = len(table) - 1
    area = sum((low + high) / last for low, high in itertools.pairwise(table))

    def function(cosine):
        position = (cosine + 1) / 2 * last
        i = max(0, min(int(position), last - 1))
        # a mean of both: a difference of them would be rounded relative to the larger one
        return (table[i] * (i + 1 - position) + table[i + 1] * (position - i)) / (2 * mpmath.pi * area)

    function.nodes = [2 * mpmath.mpf(i) / last - 1 for i in range(1, last)]
    return function


DEPTHS = (1, 2, 4, 8, 16, 32, 64, 128)


def oracle(h, x_a, x_b, sigma_t, function):
    """L / (I sigma_s): Eq. 16 of the thesis with x = h sinh(s), piece by piece, at 30 digits.

    Pieces of at most 1 in s, and shorter where the optical depth from the eye grows; what lies behind an optical depth
    of 128 is below the 50th digit. An infinite end is e^200 times as far as the eye.
    """
    with mpmath.workdps(30):
        h, x_a, sigma_t = mpmath.mpf(h), mpmath.mpf(x_a), mpmath.mpf(sigma_t)

        def integrand(s):
            x, d = h * mpmath.sinh(s), h * mpmath.cosh(s)
            return mpmath.exp(-sigma_t * (x - x_a + d)) / d * function(-x / d)

        first = mpmath.asinh(x_a / h)
        last = first + 200 if np.isinf(x_b) else mpmath.asinh(mpmath.mpf(x_b) / h)
        breaks = [first, last]
        if sigma_t > 0:
            depths = [mpmath.log(mpmath.exp(first) + t / (sigma_t * h)) for t in DEPTHS]
            last = min(last, depths[-1])
            breaks = [first, last, *(s for s in depths if s < last)]
        k = mpmath.floor(first) + 1
        while k < last:
            breaks.append(k)
            k += 1
        # cos theta = -tanh(s)
        kinks = [mpmath.atanh(-cosine) for cosine in getattr(function, "nodes", ())]
        breaks += [s for s in kinks if first < s < last]
        # mpmath stops at an absolute error
        scale = max(integrand(s) for s in breaks)
        value, error = mpmath.quad(lambda s: integrand(s) / scale, sorted(breaks), error=True)
        assert error < 1e-15 * value
        return value * scale


def relative_error(value, truth):
    return abs(float((mpmath.mpf(float(value)) - truth) / truth))
