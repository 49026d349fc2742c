"""Gauss-Legendre nodes and weights to any number of digits."""

from __future__ import annotations

from functools import cache
from typing import Any

from mpmath import mp, mpf

__all__ = ["gauss_legendre"]

# from a cosine that misses its node by 1 % of a spacing, at a low precision: the error is squared four times
FIRST_STEPS = 4
LOW_PRECISION = 60


@cache
def gauss_legendre(count: int, precision: int) -> tuple[tuple[Any, Any], ...]:
    """Nodes in (-1, 1) and weights of `count` points, right to within 2^-precision of each."""
    # Newton's step squares the error, and multiplies it by up to count^2 at the outermost node
    precisions = [precision + 20]
    while precisions[-1] > LOW_PRECISION + 4 * count.bit_length():
        precisions.append(precisions[-1] // 2 + 2 * count.bit_length())
    steps = FIRST_STEPS * precisions[-1:] + precisions[::-1]
    found = []
    for k in range((count + 1) // 2):
        x = mpf(0)
        if 2 * k + 1 != count:
            with mp.workprec(precisions[-1]):
                x = mp.cos(mp.pi * (k + mpf(3) / 4) / (count + mpf(1) / 2))
            for step in steps:
                with mp.workprec(step):
                    value, slope = _legendre(count, x)
                    x -= value / slope
        with mp.workprec(precision + 20):
            _, slope = _legendre(count, x)
            found.append((x, 2 / ((1 - x * x) * slope * slope)))
    with mp.workprec(precision):
        half = [(+x, +weight) for x, weight in found]
        return (*half, *((-x, weight) for x, weight in reversed(half[: count // 2])))


def _legendre(count: int, x: Any) -> tuple[Any, Any]:
    """The Legendre polynomial of that degree and its slope."""
    before, value = mpf(1), x
    for n in range(2, count + 1):
        before, value = value, ((2 * n - 1) * x * value - (n - 1) * before) / n
    return value, count * (x * value - before) / (x * x - 1)
