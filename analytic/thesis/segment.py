"""The segment of a ray in the thesis's letters (Figure 4.6), and integrals along it."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from mpmath import mp, mpf

from analytic.oracle.gauss import gauss_legendre

__all__ = ["Segment", "integrate"]

NODES = 40
# what a panel may span: a factor of e^0.7 = 2 in distance from the light, and this much optical depth
PANEL = 0.7
PANEL_DEPTH = 20
DEEPEST = 140  # e^-140 = 1e-61


@dataclass(frozen=True)
class Segment:
    """From the eye at x_a to x_b, the light at the distance h from x_h; each number is taken as exactly what it is.

    Attributes
    ----------
    h : float            distance of the light from the ray
    x_h, x_a, x_b : float coordinates on the ray of the light's projection, the eye and the end
    kappa_t : float      extinction coefficient
    """

    h: float
    x_h: float
    x_a: float
    x_b: float
    kappa_t: float

    @property
    def H(self) -> Any:
        """kappa_t h (Eq. 17)."""
        return mpf(self.kappa_t) * mpf(self.h)

    def d(self, x: Any) -> Any:
        """Distance to the light, Eq. 15."""
        return mp.sqrt(mpf(self.h) ** 2 + (mpf(x) - mpf(self.x_h)) ** 2)

    def u(self, x: Any) -> Any:
        """(x - x_h) / h, Eq. 17."""
        return (mpf(x) - mpf(self.x_h)) / mpf(self.h)

    def v(self, x: Any) -> Any:
        """Eq. 18's u + sqrt(1 + u^2)."""
        u = self.u(x)
        return u + mp.sqrt(1 + u**2)

    def w(self, x: Any) -> Any:
        """Eq. 25's u - sqrt(1 + u^2)."""
        u = self.u(x)
        return u - mp.sqrt(1 + u**2)

    @cached_property
    def cuts(self) -> list[Any]:
        """Coordinates from x_a to x_b between which integrands are smooth enough for `integrate`.

        Where the light has crossed an optical depth of 140 more than to the eye, the rest is left out.
        """
        h, x_h, kappa_t = mpf(self.h), mpf(self.x_h), mpf(self.kappa_t)
        first, last = mp.asinh(self.u(self.x_a)), mp.asinh(self.u(self.x_b))
        depths = [
            mp.log(mp.exp(first) + mpf(depth) / (kappa_t * h)) for depth in range(PANEL_DEPTH, DEEPEST + 1, PANEL_DEPTH)
        ]
        end = min(last, depths[-1])
        count = int((end - first) / PANEL) + 1
        inner = {first + (end - first) * k / count for k in range(1, count)} | {s for s in depths if s < end}
        middle = [x_h + h * mp.sinh(s) for s in sorted(inner)]
        return [mpf(self.x_a), *middle, mpf(self.x_b) if end == last else x_h + h * mp.sinh(end)]


def integrate(function: Callable[[Any], Any], cuts: Iterable[Any]) -> Any:
    """Integral over the panels between the cuts, 40 Gauss nodes each, at mpmath's present precision."""
    ends = list(cuts)
    nodes = gauss_legendre(NODES, mp.prec)
    total = mpf(0)
    for start, end in itertools.pairwise(ends):
        middle, half = (start + end) / 2, (end - start) / 2
        total += half * mp.fsum(weight * function(middle + half * node) for node, weight in nodes)
    return total
