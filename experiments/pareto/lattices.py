"""Which lattice serves ours best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from experiments.markdown import table as markdown_table
from experiments.pareto.front import Point, Standing, standing
from experiments.pareto.points import MEASURES, Measure, Scene, geometric_mean, is_ours, positive
from experiments.studies.cells import Row, label
from experiments.studies.timing import short
from gpu_impl.techniques import SETTINGS

BEST = """The lattice and shadow map that serve ours best are **{best}**: on {on} of {all} fronts, {sure} of them for
sure{ties}.{runner_up}"""
NONE = """Ours is on no front on any lattice; the least error times cost has {best}."""
RANKING = """They are ranked by the fronts that they are on, each scene's by either measure, and those on as many by
error times cost, its geometric mean over scenes and measures: as much better for half the error as for half the time.
Where a front has several, the error or the time that one can afford decides.{dropped}"""
DROPPED = " Not ranked, as they have no numbers in some scene: {names}."
# settings that the words for a lattice and its shadow map have in them
WORDED = ("lattice", "downsample", "upsample", "shadow_map")


@dataclass(frozen=True)
class Served:
    """How well one lattice with one size of shadow map serves ours.

    Attributes
    ----------
    name : str
    fronts : int              that it is on, of the scenes' by each measure, for sure or by the medians
    sure : int                of those
    undecided : int           from which it is not to be told apart
    errors : tuple of float   geometric mean over the scenes, by measure
    cost : float              the same of the cost [ms]
    product : float           of error and cost, the mean over scenes and measures
    """

    name: str
    fronts: int
    sure: int
    undecided: int
    errors: tuple[float, ...]
    cost: float
    product: float


def name_of(row: Row) -> str:
    """A row's lattice and shadow map in words: which lattice, how coarse, how the grid fills the pixels between."""
    words = f"{row['lattice']}, N = {row['downsample']}"
    if row["lattice"] == "grid":
        words = "grid, every pixel" if row["downsample"] == 1 else f"{words}, {row['upsample']}"
    changed = label(row, *WORDED).removeprefix(label(row, *SETTINGS))
    return f"{words}, map {row['shadow_map']}{changed}"


def served(scenes: Sequence[Scene]) -> tuple[list[Served], list[str]]:
    """Every lattice with every map that ours ran with in each scene, the best first, and the names of the others."""
    found = [names for scene in scenes if (names := _candidates(scene))]
    with_ours = [scene for scene in scenes if _candidates(scene)]
    every = dict.fromkeys(name for names in found for name in names)
    ranked = [_served(name, with_ours) for name in every if all(name in names for names in found)]
    dropped = [name for name in every if any(name not in names for names in found)]
    return sorted(ranked, key=lambda one: (-one.fronts, one.product, one.name)), dropped


def _candidates(scene: Scene) -> dict[str, str]:
    """Lattices and maps of ours, and the labels of their rows."""
    return {name_of(row): label(row) for row in scene.rows if is_ours(row)}


def _served(name: str, scenes: Sequence[Scene]) -> Served:
    points: dict[Measure, list[Point]] = {measure: [] for measure in MEASURES}
    stands: list[Standing] = []
    for scene in scenes:
        wanted = _candidates(scene)[name]
        for measure, mine in points.items():
            every = scene.points(measure)
            (place,) = (place for place, point in enumerate(every) if point.name == wanted)
            stands.append(standing(every[place], every))
            mine.append(positive(every)[place])
    both = [point for mine in points.values() for point in mine]
    return Served(
        name,
        stands.count(Standing.FRONT) + stands.count(Standing.BY_MEDIAN),
        stands.count(Standing.FRONT),
        stands.count(Standing.UNDECIDED),
        tuple(geometric_mean(point.error for point in mine) for mine in points.values()),
        geometric_mean(point.cost for point in both),
        geometric_mean(point.error * point.cost for point in both),
    )


def lattice_section(scenes: Sequence[Scene]) -> str:
    """The ranking as a table, and the best in a sentence; empty where ours has no lattice in every scene."""
    ranking, dropped = served(scenes)
    if not ranking:
        return ""
    fronts = len(MEASURES) * sum(any(map(is_ours, scene.rows)) for scene in scenes)
    lines = [
        [
            one.name,
            f"{one.fronts} of {fronts}",
            str(one.sure),
            str(one.undecided),
            *(measure.shown(error) for measure, error in zip(MEASURES, one.errors, strict=True)),
            short(one.cost),
        ]
        for one in ranking
    ]
    headings = [
        "lattice and map",
        "on the front",
        "for sure",
        "not to be told apart",
        *(measure.short for measure in MEASURES),
        "ms",
    ]
    best, others = ranking[0], ranking[1:]
    equal = [one.name for one in others if one.fronts == best.fronts]
    sentence = BEST if best.fronts else NONE
    sentence = sentence.format(
        best=best.name,
        on=best.fronts,
        all=fronts,
        sure=best.sure,
        ties=f", as {' and '.join(equal)}, and of these with the least error times cost" if equal else "",
        runner_up=f" Next is {others[0].name}, on {others[0].fronts}." if others and not equal else "",
    )
    ranked_by = RANKING.format(dropped=DROPPED.format(names="; ".join(dropped)) if dropped else "")
    return f"### Its lattice\n\n{sentence} {ranked_by}\n\n{markdown_table(headings, lines)}"
