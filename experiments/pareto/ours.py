"""Where the project's own cell stands: on which fronts, or what keeps it from them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from experiments.measurements.timing import pass_column
from experiments.pareto.front import Missing, Point, Standing, missing, standing
from experiments.pareto.points import ALL, MEASURES, Measure, Scene, is_ours, over_all
from experiments.studies.cells import Row, label
from experiments.studies.timing import short
from gpu_impl.timing import PASSES

ON = (
    "**{scene}**, by {short}: ours is on the front in {on} of {all} settings, {sure} of them for sure ({names}){least}."
)
UNDECIDED = (
    "**{scene}**, by {short}: ours is not on the front, but {name} is not to be told apart from it: {by} errs {error} "
    "in {cost} of its time, and the interval of its own cost, {low} to {high} ms, reaches as low."
)
BEHIND = (
    "**{scene}**, by {short}: ours is behind. The nearest is {name}, with an error of {mine} in {ms} ms; {by} errs "
    "{error} in {cost} of its time. It would be on the front with that error in less than {least_ms} "
    "ms{or_error}{where}."
)
# for sure, and by the medians
ON_FRONT = (Standing.FRONT, Standing.BY_MEDIAN)
NO_OURS = "No case of exact x quadrature has all its numbers: nothing is said of ours."


def verdict(scenes: Sequence[Scene]) -> str:
    """On how many fronts ours is, in one sentence."""
    of_ours = [scene for scene in scenes if _rows(scene)]
    if not of_ours:
        return NO_OURS
    counts = []
    for measure in MEASURES:
        on, sure = (sum(_is_on(scene, measure, among) for scene in of_ours) for among in (ON_FRONT, ON_FRONT[:1]))
        counts.append(f"{on} of {len(of_ours)} by {measure.short}, {sure} of them for sure")
    return f"Ours is on the fronts of {'; and of '.join(counts)}."


def stands(scenes: Sequence[Scene]) -> str:
    """A sentence or two a scene and measure, and for the means over several scenes."""
    return "\n".join(f"- {sentence}" for sentence in _sentences(scenes))


def _sentences(scenes: Sequence[Scene]) -> Iterator[str]:
    for scene in scenes:
        for measure in MEASURES:
            if rows := _rows(scene):
                yield _sentence(scene.name, measure, scene.points(measure), rows)
    for measure in MEASURES if len(scenes) > 1 else ():
        points = over_all(scenes, measure)
        # passes of several scenes have no one row
        rows = {name: {} for scene in scenes for name in _rows(scene) if name in {point.name for point in points}}
        if rows:
            yield _sentence(ALL, measure, points, rows)


def _rows(scene: Scene) -> dict[str, Row]:
    """The rows of ours by their names."""
    return {label(row): row for row in scene.rows if is_ours(row)}


def _is_on(scene: Scene, measure: Measure, among: Sequence[Standing]) -> bool:
    points, names = scene.points(measure), _rows(scene)
    return any(point.name in names and standing(point, points) in among for point in points)


def _sentence(scene: str, measure: Measure, points: Sequence[Point], rows: Mapping[str, Row]) -> str:
    ours = [point for point in points if point.name in rows]
    shared = {"scene": scene, "short": measure.short}
    on = {point.name: where for point in ours if (where := standing(point, points)) in ON_FRONT}
    if on:
        sure = sum(where == Standing.FRONT for where in on.values())
        return ON.format(
            **shared, on=len(on), all=len(ours), sure=sure, names="; ".join(on), least=_errs_least(points, on)
        )
    undecided = [point for point in ours if standing(point, points) == Standing.UNDECIDED]
    lacking = [(point, lack) for point in undecided or ours if (lack := missing(point, points))]
    point, lack = min(lacking, key=lambda one: one[1].factor)
    shared |= {
        "name": point.name,
        "by": lack.by.name,
        "error": "as much" if lack.by.error == point.error else f"{lack.by.error / point.error:.3g} of it",
        "cost": f"{lack.by.cost / point.cost:.3g}",
    }
    if undecided:
        return UNDECIDED.format(**shared, low=short(point.low), high=short(point.high))
    return BEHIND.format(
        **shared,
        mine=measure.shown(point.error),
        ms=short(point.cost),
        least_ms=short(lack.cost),
        # no error is below 0
        or_error=f", or with an error below {measure.shown(lack.error)} in the same time" if lack.error > 0 else "",
        where=_where_the_time_goes(rows[point.name], lack, point),
    )


def _errs_least(points: Sequence[Point], on: Mapping[str, Standing]) -> str:
    """Whose error is the least: ours on the front, somebody else's, or several's."""
    least = min(point.error for point in points)
    names = [point.name for point in sorted(points, key=lambda point: point.cost) if point.error == least]
    others = "; ".join(name for name in names if name not in on)
    if not others:
        return ", and errs least of all"
    if len(names) == 1:
        return f"; {others} errs least of all"
    mine = any(name in on for name in names)
    return f"; none errs less, and {others} as little" if mine else f"; {others} err least of all"


def _where_the_time_goes(row: Row, lack: Missing, point: Point) -> str:
    """The longest pass beside what would have to be saved; empty where passes were not timed."""
    passes = {name: float(row.get(pass_column(name)) or 0.0) for name in PASSES}
    longest, total = max(passes, key=lambda name: passes[name]), sum(passes.values())
    if not total > 0:
        return ""
    return (
        f"; of its time {passes[longest] / total:.0%} is the pass '{longest}', and {1 - lack.cost / point.cost:.0%} "
        "would have to go"
    )
