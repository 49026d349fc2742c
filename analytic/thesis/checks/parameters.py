"""What the equations are tried on: 39 segments, phase functions, and the oracle's airlight of each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from mpmath import mp, mpf

from analytic import phase
from analytic.oracle import exact_airlight
from analytic.oracle.phases import ExactPhase, Positive
from analytic.thesis.segment import Segment

__all__ = [
    "HG",
    "INSIDE",
    "ISOTROPIC",
    "PHASES",
    "RAYLEIGH",
    "SEGMENTS",
    "TruePhase",
    "airlight",
    "powers_of_v",
    "powers_of_v_and_w",
    "powers_of_w",
    "with_phases",
]

TRUTH_DIGITS = 30

# distance of the light and extinction: H from 3e-4 to 40
_SCALES = [
    (0.03, 0.01),
    (0.03, 0.2),
    (0.03, 4.0),
    (0.1, 0.05),
    (0.3, 0.01),
    (0.3, 1.0),
    (1.0, 0.01),
    (1.0, 0.2),
    (1.0, 4.0),
    (3.0, 0.1),
    (3.0, 1.0),
    (10.0, 0.01),
    (10.0, 4.0),
]
# the light's projection before, inside and after the segment: x_h, x_a, x_b
_PLACES = [(-0.75, 0.5, 3.0), (0.5, -1.0, 2.25), (2.0, -3.0, 0.75)]

SEGMENTS = [Segment(h, *place, kappa_t) for h, kappa_t in _SCALES for place in _PLACES]
INSIDE = [segment for segment in SEGMENTS if segment.x_a < segment.x_h < segment.x_b]


@dataclass(frozen=True)
class TruePhase:
    """A phase function as the thesis takes it, of cos phi, and as the oracle does."""

    name: str
    of_cosine: Callable[[Any], Any]
    exact: Any


def isotropic(cosine: Any) -> Any:
    """1 / (4 pi)."""
    return 1 / (4 * mp.pi)


def rayleigh(cosine: Any) -> Any:
    """3 / (16 pi) (1 + cos^2)."""
    return 3 / (16 * mp.pi) * (1 + cosine**2)


def henyey_greenstein(g: float) -> Callable[[Any], Any]:
    """(1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2))."""

    def lobe(cosine: Any) -> Any:
        exact_g = mpf(g)
        return (1 - exact_g**2) / (4 * mp.pi * (1 + exact_g**2 - 2 * exact_g * cosine) ** mpf("1.5"))

    return lobe


ISOTROPIC = TruePhase("isotropic", isotropic, phase("isotropic"))
RAYLEIGH = TruePhase("Rayleigh", rayleigh, phase("rayleigh"))
HG = TruePhase("HG 0.6", henyey_greenstein(0.6), phase("hg", g=0.6))
PHASES = [ISOTROPIC, RAYLEIGH, HG]


def with_phases(segments: Sequence[Segment] = SEGMENTS) -> list[tuple[Segment, TruePhase]]:
    """Each segment with one of the phase functions, so that each meets each place."""
    places = len(_PLACES)
    return [(segment, PHASES[(k // places + k) % len(PHASES)]) for k, segment in enumerate(segments)]


@dataclass(frozen=True)
class _Powers(Positive):
    """Sum of c_n v^n (sign 1) or of c_n / v^n (sign -1), c_n >= 0; equal ones share the oracle's answers."""

    coefficients: tuple[Any, ...]
    sign: int

    def value(self, cos2: Any, sin2: Any) -> Any:
        v = mp.sqrt(sin2 / cos2) if self.sign > 0 else mp.sqrt(cos2 / sin2)
        total = mpf(0)
        for coefficient in reversed(self.coefficients):
            total = total * v + coefficient
        return total

    def bound(self, low: float, high: float, b: float) -> float:
        # |e^{n s}| = e^{n Re s}
        most = max(self.sign * low, self.sign * high)
        return float(mp.fsum(c * mp.exp(n * most) for n, c in enumerate(self.coefficients)))


def powers_of_v(c_n: Sequence[Any]) -> ExactPhase:
    """The oracle's view of a phase function sum c_n v^n, c_n >= 0."""
    return ExactPhase((_Powers(tuple(c_n), 1),))


def powers_of_w(d_n: Sequence[Any]) -> ExactPhase:
    """The oracle's view of sum d_n w^n with w = -1 / v, d_n (-1)^n >= 0."""
    return ExactPhase((_Powers(tuple((-1) ** n * d for n, d in enumerate(d_n)), -1),))


def powers_of_v_and_w(c_n: Sequence[Any], d_n: Sequence[Any]) -> ExactPhase:
    """The first before x_h, where v < 1, and the second behind it."""
    return ExactPhase((powers_of_v(c_n).pieces[0], powers_of_w(d_n).pieces[0]), (mpf(0),))


@cache
def airlight(segment: Segment, phase_function: Any) -> Any:
    """L_m / (I kappa_s) of a segment by the oracle, 30 digits."""
    # differences of coordinates that float64 holds exactly, and so do their differences
    x_a, x_b = segment.x_a - segment.x_h, segment.x_b - segment.x_h
    return exact_airlight(segment.h, x_a, x_b, segment.kappa_t, phase_function, TRUTH_DIGITS).value
