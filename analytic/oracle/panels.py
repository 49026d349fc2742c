"""How the range of integration is cut so that each panel's error has a small bound; the proof is the package's."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from mpmath import mp, mpf

from analytic.oracle.integrands import Integrand
from analytic.oracle.phases import Piece

__all__ = ["LOG_SLACK", "log_estimate", "log_tail", "negligible_from", "panels"]

# the bounds are float64 logarithms below 1e9 in absolute value
LOG_SLACK = 1e-6
# of the ellipses that are tried; large ones serve short segments, small ones a fast exponential
SUMS_OF_SEMIAXES = (1.5, 2.0, 2.6, 3.2, 4.0, 5.0, 6.5, 9.0, 13.0, 20.0, 40.0, 100.0, 1e3, 1e5, 1e8)
LARGEST_B = 1.5
MANY_PANELS = 100
DEEPEST_HALVING = 60
# e^700 is a float64 still; farther out the bound is larger than it need be
LARGEST_EXPONENT = 700.0


def _log_exponential(integrand: Integrand, t: float, b: float) -> float:
    """Logarithm of the largest |e^{-rate (e^t - 1)}| at Re t >= t, |Im t| <= b: rate (1 - e^t cos b) uncancelled."""
    return float(integrand.rate) * (2 * math.sin(b / 2) ** 2 - math.expm1(min(t, LARGEST_EXPONENT)) * math.cos(b))


def log_estimate(integrand: Integrand, pieces: list[tuple[Any, Any, Piece]]) -> float:
    """Roughly the logarithm of the integral: the highest of a few points times how wide the hill around it may be."""
    best = -math.inf
    rate = float(integrand.rate)
    for low, high, piece in pieces:
        start = float(low)
        # of a piece that a kink makes thinner than float64 tells
        reach = min(float(high - low), abs(float(integrand.start)) + 40)
        if rate:
            reach = min(reach, math.log1p(40 / rate))
        log_width = min(_log(high - low), 0.0, -math.log(rate) if rate else 0.0)
        for k in range(40):
            t = start + reach * (k + 0.5) / 40
            height = integrand.log_bound(t, t, 0.0, piece) + _log_exponential(integrand, t, 0.0)
            best = max(best, height + log_width)
    return best - 2


def log_tail(integrand: Integrand, piece: Piece, t: float, end: float) -> float:
    """Logarithm of a bound of what a piece gives from t on."""
    return integrand.log_largest(t, end, piece) + integrand.log_rest(t) + _log_exponential(integrand, t, 0.0)


def negligible_from(integrand: Integrand, piece: Piece, low: Any, high: Any, log_goal: float) -> Any:
    """Where the rest of a piece falls below the goal; `high` where it never does."""
    end = float(high)

    def matters(t: float) -> bool:
        return log_tail(integrand, piece, t, end) > log_goal - 3

    if not matters(float(low)):
        return low
    if math.isfinite(end) and matters(end):
        return high
    inside, outside = float(low), float(low) + 1
    while outside < end and matters(outside):
        inside, outside = outside, 2 * outside - float(low)
    outside = min(outside, end)
    while outside - inside > 1e-3 * (outside - float(low)):
        middle = (inside + outside) / 2
        inside, outside = (middle, outside) if matters(middle) else (inside, middle)
    return min(mpf(outside), high)


def panels(
    integrand: Integrand, piece: Piece, low: Any, high: Any, log_goal: float, nodes: int
) -> Iterator[tuple[Any, Any, float, float]]:
    """Halves of halves of a piece, with the logarithms of each one's error and of the integrand's bound in it."""
    waiting = [(low, high, 0)] if low < high else []
    while waiting:
        start, end, halvings = waiting.pop()
        log_error, log_largest = _log_error(integrand, piece, float((start + end) / 2), (end - start) / 2, nodes)
        if log_error < log_goal - math.log(MANY_PANELS) or halvings == DEEPEST_HALVING:
            yield start, end, log_error, log_largest
        else:
            middle = (start + end) / 2
            waiting += [(middle, end, halvings + 1), (start, middle, halvings + 1)]


def _log_error(integrand: Integrand, piece: Piece, middle: float, half: Any, nodes: int) -> tuple[float, float]:
    """Logarithms of (half) (64 / 15) M rho^(-2 nodes) / (1 - rho^-2), least over the ellipses, and of the least M.

    The least M, of the narrowest ellipse, is close to the largest value in the panel; a wide one's may be e^100 of it.
    """
    best = narrowest = math.inf
    # a panel may be thinner than any float64
    width, log_width = float(half), _log(half)
    for rho in SUMS_OF_SEMIAXES:
        a, b = width * (rho + 1 / rho) / 2, width * (rho - 1 / rho) / 2
        if b > LARGEST_B:
            break
        largest = integrand.log_bound(middle - a, middle + a, b, piece) + _log_exponential(integrand, middle - a, b)
        error = log_width + math.log(64 / 15) + largest - 2 * nodes * math.log(rho) - math.log1p(-(rho**-2))
        best, narrowest = min(best, error), min(narrowest, largest)
    return best, narrowest


def _log(length: Any) -> float:
    return float(mp.log(length))
