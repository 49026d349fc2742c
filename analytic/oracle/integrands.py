"""What is integrated over t = s - s_a, and its bounds in the complex plane; the proof is the package's."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from mpmath import mp, mpf

from analytic.oracle.phases import ExactPhase, Piece

__all__ = ["BehindTheLight", "BesideTheLight", "Integrand"]


class BesideTheLight:
    """The integrand over t for h > 0, e^{-rate (e^t - 1)} p(-tanh s) / cosh s, and what bounds it."""

    def __init__(self, h: Any, x_a: Any, x_b: Any, sigma_t: Any, phase: ExactPhase) -> None:
        u = x_a / h
        root = mp.sqrt(1 + u * u)
        self.v_a = u + root if u > 0 else 1 / (root - u)
        self.start = mp.log(self.v_a)
        self.length = mp.inf if mp.isinf(x_b) else mp.asinh(mpf(x_b) / h) - self.start
        self.rate = sigma_t * h * self.v_a
        self.depth_at_eye = sigma_t * h * root
        self.prefactor = mp.exp(-self.depth_at_eye) / h
        self.phase = phase

    def pieces(self) -> Iterator[tuple[Any, Any, Piece]]:
        """Where each smooth part of the segment begins and ends."""
        cuts = [kink - self.start for kink in self.phase.kinks]
        for low, high, piece in zip([-mp.inf, *cuts], [*cuts, mp.inf], self.phase.pieces, strict=True):
            if max(low, 0) < min(high, self.length):
                yield max(low, mpf(0)), min(high, self.length), piece

    def factor(self, growth: Any, piece: Piece) -> tuple[Any, Any]:
        """Value of p / cosh s at growth = e^t, and its size for the rounding."""
        v = self.v_a * growth
        cos2 = 1 / (1 + v * v)
        sin2 = v * v * cos2
        return 2 * v * cos2 * piece.value(cos2, sin2), 2 * v * cos2 * piece.size(cos2, sin2)

    def log_bound(self, low: float, high: float, b: float, piece: Piece) -> float:
        """Logarithm of a bound of |p / cosh s| wherever low <= Re t <= high and |Im t| <= b."""
        first, last = low + float(self.start), high + float(self.start)
        x = 0.0 if first < 0 < last else min(abs(first), abs(last))
        return log(piece.bound(first, last, b)) + math.log(2 / math.cos(b)) - x - math.log1p(math.exp(-2 * x))

    def log_largest(self, low: float, high: float, piece: Piece) -> float:
        """Logarithm of a bound of p from low to high."""
        return log(piece.bound(low + float(self.start), high + float(self.start), 0.0))

    def log_rest(self, t: float) -> float:
        """Logarithm of a bound of int dt / cosh s from t on: at most 2 e^{-s}, and pi."""
        return min(math.log(2) - t - float(self.start), math.log(math.pi))


class BehindTheLight:
    """The integrand for h = 0 behind the light, where x = x_a e^t: the same with e^{-t} for 1 / cosh s."""

    def __init__(self, x_a: Any, x_b: Any, sigma_t: Any, phase: ExactPhase) -> None:
        self.length = mp.inf if mp.isinf(x_b) else mp.log(mpf(x_b) / x_a)
        self.rate = 2 * sigma_t * x_a
        self.depth_at_eye = sigma_t * x_a
        self.prefactor = mp.exp(-self.depth_at_eye) / x_a
        self.start = mpf(0)
        self.backward = phase.pieces[-1]

    def pieces(self) -> Iterator[tuple[Any, Any, Piece]]:
        """The whole."""
        yield mpf(0), self.length, self.backward

    def factor(self, growth: Any, piece: Piece) -> tuple[Any, Any]:
        """p(-1) e^{-t} and its size."""
        return piece.value(0, 1) / growth, piece.size(0, 1) / growth

    def log_bound(self, low: float, high: float, b: float, piece: Piece) -> float:
        """Logarithm of a bound of |p(-1) e^{-t}|."""
        return log(float(piece.size(0, 1))) - low

    def log_largest(self, low: float, high: float, piece: Piece) -> float:
        """Logarithm of p(-1)."""
        return log(float(piece.size(0, 1)))

    def log_rest(self, t: float) -> float:
        """Logarithm of int e^{-t} dt from t on."""
        return -t


Integrand = BesideTheLight | BehindTheLight


def log(value: float) -> float:
    return math.log(value) if value > 0 else -math.inf
