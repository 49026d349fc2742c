"""What a frame costs: the case's technique and its baseline in rounds of their own (`experiments.rounds`)."""

from __future__ import annotations

import os
import time

import numpy as np
import psutil

from experiments.benchmark.efficiency import quartiles
from experiments.intervals import FEWEST_ROUNDS, Array, median_interval
from experiments.measurements import Measurement, Value
from experiments.measurements.shot import Shot
from experiments.rounds import Times, time_in_rounds
from experiments.technique_label import technique_label
from gpu_impl.techniques import Technique
from gpu_impl.timing import PASSES, PassClock
from scenes.errors import InputError

# who is timed; where both are the same technique, the ratio shows how far two equal things seem to differ
MINE, BASELINE = "technique", "baseline"
INTERVAL = ("timing.ratio_low", "timing.ratio_high")


def timing(shot: Shot) -> dict[str, Value]:
    """Time whole frames and their passes, in alternating rounds with the case's baseline.

    Returns
    -------
    dict
        `timing.ms_25`, `_50`, `_75`           whole frames without a clock [ms]
        `timing.baseline_ms_25`, `_50`, `_75`  the same of the baseline
        `timing.clocked_ms`                    median of frames with a clock at each pass [ms]
        `timing.<pass>_ms`                     median of each of `gpu_impl.timing.PASSES` [ms]; 0 for a pass that the
                                               technique has none of
        `timing.ratio_25`, `_50`, `_75`        time over the baseline's in the same round
        `timing.ratio_low`, `_high`            interval of their median (`experiments.intervals`)
        `timing.baseline`                      its name and settings
        `timing.rounds`, `timing.clock`        that counted; how passes were timed
        `timing.load`                          processes that ran or waited on the machine in the minute before
        `timing.others`                        processors that other processes kept busy meanwhile
        `timing.baseline_refusal`              why the baseline cannot draw the scene, in its own words, and then there
                                               are no ratios; None where it can
        `timing.no_interval`                   why the ratio has no interval; None where it has one
    """
    case, techniques = shot.case, {MINE: shot.technique}
    refusal = _refusal(shot)
    if refusal is None:
        techniques[BASELINE] = case.baseline
    load, others = os.getloadavg()[0], OtherProcesses()
    times = time_in_rounds(shot.renderer, techniques, case.rounds)
    busy, mine = others.processors(), times[MINE]
    return {
        **_quartiles("ms", mine.milliseconds),
        **_ratios(mine, times.get(BASELINE)),
        "timing.clocked_ms": float(np.median(mine.clocked)),
        **{pass_column(name): mine.pass_median(name) for name in PASSES},
        "timing.baseline": label(case.baseline),
        "timing.rounds": case.rounds,
        "timing.clock": PassClock(shot.renderer.device).method,
        "timing.load": load,
        "timing.others": busy,
        "timing.baseline_refusal": refusal,
        "timing.no_interval": _no_interval(case.rounds, refusal),
    }


def label(technique: Technique) -> str:
    """A technique as tables call it."""
    return technique_label(technique.name, vars(technique))


def pass_column(name: str) -> str:
    """Column of one of `gpu_impl.timing.PASSES`."""
    return f"timing.{name.replace(' ', '_')}_ms"


def _refusal(shot: Shot) -> str | None:
    """The baseline's, of a scene that the technique can draw."""
    try:
        shot.case.baseline.check_scene(shot.scene)
    except InputError as error:
        return str(error)
    return None


def _quartiles(name: str, values: Array | None) -> dict[str, Value]:
    found = (None, None, None) if values is None else quartiles(values)
    return {f"timing.{name}_{part}": value for part, value in zip((25, 50, 75), found, strict=True)}


def _ratios(mine: Times, baseline: Times | None) -> dict[str, Value]:
    if baseline is None:
        return _quartiles("baseline_ms", None) | _quartiles("ratio", None) | dict.fromkeys(INTERVAL)
    ratios = mine.milliseconds / baseline.milliseconds
    interval = median_interval(ratios) if ratios.size >= FEWEST_ROUNDS else (None, None)
    return (
        _quartiles("baseline_ms", baseline.milliseconds)
        | _quartiles("ratio", ratios)
        | dict(zip(INTERVAL, interval, strict=True))
    )


def _no_interval(rounds: int, refusal: str | None) -> str | None:
    if refusal is not None:
        return refusal
    return f"{rounds} rounds, and an interval takes {FEWEST_ROUNDS}" if rounds < FEWEST_ROUNDS else None


class OtherProcesses:
    """How busy everything but this process keeps the machine, from when it is made."""

    def __init__(self) -> None:
        self._since, self._busy = time.perf_counter(), _busy_elsewhere()

    def processors(self) -> float:
        """Processors that were busy on average; 0 or more, for the system's clocks tick in hundredths of a second."""
        return max(0.0, (_busy_elsewhere() - self._busy) / (time.perf_counter() - self._since))


def _busy_elsewhere() -> float:
    """Processor time of all other processes since the machine started [s]."""
    machine, mine = psutil.cpu_times(), os.times()
    return machine.user + machine.nice + machine.system - mine.user - mine.system


MEASUREMENT = Measurement(timing, needs_quiet=True)
