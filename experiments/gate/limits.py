"""How far each gated value may be from the one that was measured, and the committed file that says so.

A value of a case does not change from run to run: llvmpipe gives the same bits idle or loaded and at every width of its
vectors, and the references are committed. It changes with the CPU's maker and the driver's version, by rounding. Each
limit therefore has a margin of MARGIN times the most that the value moved, from run to run (`repeats.py`) or when eye,
lights and the shaders' functions were moved by more than rounding does (`rounding.py`), and no less than FLOOR.

Sums of light (METRICS that end in image_mean_rel) are held from both sides: a sum has no better side. Errors are held
from above; one that fell by more than its margin is told, as `airlight gate --update` should then lower it.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from experiments.gate.measuring import METRICS, Values
from experiments.provenance import environment
from experiments.suite import Case
from scenes.errors import InputError
from scenes.replacing import replacing

PATH = Path(__file__).parent / "limits.toml"
MARGIN = 2.0
# llvmpipe's exp alone is off by up to 3.5e-6, which moves a sum of light by 7.3e-6 (measured); almost three times that
FLOOR = 2e-5
# that a committed file is measured with, on an idle machine and on a loaded one
RUNS = 10
# relative, by which a number may differ from another only in how both are written
WRITTEN = 1e-6
UPDATE = "`airlight gate --update` writes it anew"


@dataclass(frozen=True)
class Limit:
    """What a value was, and how much it may change.

    Attributes
    ----------
    value : float       as it was measured
    repeats : float     between the least and the most of all runs
    rounding : float    the most that it moved when it was perturbed
    margin : float      by which it may be off
    """

    value: float
    repeats: float
    rounding: float
    margin: float


Limits = dict[str, dict[str, Limit]]


def limits_of(runs: Sequence[Values], perturbed: Sequence[Values]) -> Limits:
    """Limits from what was measured: all runs of the same, and perturbed ones.

    Parameters
    ----------
    runs : the first decides the values

    Raises
    ------
    InputError
        A case cannot be drawn.
    """
    for case in runs[0]:
        if any(math.isnan(value) for one in (*runs, *perturbed) for value in one[case].values()):
            raise InputError(f"{case} cannot be drawn, or not always, so it has no limits: `airlight gate` says why.")
    return {
        case: {
            metric: _limit([run[case][metric] for run in runs], [one[case][metric] for one in perturbed])
            for metric in METRICS
        }
        for case in runs[0]
    }


def _limit(runs: Sequence[float], perturbed: Sequence[float]) -> Limit:
    repeats = max(runs) - min(runs)
    rounding = max(abs(value - runs[0]) for value in perturbed)
    return Limit(runs[0], repeats, rounding, _margin(repeats, rounding))


def _margin(repeats: float, rounding: float) -> float:
    return max(FLOOR, MARGIN * max(repeats, rounding))


def write_limits(limits: Limits, told: Mapping[str, Any]) -> None:
    """Write the file; `told` says how the limits were measured."""
    made = {"made_by": "airlight gate --update", "date": f"{datetime.now(UTC):%Y-%m-%d}", **told, **environment()}
    lines = [
        "# Limits of the gate. experiments/gate/limits.py says what they mean; do not edit, run the command.",
        *(f"{key} = {_toml(value)}" for key, value in made.items()),
    ]
    for case, metrics in limits.items():
        lines += ["", f"[limits.{_toml(case)}]"]
        for metric, one in metrics.items():
            numbers = ", ".join(f"{name} = {value:.6e}" for name, value in vars(one).items())
            lines.append(f"{_toml(metric)} = {{ {numbers} }}")
    with replacing(PATH) as beside:
        beside.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _toml(value: Any) -> str:
    if isinstance(value, int):
        return str(value)
    return '"' + str(value).replace("\\", "\\\\").replace('"', '\\"') + '"'


def read_limits() -> Limits:
    """Read the file.

    Raises
    ------
    InputError
        It is missing or damaged.
    """
    try:
        found = tomllib.loads(PATH.read_text(encoding="utf-8"))["limits"]
        limits = {
            case: {metric: Limit(**numbers) for metric, numbers in metrics.items()} for case, metrics in found.items()
        }
    except FileNotFoundError:
        raise InputError(f"There are no limits at {PATH}: restore the file from the repository, or {UPDATE}.") from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        raise InputError(f"{PATH} cannot be read as limits: restore it from the repository, or {UPDATE}.") from None
    if not all(_is_whole(one) for metrics in limits.values() for one in metrics.values()):
        raise InputError(
            f"{PATH} holds a limit that is no number, or a margin that is not what its row's numbers give: restore it "
            f"from the repository, or {UPDATE}."
        )
    return limits


def limits_for(cases: Sequence[Case]) -> Limits:
    """Read the file, which must be of all of the gate's cases and of no others.

    Raises
    ------
    InputError
        As `read_limits`; or a limit is missing, or one is of no case.
    """
    limits, names = read_limits(), [case.name for case in cases]
    for case in names:
        for metric in METRICS:
            if metric not in limits.get(case, {}):
                raise InputError(f"{PATH} has no limit for {metric} of the case {case}: {UPDATE}.")
    if strange := next((case for case in limits if case not in names), None):
        raise InputError(f"{PATH} has limits for {strange}, and the gate has no such case: {UPDATE}.")
    return limits


def _is_whole(limit: Limit) -> bool:
    numbers = vars(limit).values()
    if not all(isinstance(one, float) and math.isfinite(one) for one in numbers):
        return False
    # nobody widens a margin by hand
    rule = _margin(limit.repeats, limit.rounding)
    return min(limit.repeats, limit.rounding) >= 0 and abs(limit.margin - rule) <= WRITTEN * rule
