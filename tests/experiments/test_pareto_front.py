"""The front of made-up points: against a staircase built another way, ties, intervals, and what a point lacks."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from experiments.pareto import front as module
from experiments.pareto.front import Point, Standing, dominates, front, missing, standing


def point(name: str, error: float, cost: float, reach: float = 0.0) -> Point:
    return Point(name, error, cost, cost - reach, cost + reach)


def staircase(points: Sequence[Point]) -> set[str]:
    """The front without asking of any two points: from the cheapest on, whatever errs less than all before."""
    kept: set[tuple[float, float]] = set()
    for cost, error in sorted({(one.cost, one.error) for one in points}):
        if all(error < other for _, other in kept):
            kept.add((cost, error))
    return {one.name for one in points if (one.cost, one.error) in kept}


def drawn(seed: int) -> list[Point]:
    """Thirty points on a grid of 8 x 8, so that many errors and costs, and some points, are the same."""
    places = np.random.default_rng(seed).integers(1, 9, (30, 2))
    return [point(f"{number}", float(error), float(cost)) for number, (error, cost) in enumerate(places)]


def agrees() -> bool:
    return all({one.name for one in front(drawn(seed))} == staircase(drawn(seed)) for seed in range(40))


def test_it_is_the_staircase() -> None:
    assert agrees()


WRONG: dict[str, Callable[[Point, Point], bool]] = {
    "equal points beat each other": lambda a, b: a.error <= b.error and a.cost <= b.cost,
    "only what is better in both": lambda a, b: a.error < b.error and a.cost < b.cost,
    "better in one is enough": lambda a, b: a.error < b.error or a.cost < b.cost,
    "dearer is better": lambda a, b: dominates(Point("", a.error, -a.cost, 0, 0), Point("", b.error, -b.cost, 0, 0)),
    "more error is better": lambda a, b: dominates(
        Point("", -a.error, a.cost, 0, 0), Point("", -b.error, b.cost, 0, 0)
    ),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_mistake_in_dominance_shows(wrong: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "dominates", WRONG[wrong])
    assert not agrees()


def test_one_point_is_the_front_and_lacks_nothing() -> None:
    alone = point("alone", 0.0, 3.0)
    assert front([alone]) == [alone]
    assert standing(alone, [alone]) == Standing.FRONT
    assert missing(alone, [alone]) is None
    assert front([]) == []


def test_all_are_dominated_by_one() -> None:
    best = point("best", 1.0, 1.0)
    others = [point("same error", 1.0, 2.0), point("same cost", 2.0, 1.0), point("worse", 3.0, 3.0)]
    assert front([*others, best]) == [best]
    assert [standing(one, [*others, best]) for one in others] == [Standing.BEHIND, Standing.UNDECIDED, Standing.BEHIND]


def test_two_equal_points_are_both_on_it_and_the_cheapest_comes_first() -> None:
    twins = [point("b", 1.0, 2.0), point("a", 1.0, 2.0)]
    cheap = point("cheap", 5.0, 1.0)
    assert [one.name for one in front([*twins, cheap])] == ["cheap", "a", "b"]
    assert missing(twins[0], twins) is None


@pytest.mark.parametrize(
    ("reach", "expected"),
    # intervals 9 to 11 and 10.5 to 13.5, then 9.5 to 10.5 and 11.5 to 12.5
    [((1.0, 1.5), Standing.UNDECIDED), ((0.5, 0.5), Standing.BEHIND), ((0.5, 1.5), Standing.UNDECIDED)],
)
def test_intervals_that_overlap_leave_it_open(reach: tuple[float, float], expected: Standing) -> None:
    better, worse = point("better", 1.0, 10.0, reach[0]), point("worse", 2.0, 12.0, reach[1])
    assert standing(worse, [better, worse]) == expected
    assert standing(better, [better, worse]) == Standing.FRONT


def test_what_may_be_as_cheap_puts_it_on_the_front_by_the_median_alone() -> None:
    mine, better = point("mine", 2.0, 10.0, 1.0), point("better", 1.0, 12.0, 1.0)
    assert standing(mine, [mine, better]) == Standing.BY_MEDIAN
    assert standing(mine, [mine, point("better", 1.0, 12.0, 0.9)]) == Standing.FRONT
    # one that errs more takes nothing from it; twins are both there by the median
    assert standing(better, [mine, better]) == Standing.FRONT
    twin = point("twin", 2.0, 10.0)
    assert standing(twin, [mine, twin]) == standing(mine, [mine, twin]) == Standing.BY_MEDIAN


def test_what_is_surely_cheaper_with_more_error_does_not_put_it_behind() -> None:
    cheap, better = point("cheap", 9.0, 1.0), point("better", 1.0, 10.0, 3.0)
    mine = point("mine", 2.0, 11.0, 2.0)
    assert standing(mine, [cheap, better, mine]) == Standing.UNDECIDED
    # and one behind the front that errs less is enough, though it is not on the front itself
    also = point("also", 1.5, 10.5, 0.1)
    assert standing(also, [better, also, mine]) == Standing.UNDECIDED
    assert standing(point("far", 2.0, 11.0, 0.1), [better, also]) == Standing.BEHIND


def test_what_would_put_a_point_on_the_front() -> None:
    points = [point("quick", 4.0, 5.0), point("middle", 2.0, 8.0), point("exact", 1.0, 20.0)]
    mine = point("mine", 6.0, 10.0)
    lack = missing(mine, [*points, mine])
    assert lack is not None
    # quick: 20, middle: 16
    assert lack.by.name == "middle"
    assert (lack.cost, lack.error, lack.factor) == (5.0, 2.0, 2.0)
    # a hair less of either is enough, a hair more is not
    for change in ((6.0, 4.999), (1.999, 10.0)):
        moved = point("mine", *change)
        assert standing(moved, [*points, moved]) == Standing.FRONT
    for change in ((6.0, 5.001), (2.001, 10.0)):
        moved = point("mine", *change)
        assert moved not in front([*points, moved])


def test_nothing_is_below_an_error_of_0() -> None:
    perfect, mine = point("perfect", 0.0, 1.0), point("mine", 1.0, 3.0)
    lack = missing(mine, [perfect, mine])
    assert lack is not None
    assert (lack.error, lack.factor) == (0.0, 3.0)
