"""Which lattice serves ours best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from experiments.markdown import table as markdown_table
from experiments.pareto.front import Point, Standing, standing
from experiments.pareto.points import MEASURES, Measure, Scene, geometric_mean, is_ours
from experiments.studies.cells import Row
from experiments.studies.timing import short

BEST = """The lattice that serves ours best is **{best}**: on {on} of {all} fronts{ties}.{runner_up} Lattices are ranked
by the fronts that they are on, each scene's by either measure, and those on as many by error times cost, its geometric
mean over scenes and measures: as much better for half the error as for half the time. Where a front has several, the
error or the time that one can afford decides."""


@dataclass(frozen=True)
class Served:
    """How well one lattice serves ours.

    Attributes
    ----------
    name : str
    fronts : int              that it is on, of the scenes' by each measure
    undecided : int           from which it is not to be told apart
    errors : tuple of float   geometric mean over the scenes, by measure
    cost : float              the same of the cost [ms]
    product : float           of error and cost, the mean over scenes and measures
    """

    name: str
    fronts: int
    undecided: int
    errors: tuple[float, ...]
    cost: float
    product: float


def lattice_of(row: Row) -> str:
    """A row's lattice in words: which, how coarse, and how values come to all pixels where the grid has a choice."""
    if row["downsample"] == 1 and row["lattice"] == "grid":
        return "grid, every pixel"
    words = f"{row['lattice']}, N = {row['downsample']}"
    return f"{words}, {row['upsample']}" if row["lattice"] == "grid" else words


def served(scenes: Sequence[Scene]) -> list[Served]:
    """Every lattice that ours ran on in each scene, the best first.

    Where ours ran with other settings too, a lattice is as good as the best of them, that of the least error times
    cost.
    """
    with_ours = [scene for scene in scenes if any(map(is_ours, scene.rows))]
    names = [{lattice_of(row) for row in scene.rows if is_ours(row)} for scene in with_ours]
    everywhere = [name for name in _in_order(with_ours) if all(name in found for found in names)]
    return sorted(
        (_served(name, with_ours) for name in everywhere), key=lambda one: (-one.fronts, one.product, one.name)
    )


def _in_order(scenes: Sequence[Scene]) -> list[str]:
    return list(dict.fromkeys(lattice_of(row) for scene in scenes for row in scene.rows if is_ours(row)))


def _served(name: str, scenes: Sequence[Scene]) -> Served:
    found = {measure: [_candidate(scene, measure, name) for scene in scenes] for measure in MEASURES}
    every = [one for candidates in found.values() for one in candidates]
    return Served(
        name,
        sum(where == Standing.FRONT for _, where in every),
        sum(where == Standing.UNDECIDED for _, where in every),
        tuple(geometric_mean(point.error for point, _ in found[measure]) for measure in MEASURES),
        geometric_mean(point.cost for point, _ in every),
        geometric_mean(point.error * point.cost for point, _ in every),
    )


def _candidate(scene: Scene, measure: Measure, name: str) -> tuple[Point, Standing]:
    """The best point of ours on a lattice in one scene, and the best standing that any of them has."""
    points = scene.points(measure)
    mine = [p for row, p in zip(scene.rows, points, strict=True) if is_ours(row) and lattice_of(row) == name]
    stands = {standing(point, points) for point in mine}
    return min(mine, key=lambda p: p.error * p.cost), next(one for one in Standing if one in stands)


def lattice_section(scenes: Sequence[Scene]) -> str:
    """The ranking as a table, and the best in a sentence; empty where ours has no lattice in every scene."""
    ranking = served(scenes)
    if not ranking:
        return ""
    fronts = len(MEASURES) * sum(any(map(is_ours, scene.rows)) for scene in scenes)
    lines = [
        [
            one.name,
            f"{one.fronts} of {fronts}",
            str(one.undecided),
            *(measure.shape.format(error) for measure, error in zip(MEASURES, one.errors, strict=True)),
            short(one.cost),
        ]
        for one in ranking
    ]
    headings = ["lattice", "on the front", "not to be told apart", *(measure.short for measure in MEASURES), "ms"]
    best, others = ranking[0], ranking[1:]
    equal = [one.name for one in others if one.fronts == best.fronts]
    sentence = BEST.format(
        best=best.name,
        on=best.fronts,
        all=fronts,
        ties=f", as {' and '.join(equal)}, and of these with the least error times cost" if equal else "",
        runner_up=f" Next is {others[0].name}, on {others[0].fronts}." if others and not equal else "",
    )
    return f"### Its lattice\n\n{sentence}\n\n{markdown_table(headings, lines)}"
