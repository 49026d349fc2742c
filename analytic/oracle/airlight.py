"""The airlight of one segment, its error bounded; the proof is the package's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from mpmath import libmp, mp, mpf

from analytic.inputs import real_number, whole_number
from analytic.oracle.gauss import gauss_legendre
from analytic.oracle.integrands import BehindTheLight, BesideTheLight, Integrand
from analytic.oracle.panels import LOG_SLACK, log_estimate, log_tail, negligible_from, panels
from analytic.oracle.phases import ExactPhase, exact_phase

__all__ = ["Exact", "exact_airlight"]

# more nodes a panel, fewer panels: 0.5, 0.8, 1 and 1.2 take 7.4, 4.9, 5.2 and 5.9 ms at 30 digits (150 drawn segments)
NODES_A_DIGIT = 1.0
FEWEST_NODES = 8
ROUNDINGS = 100
# each may double the digits
TRIALS = 8
# of depth from the eye to the light; the bounds of the panels are float64
DEEPEST = 1e300


@dataclass(frozen=True)
class Exact:
    """`value`: L / (I sigma_s), an mpf; `bound`: at least the absolute error of it, an mpf."""

    value: Any
    bound: Any


def exact_airlight(h: Any, x_a: Any, x_b: Any, sigma_t: Any, phase: Any, digits: int = 30) -> Exact:
    """L / (I sigma_s) of one segment, to `digits` significant digits.

    Parameters
    ----------
    h : float, int or mpf   distance of the light from the ray [scene unit]; each number is taken as exactly what it is
    x_a, x_b : float, int or mpf  ends of the segment on the ray, relative to the light's projection, the eye at x_a;
        x_b may be inf
    sigma_t : float, int or mpf   extinction coefficient [1 / scene unit]
    phase : Phase or ExactPhase  of `analytic.phase`, or one with its own bound
    digits : int            significant digits, 1 or more

    Returns
    -------
    Exact  with `bound <= 10^-digits value` [both 1 / (sr scene unit)]

    Raises
    ------
    ValueError
        If an argument is no number, or NaN, negative or infinite where it must not be, x_b < x_a, the segment is not
        empty and holds the light, or sigma_t (|x_a| + h) is above 1e300.
    ArithmeticError
        If the bound stays too large.

    Source: Weng 2010, L_m of Eq. 16; the substitution and the proof are this module's.
    """
    h, sigma_t = _exact_number("h", h), _exact_number("sigma_t", sigma_t)
    x_a, x_b = _exact_number("x_a", x_a), _exact_number("x_b", x_b)
    digits = whole_number("digits", digits, 1)
    _check(h, x_a, x_b, sigma_t)
    if x_a == x_b:
        return Exact(mpf(0), mpf(0))
    with mp.workdps(15):
        depth = sigma_t * (abs(x_a) + h)
        if depth > DEEPEST:
            raise ValueError(f"sigma_t must not make an optical depth above {DEEPEST:g}: {sigma_t}")
        length = x_b - x_a
        share = length / (abs(x_a) + h + length) if mp.isfinite(length) else mpf(1)
        working = digits + 6 + int(mp.log10(1 + depth) - mp.log10(share))
    aim = digits + 1
    for _ in range(TRIALS):
        # rounded up, so that few sets of Gauss nodes are made
        with mp.workdps(10 * math.ceil(working / 10)):
            value, truncation, rounding = _evaluate(h, x_a, x_b, sigma_t, phase, aim)
            allowed = value * mpf(10) ** -digits
            if truncation + rounding <= allowed:
                return Exact(value, truncation + rounding)
            aim += _lacking(truncation, allowed, aim)
            working += _lacking(rounding, allowed, working)
    raise ArithmeticError(f"{digits} digits are out of reach for h={h}, x_a={x_a}, x_b={x_b}, sigma_t={sigma_t}")


def _exact_number(name: str, value: Any) -> Any:
    """An mpf of exactly that value, whatever mpmath's present precision is."""
    if isinstance(value, mpf):
        return mp.make_mpf(value._mpf_)
    if type(value) is int:
        return mp.make_mpf(libmp.from_int(value))
    return mp.make_mpf(libmp.from_float(real_number(name, value)))


def _check(h: Any, x_a: Any, x_b: Any, sigma_t: Any) -> None:
    for name, value in (("h", h), ("sigma_t", sigma_t)):
        if not (value >= 0 and mp.isfinite(value)):
            raise ValueError(f"{name} must be finite and not negative: {value}")
    if not mp.isfinite(x_a):
        raise ValueError(f"x_a must be finite: {x_a}")
    if not x_b >= x_a:
        raise ValueError(f"x_b must not be NaN or below x_a: {x_b}")
    if h == 0 and x_a <= 0 <= x_b and x_a < x_b:
        raise ValueError("h must not be 0 where the segment holds the light: there the airlight is infinite")


def _lacking(error: Any, allowed: Any, digits: int) -> int:
    """How many more digits bring an error below half of what is allowed: none, or at most as many again."""
    if 2 * error <= allowed:
        return 0
    # a value that is no larger than its error says little about what is allowed
    return min(digits, 1 + math.ceil(mp.log10(2 * error / allowed))) if allowed > 0 else digits


def _evaluate(h: Any, x_a: Any, x_b: Any, sigma_t: Any, phase: Any, digits: int) -> tuple[Any, Any, Any]:
    """The airlight, with bounds of its truncation, which aims at `digits`, and of its rounding at this precision."""
    exact = phase if isinstance(phase, ExactPhase) else exact_phase(phase)
    if h > 0:
        return _integrate(BesideTheLight(h, x_a, x_b, sigma_t, exact), digits)
    if x_a > 0:
        return _integrate(BehindTheLight(x_a, x_b, sigma_t, exact), digits)
    return _before_the_light(x_a, x_b, sigma_t, exact)


def _before_the_light(x_a: Any, x_b: Any, sigma_t: Any, phase: ExactPhase) -> tuple[Any, Any, Any]:
    """The case h = 0, x_b < 0: p(1) e^{-sigma_t |x_a|} (x_b - x_a) / (x_a x_b)."""
    forward = phase.pieces[0]
    common = mp.exp(sigma_t * x_a) * (x_b - x_a) / (x_a * x_b)
    rounding = ROUNDINGS * (1 - sigma_t * x_a) * mp.eps * common * forward.size(1, 0)
    return common * forward.value(1, 0), mpf(0), rounding


def _integrate(integrand: Integrand, digits: int) -> tuple[Any, Any, Any]:
    """The sum of the panels, each cut so finely that its truncation is small beside 10^-digits of the whole."""
    pieces = list(integrand.pieces())
    log_goal = log_estimate(integrand, pieces) - digits * math.log(10) - math.log(len(pieces))
    nodes = gauss_legendre(int(NODES_A_DIGIT * digits) + FEWEST_NODES, mp.prec)
    total = size = truncation = largest = last = mpf(0)
    count = 0
    for low, high, piece in pieces:
        far = negligible_from(integrand, piece, low, high, log_goal)
        if far < high:
            truncation += mp.exp(log_tail(integrand, piece, float(far), float(high)) + LOG_SLACK)
        for start, end, log_error, log_largest in panels(integrand, piece, low, far, log_goal, len(nodes)):
            truncation += mp.exp(log_error + LOG_SLACK)
            largest, last = max(largest, mp.exp(log_largest + LOG_SLACK)), end
            middle, half = (start + end) / 2, (end - start) / 2
            for node, weight in nodes:
                growth = mp.exp(middle + half * node)
                dimmed = half * weight * mp.exp(integrand.rate * (1 - growth))
                value, terms = integrand.factor(growth, piece)
                total += dimmed * value
                size += dimmed * terms
            count += len(nodes)
    depth = integrand.rate * mp.exp(last) + integrand.depth_at_eye
    roundings = (ROUNDINGS * (1 + last) * (1 + depth) + count) * size
    roundings += 8 * (len(pieces) + 1) * (1 + abs(integrand.start) + last) * largest
    common = integrand.prefactor
    return common * total, common * truncation, common * roundings * mp.eps
