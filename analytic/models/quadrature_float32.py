"""Airlight by a few tuned nodes under a rational map: what a shader needs to be accurate to float32, for any phase.

With v = tan(theta / 2), H = sigma_t h and d_a the light's distance from the eye (Weng 2010, Eq. 18, repaired)

    L = I sigma_s / h e^{-sigma_t d_a} int_{v_a}^{v_b} e^{-H (v - v_a)} p(cos theta) 2 / (1 + v^2) dv,

summed at the nodes of `rational_rules` in the variable of `rational_map`. Every difference is a product, so nothing
cancels in float32. A phase function with kinks, a table, is cut at each of them.

Worst relative error over H 1e-4 .. 50, optical positions -50 .. 50, lengths from 1e-7 to infinite, with isotropic,
Rayleigh, and HG, Schlick and Cornette-Shanks from -0.9 to 0.9 in steps of 0.1 (float64, 30,000 held-out segments; a
climb from the worst of others finds 3.3e-6, 2.6e-6 and 6.2e-7 with 14, 16 and 24 nodes, and with fewer no more than
here). The worst are Cornette-Shanks at 0.8 and from -0.1 to -0.3. Beside it, sharper lobes; cs: Cornette-Shanks.

=====  =======  =======  =======  ========  ========  =======
nodes  to 0.9   hg 0.95  hg 0.99  hg -0.99  cs -0.99  float32
=====  =======  =======  =======  ========  ========  =======
5      7.0e-3   1.3e-2   6.2e-2   1.6e-2    1.6e-2
6      2.1e-3   2.3e-3   1.6e-2   9.1e-3    9.2e-3
7      1.1e-3   1.4e-3   8.0e-3   2.6e-3    2.5e-3
8      5.1e-4   4.8e-4   1.2e-3   2.2e-3    3.9e-3
9      1.5e-4   1.5e-4   4.3e-4   7.5e-4    3.0e-3
10     6.1e-5   6.3e-5   1.5e-4   3.5e-4    2.8e-3    6.2e-5
12     1.8e-5   1.8e-5   1.2e-5   1.2e-4    1.8e-3    1.9e-5
14     3.1e-6   1.7e-6   2.8e-6   2.4e-5    6.2e-4
16     2.3e-6   1.5e-6   2.4e-6   8.9e-6    3.8e-4    2.4e-6
24     5.3e-7   3.7e-7   4.4e-7   1.4e-6    7.1e-5    1.01e-6
=====  =======  =======  =======  ========  ========  =======

So `hg` 0.99 keeps 1e-4 from 12 nodes on, -0.99 from 14 on, and Cornette-Shanks at -0.99 with 24 alone. The last column
is the whole result in float32 over 50,000 visible segments (optical depth to the near end at most 12); `light_factor`
keeps its exponent from adding to it, and beyond, up to a depth of 71, 24 nodes are off by 8.8e-7 wherever float32 holds
the result with all its digits. With a table the rules are as accurate, 7.0e-7 with 24 nodes in float64; in float32
there is no relative accuracy next to its zero, and 181 or 1801 values of `hg` 0.9 give 1.9e-6 or 9.2e-6, cos theta
being rounded.

h may be anything above 0: below 1e-12 of the distance to a segment beside the light it is raised to that, and where the
result is larger than the type holds it is inf.

`tolerance` asks for fewer nodes where fewer do. The interval in Y already measures the angle that the segment subtends
at the light, in units of what the phase function resolves, and is known before the first node; with a share of the
optical depth it decides (`RationalMap.difficulty`). Gauss-Legendre rules of 1, 2, 3 ... nodes serve up to a threshold
each, and what is above the last gets a tuned rule. It is kept in float64 for lobes up to +-0.9 and for tables; beyond
0.9 it is refused. A climb for the worst found 0.70, 0.51, 0.64 and 0.77 of 1e-2, 1e-3, 1e-4 and 1e-6; float32 adds some
1e-6 of its own. On pieces between shadows it takes 1.9, 2.5, 2.9 and 4.6 nodes on average, over the whole domain 2.9,
4.2, 5.1 and 11.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from analytic.gauss_legendre import gauss_legendre
from analytic.inputs import real_number
from analytic.kinks import cut, kinks_along_ray
from analytic.models.light_factor import light_factor
from analytic.models.model import AirlightModel
from analytic.models.rational_map import RationalMap, RationalRule, lobe_ratio
from analytic.models.rational_rules import RULES
from analytic.phase import Phase
from analytic.phases.tabulated import Tabulated
from analytic.segments import Segments

__all__ = ["MODEL", "TOLERANCES", "nodes_needed", "quadrature_float32"]

DEFAULT_NODES = 24
# u beyond this multiple of 1 + u_a is left out: below rounding in float32
LARGEST_RATIO = 1e9
# so far before the light v is 0, and the length of the way there nothing but a number that must not overflow
FARTHEST = 1e30
# of the distance between a segment and the light's projection: h below it changes nothing, and v^2 stays in range
NEGLIGIBLE = 1e-12
SHARPEST = 0.9  # |g| or |k| for which `TOLERANCES` were made
# tolerance -> (nodes of the tuned rule, {nodes of a Gauss-Legendre rule: largest difficulty that it serves}, the same
# with a table), made by `python -m experiments.quadrature.thresholds`
TOLERANCES: dict[float, tuple[int, dict[int, float], dict[int, float]]] = {
    0.01: (5, {1: 0.00317, 2: 0.0198, 3: 0.0529, 4: 0.103}, {2: 0.0151, 3: 0.0446, 4: 0.0844}),
    0.001: (8, {1: 0.00101, 2: 0.0123, 3: 0.0332, 4: 0.0619, 6: 0.158}, {2: 0.00704, 3: 0.0272, 4: 0.0559, 6: 0.0996}),
    0.0001: (
        10,
        {1: 0.000316, 2: 0.00686, 3: 0.0224, 4: 0.0467, 6: 0.106, 8: 0.206},
        {2: 0.00326, 3: 0.0169, 4: 0.0398, 6: 0.11, 8: 0.124},
    ),
    1e-06: (
        24,
        {1: 3.12e-05, 2: 0.00201, 3: 0.00681, 4: 0.016, 6: 0.0398, 8: 0.0748, 12: 0.192},
        {2: 0.000851, 3: 0.00688, 4: 0.0202, 6: 0.0683, 8: 0.14, 12: 0.174},
    ),
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
    tolerance : float, optional  a key of `TOLERANCES`, in any type, instead of `nodes`: for each segment as few as keep
        that relative error; for lobes up to |g| or |k| = 0.9, and tables

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Raises
    ------
    ValueError
        If nodes or tolerance is not one of those, both are given, or tolerance with a sharper lobe.

    Source: Weng 2010, Eq. 18, repaired; the map, the nodes and the thresholds are this project's.
    """
    rules, thresholds = _rules(phase, nodes, tolerance)
    integral, h = np.zeros_like(segments.h), segments.beside_light(NEGLIGIBLE).h
    for owner, skipped, mapping in pieces(segments, phase, rules[-1]):
        value = np.empty_like(mapping.v_a)
        which = np.searchsorted(thresholds, mapping.difficulty)
        for number, rule in enumerate(rules):
            mine = which == number
            if mine.any():
                value[mine] = mapping[mine].integral(phase, rule)
        if skipped is not None:
            value = np.exp(-mapping.optical_h * skipped) * value
        np.add.at(integral, owner, value)
    with np.errstate(over="ignore"):  # almost through the light
        return integral / h * light_factor(segments.h, segments.x_a, segments.sigma_t)


def nodes_needed(segments: Segments, phase: Phase, tolerance: float) -> NDArray[np.intp]:
    """How many nodes `quadrature_float32` spends on each segment for a tolerance, (n,)."""
    rules, thresholds = _rules(phase, None, tolerance)
    counts = np.array([len(rule.nodes) for rule in rules])
    needed = np.zeros(len(segments), dtype=np.intp)
    for owner, _, mapping in pieces(segments, phase, rules[-1]):
        np.add.at(needed, owner, counts[np.searchsorted(thresholds, mapping.difficulty)])
    return needed


def _rules(phase: Phase, nodes: int | None, tolerance: float | None) -> tuple[list[RationalRule], list[float]]:
    """The rules to choose from, and the largest difficulty for all but the last one."""
    if tolerance is None:
        wanted = DEFAULT_NODES if nodes is None else nodes
        if wanted not in tuple(RULES):
            raise ValueError(f"nodes must be one of {', '.join(map(str, RULES))}: {nodes}")
        return [RULES[wanted]], []
    if nodes is not None:
        raise ValueError("nodes must be left out where a tolerance is given")
    given = real_number("tolerance", tolerance)
    # float32 holds none of them
    kept = next((key for key in TOLERANCES if math.isclose(key, given, rel_tol=1e-6)), None)
    if kept is None:
        raise ValueError(f"tolerance must be one of {', '.join(f'{key:g}' for key in TOLERANCES)}: {tolerance}")
    if abs(getattr(phase, "g", getattr(phase, "k", 0.0))) > SHARPEST:
        raise ValueError(f"tolerance must be left out for lobes sharper than {SHARPEST}, give nodes: {phase}")
    largest, smooth, linear = TOLERANCES[kept]
    tuned, thresholds = RULES[largest], linear if isinstance(phase, Tabulated) else smooth
    # under the map of the tuned rule
    plain = [RationalRule(*gauss_legendre(count), tuned.clip, tuned.q) for count in thresholds]
    return [*plain, tuned], list(thresholds.values())


def pieces(
    segments: Segments, phase: Phase, rule: RationalRule
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.floating] | None, RationalMap]]:
    """The pieces between two kinks, some thousands at a time.

    Yields
    ------
    owner : ndarray, (m,)            the segment that each piece belongs to
    skipped : ndarray, (m,) or None  v - v_a where the piece begins; None where no segment is cut
    mapping : RationalMap            of the m pieces
    """
    h, scale = segments.beside_light(NEGLIGIBLE).h, rule.q * lobe_ratio(phase)
    with np.errstate(over="ignore"):
        u_a, u_b, length = segments.x_a / h, segments.x_b / h, segments.length / h
    # v is next to 0 beyond the one, and nothing is left beyond the other
    u_a, far = np.maximum(u_a, -FARTHEST), LARGEST_RATIO * (1 + np.maximum(u_a, 0))
    u_b, length = np.minimum(u_b, far), np.minimum(length, far - u_a)
    optical_h = segments.sigma_t * h
    if not phase.kinks:
        span = length * _slope(u_a, u_b)
        yield np.arange(u_a.size), None, RationalMap.of(_v(u_a), span, optical_h, scale, rule.clip)
        return
    exact_kinks = kinks_along_ray(phase)
    # the gap behind each kink, before it is rounded; the last one is never asked for
    kinks, gaps = exact_kinks.astype(u_a.dtype), np.diff(exact_kinks, append=np.inf).astype(u_a.dtype)
    for part in cut(kinks, u_a, u_b):
        owner, before, behind = part.owner, kinks[part.before], kinks[part.behind]
        whole = length[owner]
        begin = np.where(part.is_first, 0, np.minimum(before - u_a[owner], whole))
        # the difference of two places would forget what a short segment's length is; that of two long lengths, where
        # the end is
        rest = np.where(np.abs(u_b[owner]) < whole, u_b[owner] - before, whole - begin)
        rest = np.where(part.is_first, whole, np.maximum(rest, 0))
        du = np.where(part.is_last, rest, np.where(part.is_first, behind - u_a[owner], gaps[part.before]))
        start, stop = np.where(part.is_first, u_a[owner], before), np.where(part.is_last, u_b[owner], behind)
        mapping = RationalMap.of(_v(start), du * _slope(start, stop), optical_h[owner], scale, rule.clip)
        yield owner, begin * _slope(u_a[owner], start), mapping


def _slope(u_0: NDArray[np.floating], u_1: NDArray[np.floating]) -> NDArray[np.floating]:
    """(v_1 - v_0) / (u_1 - u_0), (n,), without a difference."""
    return (_v(u_0) + _v(u_1)) / (_root(u_0) + _root(u_1))


def _root(u: NDArray[np.floating]) -> NDArray[np.floating]:
    return np.hypot(1, u)


def _v(u: NDArray[np.floating]) -> NDArray[np.floating]:
    """V = u + sqrt(1 + u^2), (n,), divided out where it would cancel."""
    root = _root(u)
    return np.where(u < 0, 1 / (root + np.abs(u)), root + u)


MODEL = AirlightModel(
    name="quadrature_float32",
    function=quadrature_float32,
    citation="Weng 2010, Eq. 18, repaired; tuned nodes under the map v = q (X^2 - 1)",
    domain="every phase function; up to +-0.9 in float32 1.9e-5 with 12 nodes, 1.0e-6 with 24 (visible segments); with "
    "12 nodes hg 0.99 1.2e-5, hg -0.99 1.2e-4, cornette_shanks -0.99 1.8e-3",
    cost="`nodes` (24) exponentials and the phase function at each, times the pieces between kinks; 5 square roots and "
    "1 exponential, 4 and 1 more for each further piece",
)
