"""Limits and verdicts: what margin a value gets, and what fails."""

from __future__ import annotations

import math
import re
import tomllib

import numpy as np
import pytest

from experiments.gate import rounding
from experiments.gate.limits import FLOOR, MARGIN, PATH, RUNS, Limit, limits_of
from experiments.gate.measuring import METRICS
from experiments.gate.update import changes
from experiments.gate.verdicts import Verdict, judge, worst_of
from gpu_impl import shader_source
from scenes.errors import InputError

SIGNED, ERROR = "scattering.image_mean_rel", "scattering.rel_95"


def values(**given: float) -> dict[str, dict[str, float]]:
    return {"case": dict.fromkeys(METRICS, 0.1) | {name.replace("__", "."): value for name, value in given.items()}}


def verdict(metric: str, value: float, margin: float = 0.01) -> Verdict:
    return Verdict("case", metric, value, Limit(0.1, 0.0, 0.0, margin))


def test_a_margin_is_twice_the_most_that_a_value_moved() -> None:
    limits = limits_of(
        [values(), values(scattering__rel_95=0.103, composite__flip=0.098)],
        [values(scattering__rel_95=0.101), values(composite__flip=0.105)],
    )["case"]
    assert limits[ERROR] == Limit(0.1, pytest.approx(0.003), pytest.approx(0.001), pytest.approx(MARGIN * 0.003))
    flip = limits["composite.flip"]
    assert flip == Limit(0.1, pytest.approx(0.002), pytest.approx(0.005), pytest.approx(MARGIN * 0.005))
    assert limits[SIGNED] == Limit(0.1, 0.0, 0.0, FLOOR)


def test_a_value_that_only_ever_falls_moves_too() -> None:
    found = limits_of([values()], [values(composite__flip=0.095), values(composite__flip=0.098)])["case"]
    assert found["composite.flip"] == Limit(0.1, 0.0, pytest.approx(0.005), pytest.approx(MARGIN * 0.005))


def test_rounding_is_tried_in_both_directions(monkeypatch: pytest.MonkeyPatch) -> None:
    headers = []
    monkeypatch.setattr(rounding, "TRIALS", 2)
    monkeypatch.setattr(rounding, "measure_cases", lambda cases, drawn: headers.append(shader_source.HEADER) or {})
    assert len(list(rounding.perturbed_values([]))) == len(headers) == 4
    for name, off in rounding.FUNCTIONS.items():
        factors = [float(re.search(rf"#define {name}\(x\) \({name}\(x\) \* (\S+)\)", one)[1]) for one in headers]
        assert np.array(factors) - 1 == pytest.approx([off, off, -off, -off], abs=1e-9)


def test_the_committed_limits_are_of_enough_runs() -> None:
    made = tomllib.loads(PATH.read_text(encoding="utf-8"))
    assert min(made["runs_idle"], made["runs_loaded"]) >= RUNS == 10
    assert "note" not in made


def test_what_cannot_be_drawn_has_no_limits() -> None:
    with pytest.raises(InputError, match="case cannot be drawn"):
        limits_of([values()], [values(scattering__rel_95=math.nan)])


@pytest.mark.parametrize(
    ("metric", "value", "passes", "is_better"),
    [
        (ERROR, 0.1099, True, False),
        (ERROR, 0.1101, False, False),
        (ERROR, 0.0899, True, True),
        (ERROR, 0.0901, True, False),
        (SIGNED, 0.1099, True, False),
        (SIGNED, 0.1101, False, False),
        (SIGNED, 0.0901, True, False),
        (SIGNED, 0.0899, False, False),
        (ERROR, math.nan, False, False),
        (SIGNED, math.nan, False, False),
        (ERROR, math.inf, False, False),
    ],
)
def test_errors_are_held_from_above_and_sums_from_both_sides(
    metric: str, value: float, passes: bool, is_better: bool
) -> None:
    found = verdict(metric, value)
    assert (found.passes, found.is_better) == (passes, is_better)


def test_a_verdict_says_by_how_much() -> None:
    assert str(verdict(ERROR, 0.125)) == (
        "case: scattering.rel_95 is 0.125, above its limit of 0.11: 2.5 margins of 0.01 from the 0.1 measured"
    )
    assert str(verdict(SIGNED, 0.07)) == (
        "case: scattering.image_mean_rel is 0.07, below its limit of 0.09: 3.0 margins of 0.01 from the 0.1 measured"
    )
    assert "is no number" in str(verdict(ERROR, math.nan))


def test_the_worst_of_a_case_is_the_farthest_beyond() -> None:
    limits = limits_of([values()], [values()])
    one = values(composite__flip=0.05, surface__image_mean_rel=0.0999, scattering__rel_95=0.10003)
    assert worst_of(judge(one, limits))["case"].metric == "surface.image_mean_rel"
    one = values(surface__image_mean_rel=0.5, scattering__rel_95=math.nan)
    assert worst_of(judge(one, limits))["case"].metric == ERROR


def test_changes_are_those_of_value_and_margin_and_of_cases() -> None:
    old = limits_of([values()], [values()])
    assert not list(changes(old, old))
    # a digit that the file does not hold
    assert not list(changes(old, limits_of([values(scattering__rel_95=0.1 + 1e-9)], [values(scattering__rel_95=0.1)])))
    (one,) = changes(old, limits_of([values(scattering__rel_95=0.10001)], [values(scattering__rel_95=0.10001)]))
    assert (one.metric, one.old.value, one.new.value) == (ERROR, 0.1, 0.10001)  # type: ignore[union-attr]
    (one,) = changes(old, limits_of([values()], [values(scattering__rel_95=0.2)]))
    assert (one.metric, one.new.margin) == (ERROR, pytest.approx(MARGIN * 0.1))  # type: ignore[union-attr]
    assert len(list(changes(old, {}))) == len(list(changes({}, old))) == len(METRICS)
