"""The airlight of one segment, its error bounded; the proof is the package's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from mpmath import mp, mpf

from analytic.oracle.gauss import gauss_legendre
from analytic.oracle.integrands import BehindTheLight, BesideTheLight, Integrand
from analytic.oracle.panels import LOG_SLACK, log_estimate, log_tail, negligible_from, panels
from analytic.oracle.phases import ExactPhase, exact_phase

__all__ = ["Exact", "exact_airlight"]

# more nodes a panel, fewer panels: 0.5, 0.8, 1 and 1.2 take 27, 18, 18 and 16 ms at 30 digits (150 drawn segments)
NODES_A_DIGIT = 1.0
FEWEST_NODES = 8
ROUNDINGS = 100
TRIALS = 6


@dataclass(frozen=True)
class Exact:
    """`value`: L / (I sigma_s), an mpf; `bound`: at least the absolute error of it, an mpf."""

    value: Any
    bound: Any


def exact_airlight(h: Any, x_a: Any, x_b: Any, sigma_t: Any, phase: Any, digits: int = 30) -> Exact:
    """L / (I sigma_s) of one segment, to `digits` significant digits.

    Parameters
    ----------
    h : float or mpf        distance of the light from the ray [scene unit]; each number is taken as exactly what it is
    x_a, x_b : float or mpf ends of the segment on the ray, relative to the light's projection, the eye at x_a; x_b may
        be inf
    sigma_t : float or mpf  extinction coefficient [1 / scene unit]
    phase : Phase or ExactPhase  of `analytic.phase`, or one with its own bound
    digits : int            significant digits, 1 or more

    Returns
    -------
    Exact  with `bound <= 10^-digits value` [both 1 / (sr scene unit)]

    Raises
    ------
    ValueError
        If an argument is NaN, negative or infinite where it must not be, x_b < x_a, or the segment holds the light.
    ArithmeticError
        If the bound stays too large.

    Source: Weng 2010, L_m of Eq. 16; the substitution and the proof are this module's.
    """
    _check(h, x_a, x_b, sigma_t, digits)
    if x_a == x_b:
        return Exact(mpf(0), mpf(0))
    with mp.workdps(15):
        depth = mpf(sigma_t) * (abs(mpf(x_a)) + mpf(h))
        length = mpf(x_b) - x_a
        share = length / (abs(mpf(x_a)) + h + length) if mp.isfinite(length) else mpf(1)
        guard = 6 + int(mp.log10(1 + depth) - mp.log10(share))
    for trial in range(TRIALS):
        more = 10 * trial**2
        # rounded up, so that few sets of Gauss nodes are made
        with mp.workdps(10 * math.ceil((digits + guard + more) / 10)):
            result = _evaluate(h, x_a, x_b, mpf(sigma_t), phase, digits + 1 + more)
            if result.bound <= result.value * mpf(10) ** -digits:
                return result
    raise ArithmeticError(f"{digits} digits are out of reach for h={h}, x_a={x_a}, x_b={x_b}, sigma_t={sigma_t}")


def _evaluate(h: Any, x_a: Any, x_b: Any, sigma_t: Any, phase: Any, digits: int) -> Exact:
    """The airlight with a bound that aims at `digits`, at mpmath's present precision."""
    exact = phase if isinstance(phase, ExactPhase) else exact_phase(phase)
    if h > 0:
        return _integrate(BesideTheLight(mpf(h), mpf(x_a), mpf(x_b), sigma_t, exact), digits)
    if x_a > 0:
        return _integrate(BehindTheLight(mpf(x_a), mpf(x_b), sigma_t, exact), digits)
    return _before_the_light(mpf(x_a), mpf(x_b), sigma_t, exact)


def _check(h: Any, x_a: Any, x_b: Any, sigma_t: Any, digits: int) -> None:
    for name, value in (("h", h), ("sigma_t", sigma_t)):
        if not (value >= 0 and mp.isfinite(value)):
            raise ValueError(f"{name} must be finite and not negative: {value}")
    if not mp.isfinite(x_a):
        raise ValueError(f"x_a must be finite: {x_a}")
    if not x_b >= x_a:
        raise ValueError(f"x_b must not be NaN or below x_a: {x_b}")
    if h == 0 and x_a <= 0 <= x_b:
        raise ValueError("h must not be 0 where the segment holds the light: there the airlight is infinite")
    if digits < 1:
        raise ValueError(f"digits must be 1 or more: {digits}")


def _before_the_light(x_a: Any, x_b: Any, sigma_t: Any, phase: ExactPhase) -> Exact:
    """The case h = 0, x_b < 0: p(1) e^{-sigma_t |x_a|} (x_b - x_a) / (x_a x_b)."""
    forward = phase.pieces[0]
    common = mp.exp(sigma_t * x_a) * (x_b - x_a) / (x_a * x_b)
    return Exact(common * forward.value(1, 0), ROUNDINGS * (1 - sigma_t * x_a) * mp.eps * common * forward.size(1, 0))


def _integrate(integrand: Integrand, digits: int) -> Exact:
    """The sum of the panels, each with a bound that is small beside 10^-digits of the whole."""
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
    return Exact(integrand.prefactor * total, integrand.prefactor * (truncation + roundings * mp.eps))
