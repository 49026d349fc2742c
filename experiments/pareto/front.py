"""The Pareto front of error and cost, where costs are known to an interval only."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum


@dataclass(frozen=True)
class Point:
    """One technique with its settings in one scene.

    Attributes
    ----------
    name : str
    error : float        0 or more
    cost : float         [ms]
    low, high : float    interval of the cost [ms]
    """

    name: str
    error: float
    cost: float
    low: float
    high: float


class Standing(StrEnum):
    """Where a point stands, as tables say it."""

    FRONT = "front"
    BY_MEDIAN = "front, by the median"
    UNDECIDED = "not to be told apart"
    BEHIND = "behind"


def dominates(one: Point, other: Point) -> bool:
    """Whether `one` is as good in both and better in one of them; equal points do not dominate each other."""
    as_good = one.error <= other.error and one.cost <= other.cost
    return as_good and (one.error < other.error or one.cost < other.cost)


def surely_dominates(one: Point, other: Point) -> bool:
    """Whether `one` errs no more and costs less wherever in their intervals the two costs lie."""
    return one.error <= other.error and one.high < other.low


def front(points: Sequence[Point]) -> list[Point]:
    """Those that none dominates, the cheapest first."""
    found = [point for point in points if not any(dominates(other, point) for other in points)]
    return sorted(found, key=lambda point: (point.cost, point.error, point.name))


def standing(point: Point, points: Sequence[Point]) -> Standing:
    """Where a point stands among all.

    One that none dominates is on the front for sure if no other that errs no more may be as cheap, by the intervals of
    both; else it is there by the medians, and what is as good may have put it behind.

    A dominated one is behind where a point that errs no more is surely cheaper. Where there is none, it might be
    cheaper than all of those, and on the front: its interval overlaps that of whatever dominates it.
    """
    if not any(dominates(other, point) for other in points):
        others = [other for other in points if other is not point and other.error <= point.error]
        return Standing.BY_MEDIAN if any(other.low <= point.high for other in others) else Standing.FRONT
    return Standing.BEHIND if any(surely_dominates(other, point) for other in points) else Standing.UNDECIDED


@dataclass(frozen=True)
class Missing:
    """What keeps a dominated point from the front.

    Attributes
    ----------
    by : Point        of those that dominate it, the one on the front with the least error times cost
    cost : float      [ms] below which it would be on the front with the error that it has
    error : float     below which it would be on the front with the cost that it has
    factor : float    the smaller of the two improvements, 1 or more
    """

    by: Point
    cost: float
    error: float
    factor: float


def missing(point: Point, points: Sequence[Point]) -> Missing | None:
    """What a point lacks; None where it is on the front."""
    beaten_by = [other for other in front(points) if dominates(other, point)]
    if not beaten_by:
        return None
    cost = min(other.cost for other in beaten_by)
    error = min(other.error for other in beaten_by)
    factor = min(point.cost / cost, point.error / error if error > 0 else float("inf"))
    return Missing(min(beaten_by, key=lambda other: other.error * other.cost), cost, error, factor)
