"""Algorithms 4.1 and 4.2 against given visibility, the airlight of each interval by the oracle.

Algorithm 4.1 is judged where light and shadow change halfway between two samples, which is as much as samples can say:
what is left then is the algorithm's own error. What changes elsewhere cost is told beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

from mpmath import mp, mpf

from analytic.oracle import exact_airlight
from analytic.thesis import sampling as thesis
from analytic.thesis.checks.entry import Entry, conclude, shown
from analytic.thesis.checks.parameters import ISOTROPIC, TRUTH_DIGITS
from analytic.thesis.sampling import Interval, Ray

__all__ = ["CHECKS"]

# a light at the distance 1 from the ray, abreast of x = 0; the eye at x = -4
H, EYE, KAPPA_T = 1.0, mpf(-4), 0.2
# the shadow region of Algorithm 4.1, its samples halfway through steps of 1/8
FRONT, FINAL, STEPS = mpf(1), mpf(9), 64
GAP = [(mpf(1), mpf(3)), (mpf(6), mpf(9))]
REGIONS: dict[str, list[Interval]] = {
    "one dark gap": GAP,
    "a lit island": [(mpf(3), mpf(6))],
    "lit first": [(mpf(1), mpf(5))],
    "lit last": [(mpf(5), mpf(9))],
    "all lit": [(mpf(1), mpf(9))],
    "all dark": [],
    "interlaced": [(mpf(k) + mpf("0.5"), mpf(k) + 1) for k in range(1, 9)],
}
# the same gap, where no number of steps meets its ends
ODD_GAP = [(mpf(1), mpf(1) + mp.sqrt(3)), (mpf(1) + mp.sqrt(26), mpf(9))]
FINER = (64, 256, 1024)


@cache
def _airlight(start: Any, end: Any) -> Any:
    """What the eye gets from one lit piece, as distances from it; negative where the piece runs backwards."""
    if start > end:
        return -_airlight(end, start)
    seen_from_start = exact_airlight(H, EYE + start, EYE + end, KAPPA_T, ISOTROPIC.exact, TRUTH_DIGITS).value
    return seen_from_start * mp.exp(-mpf(KAPPA_T) * start)


def _sum(intervals: Sequence[Interval]) -> Any:
    return mp.fsum(_airlight(start, end) for start, end in intervals)


def _error(found: Sequence[Interval], lit: Sequence[Interval]) -> Any:
    """Relative error of the airlight; where nothing is lit, whether nothing was found."""
    truth = _sum(lit)
    return abs(_sum(found) - truth) / truth if truth else mpf(_sum(found) != 0)


def _samples(lit: Sequence[Interval], steps: int) -> tuple[list[Any], list[bool]]:
    step = (FINAL - FRONT) / steps
    positions = [FRONT + (k + mpf(1) / 2) * step for k in range(steps)]
    return positions, [any(start <= position < end for start, end in lit) for position in positions]


def _repaired(lit: Sequence[Interval], steps: int) -> list[Interval]:
    samples, types = _samples(lit, steps)
    return thesis.algorithm_4_1_repaired(samples, types, FRONT, FINAL)


def _listed(errors: dict[str, Any]) -> str:
    return ", ".join(f"{case} {shown(error)}" for case, error in errors.items())


def algorithm_4_1() -> Entry:
    """Lit intervals from samples."""

    def errors(algorithm: Callable[[list[Any], list[bool]], list[Interval]]) -> dict[str, Any]:
        return {case: _error(algorithm(*_samples(lit, STEPS)), lit) for case, lit in REGIONS.items()}

    printed, mended = errors(thesis.algorithm_4_1_printed), errors(thesis.algorithm_4_1_printed_loop_mended)
    repaired = {case: _error(_repaired(lit, STEPS), lit) for case, lit in REGIONS.items()}
    shift = _error(
        thesis.algorithm_4_1_printed_loop_mended(*_samples(REGIONS["a lit island"], STEPS)), REGIONS["a lit island"]
    )
    odd = ", ".join(f"{shown(_error(_repaired(ODD_GAP, steps), ODD_GAP))} with {steps}" for steps in FINER)
    lost = max(mended.values())
    return conclude(
        "Alg. 4.1",
        lost,
        f"As printed the loop runs while the sample is outside the region, so it is never entered: the error is "
        f"{_listed(printed)}. With the loop's test mended: {_listed(mended)}, because startPos has no value if the "
        f"first sample is lit, the last interval is not stored, and intervals are taken from the first lit to the "
        f"first dark sample, half a step late ({shown(shift)} of the island with {STEPS} steps). The thesis's words "
        f"make endPos the final lit sample; its code stores the first dark one, and the code is what was run. "
        f"Repaired, the algorithm adds {shown(max(repaired.values()))} of its own: light changes halfway between two "
        f"samples here, which is where the repair puts an end. The error of sampling is no part of that and stays: "
        f"{odd} steps for a gap that no number of steps meets.",
        max(repaired.values()),
        "the loop's test, an unset startPos, a last interval that is lost, half a step",
    )


FAR = mpf(10)
RAYS: dict[str, Ray] = {
    "a shadow in between": Ray(mpf(2), mpf(6), FAR, False, [(mpf(0), mpf(2)), (mpf(6), FAR)]),
    "lit inside": Ray(mpf(2), mpf(8), FAR, False, [(mpf(0), mpf(2)), (mpf(4), mpf(5)), (mpf(8), FAR)]),
    "no polygon": Ray(None, None, FAR, False, [(mpf(0), FAR)]),
    "the eye in a shadow": Ray(mpf(5), mpf(5), FAR, True, [(mpf(5), FAR)]),
    "the eye inside without a polygon": Ray(None, None, FAR, True, []),
    "final behind the surface": Ray(mpf(3), mpf(12), FAR, False, [(mpf(0), mpf(3))]),
    "surface before front": Ray(mpf(5), mpf(8), mpf(4), False, [(mpf(0), mpf(4))]),
}


def algorithm_4_2() -> Entry:
    """The shadow region of a ray."""

    def errors(algorithm: Callable[[Ray], list[Interval]]) -> dict[str, Any]:
        return {case: _error(algorithm(ray), ray.lit) for case, ray in RAYS.items()}

    printed = errors(lambda ray: thesis.algorithm_4_2_printed(ray, mp.inf))
    cleared_to_0 = errors(lambda ray: thesis.algorithm_4_2_printed(ray, mpf(0)))
    chained = errors(lambda ray: thesis.algorithm_4_2_chained(ray, mp.inf))
    repaired = errors(thesis.algorithm_4_2_repaired)
    return conclude(
        "Alg. 4.2",
        min(max(printed.values()), max(chained.values())),
        f"Read as front < A and A < final, and with the distances of a pixel without a polygon infinite: "
        f"{_listed(printed)}; with those 0, no polygon {shown(cleared_to_0['no polygon'])}. Read as C and HLSL read "
        f"it, (front < A) < final, a truth value against a distance (GLSL refuses it): {_listed(chained)}. Repaired, "
        f"with front = 0 inside a volume and the region ended by the surface, {shown(max(repaired.values()))} is left.",
        max(repaired.values()),
        "no case for the eye inside a shadow volume or for a final polygon behind the surface",
    )


CHECKS = (algorithm_4_1, algorithm_4_2)
