"""Strata chosen from pilot passes whose spread is known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from reference import plan
from reference.goal import FEWEST_IN_LIMIT, FEWEST_PASSES, Goal
from reference.moments import BlackReferenceError
from reference.plan import MARGIN, MISSED, MOST_STRATA, PILOT_PASSES, PILOT_STRATA

SHAPE = (24, 40)


def plan_strata(one_pass: Callable[[int], np.ndarray], goal: Goal) -> np.ndarray:
    return plan.plan_strata(one_pass, goal)[0]


def pilot(spread: np.ndarray | float, mean: np.ndarray | float = 1.0) -> Callable[[int], np.ndarray]:
    """Passes whose relative standard deviation is known exactly: half are below the mean, half above."""
    deviation = np.broadcast_to(spread, SHAPE) * np.sqrt((PILOT_PASSES - 1) / PILOT_PASSES)
    return lambda number: (np.broadcast_to(mean, SHAPE) * (1 + deviation * (-1) ** number))[..., None] * np.ones(3)


def test_strata_follow_from_the_spread() -> None:
    # the standard error of 32 passes of n strata is 0.2 * 16 / n / sqrt(32)
    strata = plan_strata(pilot(0.2), Goal(0.005))
    expected = MARGIN * 0.2 * PILOT_STRATA / (0.005 * np.sqrt(FEWEST_PASSES))
    assert strata.shape == SHAPE
    assert (strata == np.ceil(expected)).all()
    assert (plan_strata(pilot(0.2), Goal(0.0025)) == np.ceil(2 * expected)).all()


# with 32 passes of them a shadow of 1 % of the samples, twice the goal of 0.5 %, is missed with e^(-0.01 n) = 7.7e-7
AT_LEAST = 44


def test_a_pixel_that_is_known_already_keeps_enough_to_meet_a_short_shadow() -> None:
    assert (plan_strata(pilot(1e-6), Goal(0.005)) == AT_LEAST).all()
    assert np.exp(-2 * 0.005 * AT_LEAST * FEWEST_PASSES) < MISSED < np.exp(-2 * 0.005 * (AT_LEAST - 1) * FEWEST_PASSES)
    # for a looser goal the pilot's are more than that
    assert (plan_strata(pilot(1e-6), Goal(0.05)) == PILOT_STRATA).all()


def test_each_pixel_has_its_own_and_its_neighbours() -> None:
    spread = np.full(SHAPE, 1e-6)
    spread[10, 20] = 0.2
    strata = plan_strata(pilot(spread), Goal(0.005, percentile=100))
    hard = strata > AT_LEAST
    assert hard[9:12, 19:22].all()
    assert hard.sum() == 9


def test_what_lies_beyond_the_percentile_does_not_cost_more() -> None:
    spread = np.full(SHAPE, 0.1)
    spread[:, :1] = 10.0  # with its neighbours 5 % of the pixels
    at_most = plan_strata(pilot(spread), Goal(0.005, percentile=94)).max()
    assert at_most == plan_strata(pilot(0.1), Goal(0.005)).max()
    assert plan_strata(pilot(spread), Goal(0.005, percentile=96)).max() == MOST_STRATA


def test_dark_pixels_ask_for_no_more_than_the_floor_does() -> None:
    mean = np.ones(SHAPE)
    mean[:, :10] = 1e-6
    strata = plan_strata(pilot(0.2, mean), Goal(0.005))
    assert (strata[:, :9] == AT_LEAST).all()
    assert (strata[:, 11:] > AT_LEAST).all()


def test_the_fewest_passes_fit_into_the_sample_limit() -> None:
    strata = plan_strata(pilot(0.2), Goal(0.005, sample_limit=320))
    assert (strata == 40).all()
    assert strata.mean() * FEWEST_IN_LIMIT <= 320
    assert (plan_strata(pilot(0.2), Goal(0.005, sample_limit=FEWEST_IN_LIMIT)) == 1).all()
    # a limit that leaves room changes nothing
    assert (plan_strata(pilot(0.2), Goal(0.005, sample_limit=10**6)) == plan_strata(pilot(0.2), Goal(0.005))).all()


def test_a_limit_that_has_no_room_says_for_which_error_the_plan_is() -> None:
    whole, planned_for = plan.plan_strata(pilot(0.2), Goal(0.005))
    assert planned_for == 0.005
    limit = int(whole.mean()) * FEWEST_IN_LIMIT // 4
    _, planned_for = plan.plan_strata(pilot(0.2), Goal(0.005, sample_limit=limit))
    assert planned_for == pytest.approx(0.02, rel=0.03)


def test_the_sample_limit_holds_where_strata_vary() -> None:
    spread = np.where(np.arange(SHAPE[1]) < 20, 1e-6, 0.5)[None, :]
    for limit in (FEWEST_IN_LIMIT, 3 * FEWEST_IN_LIMIT, 50 * FEWEST_IN_LIMIT):
        strata = plan_strata(pilot(spread), Goal(0.005, sample_limit=limit))
        assert strata.min() >= 1
        assert strata.mean() * FEWEST_IN_LIMIT <= limit


def test_the_percentile_is_of_lit_pixels() -> None:
    mean = np.zeros(SHAPE)
    mean[4:8, 4:8] = 1
    # less than 5 % of the image is lit, and all of it noisy
    assert (plan_strata(pilot(0.2, mean), Goal(0.005))[4:8, 4:8] > 2 * AT_LEAST).all()


def test_no_goal_takes_more_than_the_most() -> None:
    assert plan_strata(pilot(1e-6), Goal(1e-6)).max() == MOST_STRATA


def test_a_short_time_limit_leaves_one_stratum() -> None:
    assert (plan_strata(pilot(0.2), Goal(0.005, time_limit=1e-9)) == 1).all()


def test_a_black_pilot_is_an_error() -> None:
    with pytest.raises(BlackReferenceError):
        plan_strata(pilot(0.2, 0.0), Goal())
