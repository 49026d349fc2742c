"""Where the project's own cell stands: on which fronts, or what keeps it from them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from experiments.measurements.timing import pass_column
from experiments.pareto.front import Missing, Point, Standing, missing, standing
from experiments.pareto.points import ALL, MEASURES, Measure, Scene, is_ours, over_all
from experiments.studies.cells import Row, label
from experiments.studies.timing import short
from gpu_impl.timing import PASSES

ON = "**{scene}**, by {short}: ours is on the front in {on} of {all} settings ({names}){least}."
UNDECIDED = (
    "**{scene}**, by {short}: ours is not on the front, but {name} is not to be told apart from it: {by} errs {error} "
    "of it in {cost} of its time, and the interval of its own cost, {low} to {high} ms, reaches as low."
)
BEHIND = (
    "**{scene}**, by {short}: ours is behind. The nearest is {name}, with an error of {mine} in {ms} ms; {by} errs "
    "{error} of it in {cost} of its time. It would be on the front with that error in less than {least_ms} ms, or with "
    "an error below {least_error} in the same time{where}."
)
NO_OURS = "No case of exact x quadrature has all its numbers: nothing is said of ours."


def verdict(scenes: Sequence[Scene]) -> str:
    """On how many fronts ours is, in one sentence."""
    of_ours = [scene for scene in scenes if _rows(scene)]
    if not of_ours:
        return NO_OURS
    on = {measure: sum(_is_on(scene, measure) for scene in of_ours) for measure in MEASURES}
    counts = " and ".join(f"{count} of {len(of_ours)} by {measure.short}" for measure, count in on.items())
    return f"Ours is on the fronts of {counts}."


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


def _is_on(scene: Scene, measure: Measure) -> bool:
    points, names = scene.points(measure), _rows(scene)
    return any(point.name in names and standing(point, points) == Standing.FRONT for point in points)


def _sentence(scene: str, measure: Measure, points: Sequence[Point], rows: Mapping[str, Row]) -> str:
    ours = [point for point in points if point.name in rows]
    shared = {"scene": scene, "short": measure.short}
    on = [point for point in ours if standing(point, points) == Standing.FRONT]
    if on:
        least = min(points, key=lambda point: (point.error, point.cost))
        words = ", and errs least of all" if least in on else f"; {least.name} errs least of all"
        names = "; ".join(point.name for point in on)
        return ON.format(**shared, on=len(on), all=len(ours), names=names, least=words)
    undecided = [point for point in ours if standing(point, points) == Standing.UNDECIDED]
    lacking = [(point, lack) for point in undecided or ours if (lack := missing(point, points))]
    point, lack = min(lacking, key=lambda one: one[1].factor)
    shared |= {
        "name": point.name,
        "by": lack.by.name,
        "error": _share(lack.by.error, point.error),
        "cost": _share(lack.by.cost, point.cost),
    }
    if undecided:
        return UNDECIDED.format(**shared, low=short(point.low), high=short(point.high))
    return BEHIND.format(
        **shared,
        mine=measure.shape.format(point.error),
        ms=short(point.cost),
        least_ms=short(lack.cost),
        least_error=measure.shape.format(lack.error),
        where=_where_the_time_goes(rows[point.name], lack, point),
    )


def _share(part: float, whole: float) -> str:
    """A part of a whole; all of one that is 0."""
    return f"{part / whole:.3g}" if whole > 0 else "1"


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
