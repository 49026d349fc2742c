"""The phase functions in mpmath, with a bound of each in the complex plane; for `analytic.oracle`.

All are written in C = cos^2(theta / 2) = 1 / (1 + v^2) and S = sin^2(theta / 2) = v^2 / (1 + v^2), where
v = e^s = tan(theta / 2) and cos theta = C - S = -tanh s: sums then have terms of one sign, and nothing cancels. Their
singularities are where A + B v^2 vanishes with A, B >= 0: at |Im s| = pi / 2, whatever the parameter.

The bounds hold for s = x + i y with low <= x <= high and |y| <= b < pi / 2. They rest on

    |A + B e^{2 i y}| >= (A + B) |cos y|   for A, B >= 0,

whose square is (A + B)^2 cos^2 y + (A - B)^2 sin^2 y >= (A + B)^2 cos^2 y. As |1 + e^{2 s}| <= 1 + e^{2 x}, a base
(A + B e^{2 s}) / (1 + e^{2 s}) is at least cos b times its value at x, and that is monotone in x: least at an end.
"""

from __future__ import annotations

import itertools
import math
import sys
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from mpmath import mp, mpf

__all__ = ["ExactPhase", "Piece", "exact_phase"]


class Piece(Protocol):
    """A phase function, or the part of one between two kinks."""

    def value(self, cos2: Any, sin2: Any) -> Any:
        """Value [1/sr], mpf, from cos^2 and sin^2 of half the scattering angle, which add up to 1."""

    def size(self, cos2: Any, sin2: Any) -> Any:
        """Sum of the absolute values of the terms that `value` adds: what its rounding errors are relative to."""

    def bound(self, low: float, high: float, b: float) -> float:
        """At least the absolute value wherever low <= Re s <= high and |Im s| <= b."""


@dataclass(frozen=True)
class ExactPhase:
    """Pieces by ascending s = ln tan(theta / 2), and the len(pieces) - 1 places where one gives way to the next."""

    pieces: tuple[Piece, ...]
    kinks: tuple[Any, ...] = ()


class Positive(ABC):
    """A piece without a subtraction."""

    @abstractmethod
    def value(self, cos2: Any, sin2: Any) -> Any:
        """Value [1/sr], as `Piece` has it."""

    def size(self, cos2: Any, sin2: Any) -> Any:
        """The value itself."""
        return self.value(cos2, sin2)


class _Isotropic(Positive):
    def __init__(self) -> None:
        self.level = 1 / (4 * mp.pi)

    def value(self, cos2: Any, sin2: Any) -> Any:
        return self.level

    def bound(self, low: float, high: float, b: float) -> float:
        return float(self.level)


class _Rayleigh(Positive):
    """3 / (16 pi) (1 + cos^2 theta), where 1 + (C - S)^2 = 2 (C^2 + S^2)."""

    def __init__(self) -> None:
        self.factor = 3 / (8 * mp.pi)

    def value(self, cos2: Any, sin2: Any) -> Any:
        return self.factor * (cos2 * cos2 + sin2 * sin2)

    def bound(self, low: float, high: float, b: float) -> float:
        # |tanh s| <= cosh x / (cos b cosh x)
        return float(self.factor) * (1 + 1 / math.cos(b) ** 2) / 2


class _HenyeyGreenstein(Positive):
    """The base 1 + g^2 - 2 g cos theta is (1 - g)^2 C + (1 + g)^2 S."""

    def __init__(self, g: Any) -> None:
        self.ahead, self.behind = (1 - mpf(g)) ** 2, (1 + mpf(g)) ** 2
        self.factor = (1 - mpf(g)) * (1 + mpf(g)) / (4 * mp.pi)

    def value(self, cos2: Any, sin2: Any) -> Any:
        base = self.ahead * cos2 + self.behind * sin2
        return self.factor / (base * mp.sqrt(base))

    def bound(self, low: float, high: float, b: float) -> float:
        return float(self.factor) * _least(float(self.ahead), float(self.behind), low, high, b) ** -1.5


class _Schlick(Positive):
    """The base 1 - k cos theta is (1 - k) C + (1 + k) S."""

    def __init__(self, k: Any) -> None:
        self.ahead, self.behind = 1 - mpf(k), 1 + mpf(k)
        self.factor = self.ahead * self.behind / (4 * mp.pi)

    def value(self, cos2: Any, sin2: Any) -> Any:
        base = self.ahead * cos2 + self.behind * sin2
        return self.factor / (base * base)

    def bound(self, low: float, high: float, b: float) -> float:
        return float(self.factor) * _least(float(self.ahead), float(self.behind), low, high, b) ** -2


class _CornetteShanks(Positive):
    """Rayleigh's factor times the lobe: 8 pi / (2 + g^2) is 16 pi / 3 times 3 / (4 + 2 g^2)."""

    def __init__(self, g: Any) -> None:
        self.lobe, self.rayleigh = _HenyeyGreenstein(g), _Rayleigh()
        self.factor = 8 * mp.pi / (2 + mpf(g) ** 2)

    def value(self, cos2: Any, sin2: Any) -> Any:
        return self.factor * self.rayleigh.value(cos2, sin2) * self.lobe.value(cos2, sin2)

    def bound(self, low: float, high: float, b: float) -> float:
        return float(self.factor) * self.rayleigh.bound(low, high, b) * self.lobe.bound(low, high, b)


class _Line:
    """A straight line in cos theta = C - S, from its values at both ends of a table's step.

    With C + S = 1 the mean of both, low (i + 1 - last C) + high (last C - i), has the coefficients

        C: high (last - i) - low (last - i - 1),    S: low (i + 1) - high i,

    which are what the line would be at cos theta = +1 and at -1: at the ends of the table, the table's own values.
    """

    def __init__(self, low: Any, high: Any, i: int, last: int) -> None:
        self.ahead, self.behind = high * (last - i) - low * (last - i - 1), low * (i + 1) - high * i
        # what the roundings of the coefficients, too, are relative to
        self.size_ahead, self.size_behind = high * (last - i) + low * (last - i - 1), low * (i + 1) + high * i

    def value(self, cos2: Any, sin2: Any) -> Any:
        return self.ahead * cos2 + self.behind * sin2

    def size(self, cos2: Any, sin2: Any) -> Any:
        return self.size_ahead * cos2 + self.size_behind * sin2

    def bound(self, low: float, high: float, b: float) -> float:
        # |C| = 1 / |1 + e^{2 s}| <= 1 / ((1 + e^{2 x}) cos b), and S alike; of the size, which is not smaller and of
        # which the roundings of the coefficients are a tiny part, so that it holds with and without them
        ahead, behind = float(self.size_ahead), float(self.size_behind)
        if not (ahead or behind):
            return 0.0
        # products that underflow must not become a bound of 0
        return max(ahead * _share(-2 * low) + behind * _share(2 * high), sys.float_info.min) / math.cos(b)


def _share(exponent: float) -> float:
    """e^y / (1 + e^y)."""
    return 1 / (1 + math.exp(min(-exponent, 700.0)))


def _least(ahead: float, behind: float, low: float, high: float, b: float) -> float:
    """At most |ahead + behind e^{2 s}| / |1 + e^{2 s}|."""
    ends = (ahead * _share(-2 * x) + behind * _share(2 * x) for x in (low, high))
    return math.cos(b) * min(ends)


def _table(values: Sequence[float]) -> ExactPhase:
    """Lines between equally spaced cosines from -1 to 1, scaled to the integral 1 over the sphere."""
    table = [mpf(value) for value in values]
    last = len(table) - 1
    scale = last / (2 * mp.pi * mp.fsum(low + high for low, high in itertools.pairwise(table)))
    pieces, kinks = [], []
    for i in range(last - 1, -1, -1):
        # from cos theta = 2 i / last - 1 to 2 (i + 1) / last - 1
        pieces.append(_Line(scale * table[i], scale * table[i + 1], i, last))
        if i:
            # 1 - cos theta = 2 (last - i) / last and 1 + cos theta = 2 i / last
            kinks.append(mp.log(mpf(last - i) / i) / 2)
    return ExactPhase(tuple(pieces), tuple(kinks))


def exact_phase(phase: Any) -> ExactPhase:
    """A phase function of `analytic.phase` at mpmath's present precision, its parameters taken as exact numbers.

    Raises
    ------
    ValueError
        If there is no formula for it here.

    Source: the papers that `analytic.phases` names; their formulas, none of that package's code.
    """
    name = getattr(phase, "name", None)
    if name == "isotropic":
        return ExactPhase((_Isotropic(),))
    if name == "rayleigh":
        return ExactPhase((_Rayleigh(),))
    if name == "hg":
        return ExactPhase((_HenyeyGreenstein(phase.g),))
    if name == "schlick":
        return ExactPhase((_Schlick(phase.k),))
    if name == "cornette_shanks":
        return ExactPhase((_CornetteShanks(phase.g),))
    if name == "tabulated":
        return _table(phase.values)
    raise ValueError(f"phase must be one of analytic.phase: {phase!r}")
