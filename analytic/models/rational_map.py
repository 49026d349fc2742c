"""The rational map that makes the airlight smooth from end to end, for quadratures in float32.

With v = tan(theta / 2) and H = sigma_t h (Weng 2010, Eq. 18, the prefactor repaired) the integrand

    e^{-H (v - v_a)} p(cos theta) 2 / (1 + v^2)

changes over v ~ 1 and over the lobe of the phase function near v = 0, falls like 1 / v^2 behind the light, and ends
where H v is some 10: five or more powers of ten apart. In Y = 1 / X, v = q (X^2 - 1), which takes v = 0 .. inf to
Y = 1 .. 0, all of that has about the same width. It costs two square roots a segment and one division a node.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.phase import Phase
from analytic.phases.tabulated import Tabulated

__all__ = ["RationalMap", "RationalRule", "lobe_ratio"]

# needs the fewest nodes among 0.01, 0.02 and 0.04, with and without the ratio of `difficulty`, or the root of that
DEPTH_SHARE = 0.01


@dataclass(frozen=True)
class RationalRule:
    """Nodes and weights on [0, 1], counted from Y_a to Y_b, with the map that they go with.

    Attributes
    ----------
    nodes, weights : tuple of float, (n,)
    clip : float  optical depth H (v - v_a) from which the rest is left out
    q : float     scale of the map, to be multiplied by `lobe_ratio`
    """

    nodes: tuple[float, ...]
    weights: tuple[float, ...]
    clip: float
    q: float


@dataclass(frozen=True, eq=False)
class RationalMap:
    """The map of n pieces of rays; every difference is written as a product, so short ones keep their digits.

    Attributes
    ----------
    v_a : ndarray, (n,)        where it begins
    span : ndarray, (n,)       v_b - v_a, cut at clip / H
    optical_h : ndarray, (n,)  H
    q : float or ndarray, (n,)  scale
    x_a, x_b : ndarray, (n,)   X at both ends
    dy : ndarray, (n,)         Y_a - Y_b
    """

    v_a: NDArray[np.floating]
    span: NDArray[np.floating]
    optical_h: NDArray[np.floating]
    q: float | NDArray[np.floating]
    x_a: NDArray[np.floating]
    x_b: NDArray[np.floating]
    dy: NDArray[np.floating]

    @classmethod
    def of(
        cls,
        v_a: NDArray[np.floating],
        span: NDArray[np.floating],
        optical_h: NDArray[np.floating],
        q: float | NDArray[np.floating],
        clip: float,
    ) -> RationalMap:
        """The map from v_a to v_a + min(span, clip / H); where H is 0, span must be finite."""
        with np.errstate(divide="ignore", over="ignore"):
            span = np.minimum(span, v_a.dtype.type(clip) / optical_h)
        x_a, x_b = np.sqrt(1 + v_a / q), np.sqrt(1 + (v_a + span) / q)
        return cls(v_a, span, optical_h, q, x_a, x_b, span / (q * (x_a + x_b)) / (x_a * x_b))

    def __getitem__(self, which: NDArray[np.bool_]) -> RationalMap:
        """Part of the pieces, all of one scale."""
        return RationalMap(
            self.v_a[which],
            self.span[which],
            self.optical_h[which],
            self.q,
            self.x_a[which],
            self.x_b[which],
            self.dy[which],
        )

    @property
    def difficulty(self) -> NDArray[np.floating]:
        """How hard the piece is for a Gauss-Legendre rule, (n,): its width in Y, and its optical depth.

        The depth counts by the ratio of both ends: far behind the light a piece is narrow, yet H (v - v_a) in Y is
        all but level at first and steep at last.
        """
        return self.dy + DEPTH_SHARE * (self.optical_h * self.span) * (self.x_b / self.x_a)

    def at(self, node: float) -> tuple[NDArray[np.floating], NDArray[np.floating]]:
        """Give v - v_a and its derivative by the node, each (n,), at a node between 0 and 1."""
        step = self.dy * node
        x = 1 / (1 / self.x_a - step)
        return self.q * step * x * self.x_a * (x + self.x_a), 2 * self.q * self.dy * (x * x * x)

    def integral(self, phase: Phase, rule: RationalRule) -> NDArray[np.floating]:
        """Integral of e^{-H (v - v_a)} p 2 / (1 + v^2) over v by a rule, (n,)."""
        total = np.zeros_like(self.v_a)
        for node, weight in zip(rule.nodes, rule.weights, strict=True):
            past, slope = self.at(node)
            v = self.v_a + past
            with np.errstate(over="ignore"):  # of v^2, where the light has long been left behind
                cos2 = 1 / (1 + v * v)
            value = phase.of_half_angle(cos2, v * (v * cos2))
            total += weight * (value * np.exp(-self.optical_h * past) * slope * cos2)
        return 2 * total


def lobe_ratio(phase: Phase) -> float:
    """Fourth root of backward over forward scattering: what the map's scale owes to the phase function.

    `hg` changes over v ~ (1 - g) / (1 + g), the cube root of that quotient, and `schlick` over its fourth root. A table
    has no lobe of its own: it is linear from one value to the next.
    """
    if isinstance(phase, Tabulated):
        return 1.0
    return float((phase.evaluate(-1.0) / phase.evaluate(1.0)) ** 0.25)
