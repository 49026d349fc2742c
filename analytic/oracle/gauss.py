"""Gauss-Legendre nodes and weights to any number of digits."""

from __future__ import annotations

from functools import cache
from typing import Any

from mpmath import mp, mpf

__all__ = ["gauss_legendre"]


@cache
def gauss_legendre(count: int, precision: int) -> tuple[tuple[Any, Any], ...]:
    """Nodes in (-1, 1) and weights of `count` points, right to within 2^-precision of each."""
    with mp.workprec(precision + 20):
        found = []
        for k in range(count):
            x = mp.cos(mp.pi * (k + mpf(3) / 4) / (count + mpf(1) / 2))
            for _ in range(precision.bit_length() + 2):
                before, value = mpf(1), x
                for n in range(2, count + 1):
                    before, value = value, ((2 * n - 1) * x * value - (n - 1) * before) / n
                slope = count * (x * value - before) / (x * x - 1)
                x -= value / slope
            found.append((x, 2 / ((1 - x * x) * slope * slope)))
    with mp.workprec(precision):
        return tuple((+x, +weight) for x, weight in found)
