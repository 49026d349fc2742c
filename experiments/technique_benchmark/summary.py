"""The numbers of the benchmark, flat for CSV files, and what is said of them."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from experiments.benchmark.efficiency import quartiles
from experiments.intervals import median_interval
from experiments.provenance import describe_scene, describe_technique
from experiments.technique_benchmark.budget import triangle_count
from experiments.technique_benchmark.contenders import ERROR_LIMITS, FAST_ROWS, PAIRS, published_rate
from experiments.technique_benchmark.measurement import Measured, Result
from gpu_impl.device import shared_device
from gpu_impl.timing import PASSES

Row = dict[str, Any]
# as `COUNTERS` calls them
EI = "exponential_integrals"


def rows(result: Result) -> list[Row]:
    """A row a contender, refused ones included."""
    info = shared_device().info
    about = {
        **describe_scene(result.scene),
        "phase": result.scene.phase.name,
        "triangles": triangle_count(result.scene),
        "reference_error": result.reference.estimate.rel_error,
        "gl_renderer": info.renderer,
        "gl_version": info.version,
        "clock": result.clock,
    }
    return [{**about, "contender": name, **_numbers(result, one)} for name, one in result.contenders.items()]


def _numbers(result: Result, one: Measured) -> Row:
    settings = describe_technique(one.technique)
    if one.refusal or not one.metrics or not one.footprint:
        return {**settings, "refusal": one.refusal}
    low, middle, high = quartiles(one.times.milliseconds)
    ratios = result.ratios(one.contender.name)
    least, most = median_interval(ratios)
    return {
        **settings,
        "refusal": "",
        "rounds": one.times.milliseconds.size,
        "milliseconds_25": low,
        "milliseconds_50": middle,
        "milliseconds_75": high,
        "frames_per_second": 1e3 / middle,
        "published_frames_per_second": published_rate(result.scene),
        "over_march": float(np.median(ratios)),
        "over_march_low": least,
        "over_march_high": most,
        "clocked_over_plain": float(np.median(one.times.clocked / one.times.milliseconds)),
        **{f"milliseconds_{name.replace(' ', '_')}": one.times.pass_median(name) for name in PASSES},
        **{f"error_{name}": value for name, value in asdict(one.metrics).items()},
        "rays": one.rays,
        **{f"{name}_per_ray": value for name, value in one.counts.items()},
        **asdict(one.footprint),
    }


def pair_rows(result: Result) -> list[Row]:
    """A row a pair that can be compared in this scene."""
    found = []
    for pair in PAIRS:
        if not {pair.first, pair.second} <= result.contenders.keys():
            continue
        first, second = (result.contenders[name] for name in (pair.first, pair.second))
        if first.refusal or second.refusal:
            continue
        ratios = result.ratios(pair.first, pair.second)
        low, high = median_interval(ratios)
        passes = first.times.passes["scattering"] / second.times.passes["scattering"]
        pass_low, pass_high = median_interval(passes)
        found.append(
            {
                "scene": result.scene.name,
                "phase": result.scene.phase.name,
                "first": pair.first,
                "second": pair.second,
                "claim": pair.claim,
                "first_steps": first.technique.steps,
                "second_steps": second.technique.steps,
                "first_exponential_integrals": first.counts[EI],
                "second_exponential_integrals": second.counts[EI],
                "same_work": _same_work(first, second),
                "rounds": ratios.size,
                "ratio": float(np.median(ratios)),
                "ratio_low": low,
                "ratio_high": high,
                "scattering_ratio": float(np.median(passes)),
                "scattering_ratio_low": pass_low,
                "scattering_ratio_high": pass_high,
            }
        )
    return found


def _same_work(first: Measured, second: Measured) -> bool:
    """Whether two airlight models counted the same in a scene, so that nothing is compared.

    Where no lit piece holds the foot of the light's perpendicular on its ray, three and four evaluations of Ei are two.
    """
    return first.technique.airlight != second.technique.airlight and first.counts == second.counts


def told(row: Row) -> str:
    """What a pair's interval says, in words."""
    if row["same_work"]:
        return "same work"
    if row["ratio_low"] > 1:
        return "the second is faster"
    if row["ratio_high"] < 1:
        return "the first is faster"
    return "no difference found"


def fastest(result: Result) -> Measured | None:
    """The fast row of a scene: the fastest of `FAST_ROWS`, of those within `ERROR_LIMITS` where there are any."""
    drawn = [one for name, one in result.contenders.items() if name in FAST_ROWS and not one.refusal]
    within = list(filter(is_within, drawn))
    return min(within or drawn, key=lambda one: float(np.median(one.times.milliseconds)), default=None)


def is_within(one: Measured) -> bool:
    """Whether a contender draws the scene with errors within `ERROR_LIMITS`."""
    if one.refusal or one.metrics is None or one.metrics.rel_50 is None or one.metrics.rel_95 is None:
        return False
    return one.metrics.rel_50 <= ERROR_LIMITS[0] and one.metrics.rel_95 <= ERROR_LIMITS[1]
