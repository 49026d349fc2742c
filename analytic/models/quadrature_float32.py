"""Airlight by a few tuned nodes under a rational map: what a shader needs to be accurate to float32, for any phase.

With v = tan(theta / 2), H = sigma_t h and d_a the light's distance from the eye (Weng 2010, Eq. 18, repaired)

    L = I sigma_s / h e^{-sigma_t d_a} int_{v_a}^{v_b} e^{-H (v - v_a)} p(cos theta) 2 / (1 + v^2) dv,

summed at the nodes of `rational_rules` in the variable of `rational_map`. Every difference is a product, so nothing
cancels in float32. A phase function with kinks, a table, is cut at each of them.

Worst relative error over H 1e-4 .. 50, optical positions -50 .. 50, lengths from 1e-7 to infinite, with isotropic,
Rayleigh, HG, Schlick and Cornette-Shanks up to +-0.9 (float64, held-out segments; `results/quadrature` has the table):

=====  =======  =======  =======  =======
nodes  0.9      hg 0.95  hg 0.99  float32
=====  =======  =======  =======  =======
5      5.4e-3   1.3e-2   6.2e-2
6      1.6e-3   2.3e-3   1.6e-2
7      8.7e-4   1.4e-3   7.9e-3
8      3.7e-4   4.8e-4   1.2e-3
9      1.5e-4   1.5e-4   4.3e-4
10     5.9e-5   6.3e-5   1.5e-4   5.4e-5
12     1.3e-5   1.8e-5   1.2e-5   1.3e-5
14     2.4e-6   1.7e-6   1.9e-6
16     2.4e-6   1.5e-6   2.4e-6   2.4e-6
24     5.3e-7   3.5e-7   4.0e-7   8.4e-7
=====  =======  =======  =======  =======

So `hg` 0.99 keeps 1e-4 from 12 nodes on, 10 of which do up to 0.95. The last column is float32, over visible segments
(optical depth to the near end at most 12), with the factor e^{-sigma_t d_a} divided out: its exponent is rounded twice,
which by itself costs 1.4e-6 there with any model; 2.0e-6 is the two together with 24 nodes. A table that falls to 0 is
as accurate as cos theta is: in float32 there is no relative accuracy next to its zero.

`tolerance` asks for fewer nodes where fewer do. The interval in Y already measures the angle that the segment subtends
at the light, in units of what the phase function resolves, and is known before the first node; with a share of the
optical depth it decides (`RationalMap.difficulty`). Gauss-Legendre rules of 1, 2, 3 ... nodes serve up to a threshold
each, and what is above the last gets a tuned rule. On pieces between shadows that takes 1.9, 2.6, 2.9 and 4.8 nodes on
average for 1e-2, 1e-3, 1e-4 and 1e-6 (isotropic), over the whole domain 2.9, 4.0, 5.3 and 12.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from analytic.models.model import AirlightModel
from analytic.models.rational_map import RationalMap, RationalRule, lobe_ratio
from analytic.models.rational_rules import RULES
from analytic.phase import Phase
from analytic.segments import Segments

__all__ = ["MODEL", "TOLERANCES", "nodes_needed", "quadrature_float32"]

DEFAULT_NODES = 24
# u beyond this multiple of 1 + |u_a| is left out: below rounding in float32
LARGEST_RATIO = 1e9
# tolerance -> (nodes of the tuned rule, {nodes of a Gauss-Legendre rule: largest difficulty that it serves}), made by
# `python -m experiments.quadrature.thresholds`
TOLERANCES: dict[float, tuple[int, dict[int, float]]] = {
    1e-2: (5, {1: 0.00484, 2: 0.0216, 3: 0.058, 4: 0.126}),
    1e-3: (7, {1: 0.00121, 2: 0.0095, 3: 0.0189, 4: 0.035, 6: 0.123}),
    1e-4: (10, {1: 0.000698, 2: 0.0113, 3: 0.0241, 4: 0.0461, 6: 0.101, 8: 0.159}),
    1e-6: (24, {1: 6.75e-05, 2: 0.00261, 3: 0.00982, 4: 0.0173, 6: 0.0446, 8: 0.0632, 12: 0.147}),
}


def quadrature_float32(
    segments: Segments, phase: Phase, *, nodes: int | None = None, tolerance: float | None = None
) -> NDArray[np.floating]:
    """Airlight of unit intensity and unit scattering coefficient.

    Parameters
    ----------
    segments : Segments, (n,)    of float32; float64 shows the rule without the rounding
    phase : Phase                phase function
    nodes : int, optional        how many, a key of `RULES`; 24 if nothing is said
    tolerance : float, optional  a key of `TOLERANCES`, instead of `nodes`: for each segment as few as keep that
        relative error

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Raises
    ------
    ValueError
        If nodes or tolerance is not one of those, or both are given.

    Source: Weng 2010, Eq. 18, repaired; the map, the nodes and the thresholds are this project's.
    """
    rules, thresholds = _rules(nodes, tolerance)
    integral = np.zeros_like(segments.h)
    for part, skipped, mapping in pieces(segments, phase, rules[-1]):
        value = np.empty_like(skipped)
        which = np.searchsorted(thresholds, mapping.difficulty)
        for number, rule in enumerate(rules):
            mine = which == number
            value[mine] = mapping[mine].integral(phase, rule)
        integral[part] += np.exp(-segments.optical_h[part] * skipped) * value
    d_a = segments.h * _root(segments.x_a / segments.h)
    return integral / segments.h * np.exp(-segments.sigma_t * d_a)


def nodes_needed(segments: Segments, phase: Phase, tolerance: float) -> NDArray[np.intp]:
    """How many nodes `quadrature_float32` spends on each segment for a tolerance, (n,)."""
    rules, thresholds = _rules(None, tolerance)
    counts = np.array([len(rule.nodes) for rule in rules])
    needed = np.zeros(len(segments), dtype=np.intp)
    for part, _, mapping in pieces(segments, phase, rules[-1]):
        needed[part] += counts[np.searchsorted(thresholds, mapping.difficulty)]
    return needed


def _rules(nodes: int | None, tolerance: float | None) -> tuple[list[RationalRule], list[float]]:
    """The rules to choose from, and the largest difficulty for all but the last one."""
    if tolerance is None:
        wanted = DEFAULT_NODES if nodes is None else nodes
        if wanted not in tuple(RULES):
            raise ValueError(f"nodes must be one of {', '.join(map(str, RULES))}: {nodes}")
        return [RULES[wanted]], []
    if nodes is not None:
        raise ValueError("nodes must be left out where a tolerance is given")
    if tolerance not in tuple(TOLERANCES):
        raise ValueError(f"tolerance must be one of {', '.join(f'{key:g}' for key in TOLERANCES)}: {tolerance}")
    largest, thresholds = TOLERANCES[tolerance]
    tuned = RULES[largest]
    # under the map of the tuned rule
    plain = [RationalRule(*gauss_legendre(count), tuned.clip, tuned.q) for count in thresholds]
    return [*plain, tuned], list(thresholds.values())


def gauss_legendre(count: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Nodes and weights on [0, 1]."""
    x, weights = np.polynomial.legendre.leggauss(count)
    return tuple(((x + 1) / 2).tolist()), tuple((weights / 2).tolist())


def pieces(
    segments: Segments, phase: Phase, rule: RationalRule
) -> Iterator[tuple[NDArray[np.bool_], NDArray[np.floating], RationalMap]]:
    """For each interval between two kinks: which segments reach it, v - v_a where their piece begins, and its map."""
    cosines = np.asarray(phase.kinks)[::-1]
    edges = [-np.inf, *(-cosines / np.sqrt((1 - cosines) * (1 + cosines))).tolist(), np.inf]
    scale = rule.q * lobe_ratio(phase)
    u_a, length = segments.x_a / segments.h, segments.length / segments.h
    far = LARGEST_RATIO * (1 + np.abs(u_a))
    u_b, length = np.minimum(segments.x_b / segments.h, far), np.minimum(length, far)
    for low, high in itertools.pairwise(edges):
        # lengths from u_a on, for the difference of two places would forget what a short segment's length is
        before, behind = np.maximum(low - u_a, 0), np.minimum(high - u_a, length)
        part = before < behind
        before, du = before[part], (behind - before)[part]
        start, end = np.maximum(u_a[part], low), np.minimum(u_b[part], high)
        skipped = before * _slope(u_a[part], start)
        mapping = RationalMap.of(_v(start), du * _slope(start, end), segments.optical_h[part], scale, rule.clip)
        yield part, skipped, mapping


def _slope(u_0: NDArray[np.floating], u_1: NDArray[np.floating]) -> NDArray[np.floating]:
    """(v_1 - v_0) / (u_1 - u_0), (n,), without a difference."""
    return (_v(u_0) + _v(u_1)) / (_root(u_0) + _root(u_1))


def _root(u: NDArray[np.floating]) -> NDArray[np.floating]:
    return np.sqrt(1 + u * u)


def _v(u: NDArray[np.floating]) -> NDArray[np.floating]:
    """V = u + sqrt(1 + u^2), (n,), divided out where it would cancel."""
    root = _root(u)
    return np.where(u < 0, 1 / (root + np.abs(u)), root + u)


MODEL = AirlightModel(
    name="quadrature_float32",
    function=quadrature_float32,
    citation="Weng 2010, Eq. 18, repaired; tuned nodes under the map v = q (X^2 - 1)",
    domain="every phase function; up to 0.9 in float32 1.3e-5 with 12 nodes, 2.0e-6 with 24; hg 0.99: 1.2e-5 with 12",
    cost="`nodes` (24) exponentials and the phase function at each; 5 square roots and 1 exponential besides",
)
