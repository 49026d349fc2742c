"""Eqs. 30 to 32 and Figure 4.11 with section 4.4's count, against the oracle and each other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmath import mp, mpf

from analytic.thesis import combined as thesis
from analytic.thesis import first_formulation as first
from analytic.thesis import second_formulation as second
from analytic.thesis.checks.entry import CLOSED_FORM_DIGITS, Entry, conclude, largest, relative, shown
from analytic.thesis.checks.formulations import C_N, D_N
from analytic.thesis.checks.parameters import INSIDE, ISOTROPIC, SEGMENTS, airlight, powers_of_v_and_w
from analytic.thesis.exponential_integral import counted, ei_of_a_fixed_sheet
from analytic.thesis.segment import Segment

__all__ = ["CHECKS"]


def _medium_radiance(segment: Segment) -> Callable[[Any, Any], Any]:
    """L_m of Eq. 16 for an eye at its first argument: the isotropic closed form, Eq. 21 repaired, of any two points."""

    def L_m(eye: Any, end: Any) -> Any:
        return first.eq_21_repaired(Segment(segment.h, segment.x_h, eye, end, segment.kappa_t))

    return L_m


def equation_30() -> Entry:
    """The split at x_h."""
    with mp.workdps(CLOSED_FORM_DIGITS):

        def error(formula: Any) -> Any:
            return largest(
                relative(formula(segment, _medium_radiance(segment)), airlight(segment, ISOTROPIC.exact))
                for segment in SEGMENTS
            )

        by_sum, by_difference = error(thesis.eq_30_printed_sum), error(thesis.eq_30_printed_difference)
        repaired = error(thesis.eq_30_repaired)
    return conclude(
        "30",
        min(by_sum, by_difference),
        f"Eq. 16's first argument is the eye, so the pieces are seen from x_h: the sum is off by up to "
        f"{shown(by_sum)}, the difference by up to {shown(by_difference)} over {len(SEGMENTS)} segments; with the "
        f"transmittance e^(kappa_t (x_a - x_h)) before the difference {shown(repaired)} is left.",
        repaired,
        "the pieces lack the transmittance e^(kappa_t (x_a - x_h))",
    )


def _relations(relation: Callable[[int, Any, Any], Any], left: Callable[[int, Any, Any], Any]) -> Any:
    """Largest difference between j_0 or j_1 and what a relation makes of i_0 or i_1."""
    return largest(
        relative(relation(n, segment.H, segment.w(x)), left(n, segment.H, segment.w(x)))
        for segment in SEGMENTS
        for x in (segment.x_a, segment.x_b)
        for n in (0, 1)
    )


def _j(n: int, a: Any, w: Any) -> Any:
    return (second.j_1 if n else second.j_0)(a, w)


def equation_31() -> Entry:
    """The formulations' antiderivatives of the same a."""
    with mp.workdps(CLOSED_FORM_DIGITS):
        error = _relations(thesis.eq_31, _j)
    return conclude("31", error, f"An identity: both sides differ by {shown(error)}.")


def equation_32() -> Entry:
    """Those of a and -a, which needs a branch of Ei that is real on the real axis."""
    with mp.workdps(CLOSED_FORM_DIGITS):
        error = _relations(thesis.eq_32, _j)
        sheet = _relations(
            lambda n, a, w: thesis.eq_32(n, a, w, ei_of_a_fixed_sheet),
            lambda n, a, w: (second.j_1 if n else second.j_0)(a, w, ei_of_a_fixed_sheet),
        )
        joined = largest(
            relative(
                second.j_0(s.H, s.w(s.x_b), ei_of_a_fixed_sheet) - first.i_0(-s.H, 1, ei_of_a_fixed_sheet),
                second.J_n(0, s.H, mpf(-1), s.w(s.x_b)),
            )
            for s in INSIDE
        )
        within = largest(
            relative(
                first.i_0(-s.H, s.v(s.x_b), ei_of_a_fixed_sheet) - first.i_0(-s.H, s.v(s.x_a), ei_of_a_fixed_sheet),
                first.I_n(0, -s.H, s.v(s.x_a), s.v(s.x_b)),
            )
            for s in SEGMENTS
        )
    return conclude(
        "32",
        error,
        f"Both sides differ by {shown(error)} if Ei(conj z) = conj Ei(z), so if its constant is i pi above the real "
        f"axis and -i pi below. An Ei with + i pi on both sides, an antiderivative as good (a difference of i_0 "
        f"changes by {shown(within)}), misses Eq. 32 by up to {shown(sheet)}: the constant no longer cancels between i "
        f"and j, and Figure 4.11's J_0 is then off by up to {shown(joined)}.",
    )


def _evaluations(compute: Callable[[], Any]) -> tuple[int, int]:
    """Distinct complex and real arguments of Ei in a computation."""
    with counted() as arguments:
        compute()
    distinct = set(arguments)
    real = {z for z in distinct if mp.im(z) == 0}
    return len(distinct - real), len(real)


def _figure(J: Any) -> Any:
    """Largest error of J_0 and J_1 from x_h on, and of the airlight of a polynomial in v and w."""
    parts = largest(
        relative(J(n, s.H, mpf(-1), s.w(s.x_b)), thesis.figure_4_9(n, s.H, mpf(-1), s.w(s.x_b)))
        for s in INSIDE
        for n in (0, 1)
    )
    phase = powers_of_v_and_w(C_N, D_N)
    whole = largest(relative(thesis.combined_airlight(s, C_N, D_N, J), airlight(s, phase)) for s in INSIDE)
    return max(parts, whole)


def figure_4_11() -> Entry:
    """Figure 4.11 and section 4.4's count."""
    segment = INSIDE[len(INSIDE) // 2]
    isotropic_terms = (1 / (4 * mp.pi),)
    repair = thesis.figure_4_11_repaired
    with mp.workdps(CLOSED_FORM_DIGITS):
        printed, repaired = _figure(thesis.figure_4_11_printed), _figure(repair)
        four = _evaluations(lambda: thesis.combined_airlight(segment, C_N, D_N, thesis.figure_4_9))
        three = _evaluations(lambda: thesis.combined_airlight(segment, C_N, D_N, repair))
        plain = _evaluations(lambda: thesis.combined_airlight(segment, isotropic_terms, isotropic_terms, repair))
        two = _evaluations(lambda: first.eq_21_repaired(segment))
        cancelled = largest(
            relative(thesis.combined_airlight(s, isotropic_terms, isotropic_terms, repair), first.eq_21_repaired(s))
            for s in INSIDE
        )
    return conclude(
        "Fig. 4.11",
        printed,
        f"As printed, J_1 or the airlight of a polynomial phase function is off by up to {shown(printed)} over "
        f"{len(INSIDE)} segments that hold x_h; with + Ei(-H) {shown(repaired)} is left. Counted while it ran: the "
        f"polynomial phase function needs {four[0]} complex Ei (and {four[1]} real) by Figure 4.9 and {three[0]} (and "
        f"{three[1]} real) by Figure 4.11, as section 4.4 says; the isotropic one needs {plain[0]} by Figure 4.11 and "
        f"{two[0]} by Eq. 21 with its prefactor repaired, which is J_0 - I_0 without the terms of v_h = 1: they "
        f"cancel, for both differ by {shown(cancelled)} over the {len(INSIDE)} segments.",
        max(repaired, cancelled),
        "J_1 ends in + Ei(-H)",
    )


CHECKS = (equation_30, equation_31, equation_32, figure_4_11)
