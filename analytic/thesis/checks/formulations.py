"""Eqs. 18 to 29 against the oracle."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from mpmath import mp, mpf

from analytic.thesis import first_formulation as first
from analytic.thesis import second_formulation as second
from analytic.thesis.checks.entry import CLOSED_FORM_DIGITS, Entry, conclude, largest, relative, shown
from analytic.thesis.checks.parameters import ISOTROPIC, SEGMENTS, airlight, powers_of_v, powers_of_w, with_phases
from analytic.thesis.checks.series import in_short, what_the_series_does
from analytic.thesis.segment import Segment

__all__ = ["CHECKS", "C_N", "D_N"]

PREFACTOR = "the prefactor is e^(kappa_t (x_a - x_h))"
# a phase function that *is* a polynomial in v, or in w = -1 / v: the algebra is judged, and nothing is cut off.
# Six terms, so that both parities of n and both signs of (-1)^{n % 4 / 2} occur beside sums of one to three terms.
C_N = tuple(mpf(1) / k for k in (8, 16, 32, 40, 48, 64))
D_N = tuple((-1) ** n * c for n, c in enumerate(C_N))
HIGHEST_POWER = 7
TENTH = mpf("0.1")
ALL = slice(None)


def _over_phases(printed: Any, repaired: Any) -> tuple[Any, Any]:
    """Residuals of an equation that takes any phase function."""
    pairs = [(segment, p.of_cosine, airlight(segment, p.exact)) for segment, p in with_phases()]
    return (
        largest(relative(printed(segment, function), truth) for segment, function, truth in pairs),
        largest(relative(repaired(segment, function), truth) for segment, function, truth in pairs),
    )


def _over_segments(printed: Any, repaired: Any, phase: Any, *coefficients: Any) -> tuple[Any, Any]:
    """Residuals of an equation of one phase function."""
    pairs = [(segment, airlight(segment, phase)) for segment in SEGMENTS]
    return (
        largest(relative(printed(segment, *coefficients), truth) for segment, truth in pairs),
        largest(relative(repaired(segment, *coefficients), truth) for segment, truth in pairs),
    )


def _in_closed_form(printed: Any, repaired: Any, phase: Any, *coefficients: Any) -> tuple[Any, Any]:
    """The same with the digits that differences of exponential integrals need."""
    with mp.workdps(CLOSED_FORM_DIGITS):
        return _over_segments(printed, repaired, phase, *coefficients)


def _prefactor(equation: str, residuals: tuple[Any, Any], extra: str = "", slip: str = PREFACTOR) -> Entry:
    printed, repaired = residuals
    text = (
        f"Off by up to {shown(printed)} over {len(SEGMENTS)} segments, most where the light's projection lies behind "
        f"the end; {shown(repaired)} is left with Eq. 17's prefactor.{extra}"
    )
    return conclude(equation, printed, text, repaired, slip)


def _antiderivative(
    closed: Callable[[Any, Any], Any],
    sign: int,
    place: Callable[[Segment, Any], Any],
    phase: Any,
    every: slice,
    sign_of_power: int = 1,
) -> Any:
    """Largest relative error of a difference of `closed` from the integral that the oracle gives.

    Parameters
    ----------
    closed : callable of a = sign H and a position v or w
    sign : int
    place : callable   `Segment.v` or `Segment.w`
    phase : ExactPhase the absolute value of the power of v or w beside the exponential
    every : slice      which segments
    sign_of_power : int
    """

    def error(segment: Segment) -> Any:
        a, start, end = sign * segment.H, place(segment, segment.x_a), place(segment, segment.x_b)
        truth = sign_of_power * airlight(segment, phase) / (2 * first.prefactor_repaired(segment))
        return relative(closed(a, end) - closed(a, start), truth)

    with mp.workdps(CLOSED_FORM_DIGITS):
        return largest(error(segment) for segment in SEGMENTS[every])


def _power_of_v(n: int) -> Any:
    return powers_of_v([mpf(k == n) for k in range(n + 1)])


def _power_of_w(n: int) -> Any:
    """(-1)^n w^n, which is positive."""
    return powers_of_w([(-1) ** n * mpf(k == n) for k in range(n + 1)])


def equation_18() -> Entry:
    """The integral over v."""
    return _prefactor("18", _over_phases(first.eq_18_printed, first.eq_18_repaired))


def equation_19() -> Entry:
    """The isotropic integral over v."""
    return _prefactor("19", _over_segments(first.eq_19_printed, first.eq_19_repaired, ISOTROPIC.exact))


def equation_20() -> Entry:
    """The antiderivative i_0."""
    error = _antiderivative(first.i_0, -1, Segment.v, _power_of_v(0), ALL)
    return conclude("20", error, f"Differences of i_0 are the oracle's integral within {shown(error)}.")


def equation_21() -> Entry:
    """The isotropic closed form."""
    return _prefactor("21", _in_closed_form(first.eq_21_printed, first.eq_21_repaired, ISOTROPIC.exact))


def equation_22() -> Entry:
    """The integral over v of a polynomial."""
    residuals = _over_segments(first.eq_22_printed, first.eq_22_repaired, powers_of_v(C_N), C_N)
    extra = f" Measured with a phase function that is a polynomial of {len(C_N)} terms in v. {what_the_series_does()}"
    return _prefactor("22", residuals, extra, PREFACTOR + ", and kappa_i is kappa_t")


def equation_23() -> Entry:
    """The antiderivatives i_1 and of higher powers."""
    by_i_1 = _antiderivative(first.i_1, -1, Segment.v, _power_of_v(1), ALL)
    error = largest(
        _antiderivative(partial(first.eq_23, n), -1, Segment.v, _power_of_v(n), slice(n % 4, None, 4))
        for n in range(HIGHEST_POWER + 1)
    )
    return conclude(
        "23",
        max(by_i_1, error),
        f"Differences of i_1 are the oracle's integral within {shown(by_i_1)}, those of the powers 0 to "
        f"{HIGHEST_POWER} within {shown(error)}, if the upper-case I is read as i: I takes two limits.",
    )


def equation_24() -> Entry:
    """The closed form of a polynomial in v."""
    residuals = _in_closed_form(first.eq_24_printed, first.eq_24_repaired, powers_of_v(C_N), C_N)
    extra = (
        f" Measured with a polynomial of {len(C_N)} terms in v. At H = 0.1 c(-H, 0, 8) is "
        f"{shown(first.c(-TENTH, 0, 8))}, which the terms of both ends have to cancel. {in_short()}"
    )
    return _prefactor("24", residuals, extra, PREFACTOR + ", and kappa_i is kappa_t")


def equation_25() -> Entry:
    """The integral over w."""
    return _prefactor("25", _over_phases(second.eq_25_printed, second.eq_25_repaired))


def equation_26() -> Entry:
    """The antiderivatives j_0 and j_1."""
    by_j_0 = _antiderivative(second.j_0, 1, Segment.w, _power_of_w(0), ALL)
    by_j_1 = _antiderivative(second.j_1, 1, Segment.w, _power_of_w(1), ALL, -1)
    return conclude(
        "26",
        max(by_j_0, by_j_1),
        f"Differences of j_0 and j_1 are the oracle's integrals within {shown(by_j_0)} and {shown(by_j_1)}.",
    )


def equation_27() -> Entry:
    """The isotropic closed form in w."""
    printed, repaired = _in_closed_form(second.eq_27_printed, second.eq_27_repaired, ISOTROPIC.exact)
    with mp.workdps(CLOSED_FORM_DIGITS):
        sign_alone = largest(
            relative(second.eq_27_printed(s) * first.prefactor_repaired(s) / first.prefactor_printed(s), truth)
            for s, truth in ((segment, airlight(segment, ISOTROPIC.exact)) for segment in SEGMENTS)
        )
    return conclude(
        "27",
        printed,
        f"Off by up to {shown(printed)} over {len(SEGMENTS)} segments: Eq. 25 holds e^(H/w), so a = H, and J_0(-H, "
        f"...) integrates e^(-H/w), which grows; with the prefactor mended alone it is still off by up to "
        f"{shown(sign_alone)}, with J_0(H, ...) too {shown(repaired)} is left.",
        repaired,
        PREFACTOR + ", and J_0 is that of +H",
    )


def equation_28() -> Entry:
    """The antiderivatives of higher powers of w."""
    error = largest(
        _antiderivative(partial(second.eq_28, n), 1, Segment.w, _power_of_w(n), slice(n % 4, None, 4), (-1) ** n)
        for n in range(HIGHEST_POWER + 1)
    )
    return conclude(
        "28",
        error,
        f"Differences for the powers 0 to {HIGHEST_POWER} are the oracle's integral within {shown(error)}; the last "
        "term belongs to n >= 2 alone.",
    )


def equation_29() -> Entry:
    """The closed form of a polynomial in w."""
    printed, repaired = _in_closed_form(second.eq_29_printed, second.eq_29_repaired, powers_of_w(D_N), D_N)
    return conclude(
        "29",
        printed,
        f"Off by up to {mp.nstr(printed, 2)} over {len(SEGMENTS)} segments: w^(j+1) is printed inside the exponent of "
        f"e^(H/w). With e^(H/w) w^(j+1) {shown(repaired)} is left; the prefactor, e^(kappa_t (x_a - x_h)), is right "
        f"here. Measured with a polynomial of {len(D_N)} terms in w. {in_short()}",
        repaired,
        "w^(j+1) stands beside e^(H/w), not in its exponent",
    )


CHECKS = (
    equation_18,
    equation_19,
    equation_20,
    equation_21,
    equation_22,
    equation_23,
    equation_24,
    equation_25,
    equation_26,
    equation_27,
    equation_28,
    equation_29,
)
