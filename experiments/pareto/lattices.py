"""Which lattice serves ours best."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from experiments.markdown import table as markdown_table
from experiments.pareto.front import Point, Standing, standing
from experiments.pareto.points import MEASURES, Measure, Scene, geometric_mean, is_ours
from experiments.studies.cells import Row, label
from experiments.studies.timing import short

BEST = """The lattice that serves ours best is **{best}**: on {on} of {all} fronts{ties}.{runner_up} Lattices are ranked
by the fronts that they are on, each scene's by either measure, and those on as many by error times cost, its geometric
mean over scenes and measures: as much better for half the error as for half the time. Where a front has several, the
error or the time that one can afford decides."""


# settings that say on which lattice
LATTICE = ("lattice", "downsample", "upsample")


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
    """Every lattice that ours ran on in each scene, with one set of other settings, the best first."""
    ours = [[row for row in scene.rows if is_ours(row)] for scene in scenes]
    with_ours = [scene for scene, rows in zip(scenes, ours, strict=True) if rows]
    # that of the most rows: shadow maps of other sizes, say, ran on the full grid alone
    counted = Counter(label(row, *LATTICE) for rows in ours for row in rows)
    if not counted:
        return []
    settings = counted.most_common(1)[0][0]
    names = [dict.fromkeys(_candidates(scene, settings)) for scene in with_ours]
    everywhere = [name for name in names[0] if all(name in found for found in names)]
    found = (_served(name, settings, with_ours) for name in everywhere)
    return sorted(found, key=lambda one: (-one.fronts, one.product, one.name))


def _candidates(scene: Scene, settings: str) -> dict[str, str]:
    """The lattices of ours with these other settings, and the labels of their rows."""
    mine = [row for row in scene.rows if is_ours(row) and label(row, *LATTICE) == settings]
    return {lattice_of(row): label(row) for row in mine}


def _served(name: str, settings: str, scenes: Sequence[Scene]) -> Served:
    points: dict[Measure, list[Point]] = {measure: [] for measure in MEASURES}
    stands: list[Standing] = []
    for scene in scenes:
        wanted = _candidates(scene, settings)[name]
        for measure, mine in points.items():
            every = scene.points(measure)
            mine += [point for point in every if point.name == wanted]
            stands.append(standing(mine[-1], every))
    both = [point for mine in points.values() for point in mine]
    return Served(
        name,
        stands.count(Standing.FRONT),
        stands.count(Standing.UNDECIDED),
        tuple(geometric_mean(point.error for point in mine) for mine in points.values()),
        geometric_mean(point.cost for point in both),
        geometric_mean(point.error * point.cost for point in both),
    )


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
