r"""Section 4.1 of Weng 2010: Algorithms 4.1 and 4.2, as printed and repaired.

Algorithm 4.1 finds the lit intervals of a shadow region from samples, Algorithm 4.2 the shadow region of a ray. `lit`
is given samples or cuts of intervals, never a picture: what is judged is the algorithm, not a shadow map.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

Interval = tuple[Any, Any]


def algorithm_4_1_printed(samples: Sequence[Any], lit: Sequence[bool]) -> list[Interval]:
    """As the words stand: "While (current sample pass out the shadow region)".

    The first sample is inside the region, so the loop is not entered. (Were it, it would go on outside.)
    """
    intervals: list[Interval] = []
    current, start_pos = 0, None
    while current >= len(samples):
        current, start_pos = _step(samples, lit, current, start_pos, intervals)
    return intervals


def algorithm_4_1_printed_loop_mended(samples: Sequence[Any], lit: Sequence[bool]) -> list[Interval]:
    """The loop runs until the sample passes out of the region; the rest as printed.

    startPos has no value where the first sample is lit: an interval without a start cannot be stored. One that is open
    when the loop ends is not stored either.
    """
    intervals: list[Interval] = []
    current, start_pos = 0, None
    while current + 1 < len(samples):
        current, start_pos = _step(samples, lit, current, start_pos, intervals)
    return intervals


def _step(
    samples: Sequence[Any], lit: Sequence[bool], current: int, start_pos: Any, intervals: list[Interval]
) -> tuple[int, Any]:
    """The body of the printed loop."""
    lit_type_before = lit[current]
    current += 1
    lit_type_current = lit[current]
    if lit_type_before and not lit_type_current and start_pos is not None:
        intervals.append((start_pos, samples[current]))
    if not lit_type_before and lit_type_current:
        start_pos = samples[current]
    return current, start_pos


def algorithm_4_1_repaired(samples: Sequence[Any], lit: Sequence[bool], front: Any, final: Any) -> list[Interval]:
    """An interval begins and ends halfway between the two samples that bracket the change, or with the region."""
    intervals: list[Interval] = []
    start_pos = front if lit[0] else None
    for before in range(len(samples) - 1):
        halfway = (samples[before] + samples[before + 1]) / 2
        if lit[before] and not lit[before + 1]:
            intervals.append((start_pos, halfway))
        if not lit[before] and lit[before + 1]:
            start_pos = halfway
    if lit[-1]:
        intervals.append((start_pos, final))
    return intervals


@dataclass(frozen=True)
class Ray:
    """What Algorithm 4.2 is given, as distances from the eye.

    Attributes
    ----------
    front, final : number or None  first and last shadow polygon; None where there is none
    surface : number               where the ray ends
    eye_in_shadow_volume : bool
    lit : sequence of intervals    the truth, in [0, surface]
    """

    front: Any
    final: Any
    surface: Any
    eye_in_shadow_volume: bool
    lit: Sequence[Interval]


def algorithm_4_2_printed(ray: Ray, cleared: Any) -> list[Interval]:
    """Lit intervals with the signs that Eq. 16 gives them: (3, 2) counts as what is taken away.

    Section 4.1 sums eye to front, the lit part of the region, and final to surface. `cleared` is the distance that a
    pixel without a shadow polygon holds, of which the print says nothing.
    """
    front, final = (cleared, cleared) if ray.front is None else (ray.front, ray.final)
    if not front < ray.surface:
        return [(0, ray.surface)]
    return [(0, front), *clip(ray.lit, front, final), (final, ray.surface)]


def algorithm_4_2_chained(ray: Ray, cleared: Any) -> list[Interval]:
    """The same in C or HLSL, which read "front < A < final" as (front < A) < final, a truth value against a distance.

    GLSL refuses it. The truth value is 0 or 1, so every sample of the ray is in the region where final > 1.
    """
    front, final = (cleared, cleared) if ray.front is None else (ray.front, ray.final)
    if not front < ray.surface:
        return [(0, ray.surface)]
    inside = clip(ray.lit, 0, ray.surface) if final > 1 else clip(ray.lit, 0, front) if final > 0 else []
    return [(0, front), *inside, (final, ray.surface)]


def algorithm_4_2_repaired(ray: Ray) -> list[Interval]:
    """The region begins at the eye where the eye is inside a volume and ends at the surface at the latest."""
    if ray.eye_in_shadow_volume:
        front = 0
    elif ray.front is None or ray.front >= ray.surface:
        return [(0, ray.surface)]
    else:
        front = ray.front
    final = ray.surface if ray.final is None else min(ray.final, ray.surface)
    return [(0, front), *clip(ray.lit, front, final), (final, ray.surface)]


def clip(intervals: Sequence[Interval], low: Any, high: Any) -> list[Interval]:
    """The parts of the intervals between low and high."""
    cut = ((max(start, low), min(end, high)) for start, end in intervals)
    return [(start, end) for start, end in cut if start < end]
