"""What a table of errors and costs says: the fronts, where ours stands, and which lattice serves it best."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from experiments.intervals import CONFIDENCE
from experiments.markdown import table as markdown_table
from experiments.measurements.timing import pass_column
from experiments.pareto.front import Missing, Point, Standing, front, missing, standing
from experiments.pareto.lattices import lattice_section
from experiments.pareto.points import MEASURES, Measure, Scene, is_ours, lacks, over_all, scenes_of
from experiments.studies.cells import Gaps, Row, label, span, values_of
from experiments.studies.timing import SOFTWARE, short
from gpu_impl.timing import PASSES, WALL_CLOCK

ALL = "all scenes"
INTRODUCTION = """Frames of {size}, surfaces and fog, drawn by {renderer} and timed by {clock}. {software}Each case
ran in {rounds} rounds with one baseline ({baseline}); a cost is the ratio of the two, times the baseline's median in
that scene, with the interval that holds it {confidence:.0%} of the time (sign test). {reference}

A technique with its settings is on the *front* if no other errs no more and costs no more. It is *not to be told
apart* from the front if another does, but none that errs no more is cheaper by its interval. All others are behind: one
that errs no more is surely cheaper. The fronts are taken once by {measures}."""
DETERMINISTIC = "The references are deterministic: errors have no noise."
NOISY = "The references have noise (relative standard errors of {noise}): errors of less are not told apart."
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


def text(rows: Sequence[Row]) -> str:
    """All of it, as Markdown."""
    scenes = [scene for scene in scenes_of(rows) if scene.rows]
    if not scenes:
        return f"No case has an error and a cost.\n\n{_every_case(rows)}"
    parts = [_introduction(scenes), "## The fronts", _fronts(scenes), "## Ours: `exact` x `quadrature`", verdict(rows)]
    if _has_ours(scenes):
        parts += [_stands(scenes), lattice_section(scenes)]
    return "\n\n".join([*parts, "## Every case", _every_case(rows)])


def verdict(rows: Sequence[Row]) -> str:
    """On how many fronts ours is, in one sentence."""
    scenes = [scene for scene in scenes_of(rows) if scene.rows]
    if not _has_ours(scenes):
        return NO_OURS
    on = {measure: [scene for scene in scenes if _best(scene, measure) == Standing.FRONT] for measure in MEASURES}
    counts = " and ".join(f"{len(mine)} of {len(scenes)} by {measure.short}" for measure, mine in on.items())
    return f"Ours is on the fronts of {counts}."


def _introduction(scenes: Sequence[Scene]) -> str:
    rows = [row for scene in scenes for row in scene.rows]

    def listed(column: str) -> str:
        return " and ".join(str(value) for value in values_of(rows, column))

    clock = listed("timing.clock")
    noise = [float(row["rel_error"]) for row in rows if float(row.get("rel_error") or 0) > 0]
    return INTRODUCTION.format(
        size=", ".join(sorted({f"{row['width']} x {row['height']}" for row in rows})),
        renderer=listed("gl_renderer"),
        clock=clock,
        software=SOFTWARE if WALL_CLOCK in clock else "",
        rounds=span((row["timing.rounds"] for row in rows), "{}"),
        baseline=listed("timing.baseline"),
        confidence=CONFIDENCE,
        reference=NOISY.format(noise=span(noise, "{:.2%}")) if noise else DETERMINISTIC,
        measures=" and once by ".join(f"*{measure.short}*, the {measure.what}" for measure in MEASURES),
    )


def _fronts(scenes: Sequence[Scene]) -> str:
    """A line a member of a front, cheapest first, and one for those that may be on it."""
    lines = []
    for measure in MEASURES:
        for name, points in _with_mean(scenes, measure):
            lines += [[name, measure.short, p.name, measure.shape.format(p.error), _cost(p)] for p in front(points)]
            undecided = [p.name for p in points if standing(p, points) == Standing.UNDECIDED]
            if undecided:
                lines.append([name, measure.short, f"*not to be told apart: {'; '.join(undecided)}*", "", ""])
    return markdown_table(["scene", "by", "technique", "error", "ms"], lines)


def _with_mean(scenes: Sequence[Scene], measure: Measure) -> Iterable[tuple[str, list[Point]]]:
    """Each scene's points, and their means over several."""
    for scene in scenes:
        yield scene.name, scene.points(measure)
    if len(scenes) > 1 and (means := over_all(scenes, measure)):
        yield ALL, means


def _cost(point: Point) -> str:
    return f"{short(point.cost)} [{short(point.low)}, {short(point.high)}]"


def _has_ours(scenes: Sequence[Scene]) -> bool:
    return any(is_ours(row) for scene in scenes for row in scene.rows)


def _ours(scene: Scene, measure: Measure) -> list[tuple[Row, Point]]:
    return [(row, p) for row, p in zip(scene.rows, scene.points(measure), strict=True) if is_ours(row)]


def _best(scene: Scene, measure: Measure) -> Standing | None:
    """Where the best of ours stands; None where the scene has none of ours."""
    points = scene.points(measure)
    found = {standing(point, points) for _, point in _ours(scene, measure)}
    return next((one for one in Standing if one in found), None)


def _stands(scenes: Sequence[Scene]) -> str:
    """A sentence or two a scene and measure."""
    lines = [f"- {_sentence(scene, measure)}" for scene in scenes for measure in MEASURES if _ours(scene, measure)]
    return "\n".join(lines)


def _sentence(scene: Scene, measure: Measure) -> str:
    points, ours = scene.points(measure), _ours(scene, measure)
    on = [point for _, point in ours if standing(point, points) == Standing.FRONT]
    if on:
        least = min(points, key=lambda point: (point.error, point.cost))
        return ON.format(
            scene=scene.name,
            short=measure.short,
            on=len(on),
            all=len(ours),
            names="; ".join(point.name for point in on),
            least=", and errs least of all" if least in on else f"; {least.name} errs least of all",
        )
    rows_lacking = [(row, point, lack) for row, point in ours if (lack := missing(point, points))]
    undecided = [one for one in rows_lacking if standing(one[1], points) == Standing.UNDECIDED]
    row, point, lack = min(undecided or rows_lacking, key=lambda one: one[2].factor)
    shared = {
        "scene": scene.name,
        "short": measure.short,
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
        where=_where_the_time_goes(row, lack, point),
    )


def _share(part: float, whole: float) -> str:
    return f"{part / whole:.3g}" if whole > 0 else "as much (0)"


def _where_the_time_goes(row: Row, lack: Missing, point: Point) -> str:
    """The longest pass beside what would have to be saved; empty where passes were not timed."""
    passes = {name: float(row.get(pass_column(name)) or 0.0) for name in PASSES}
    longest = max(passes, key=lambda name: passes[name])
    total = sum(passes.values())
    if not total > 0:
        return ""
    return (
        f"; of its time {passes[longest] / total:.0%} is the pass '{longest}', and {1 - lack.cost / point.cost:.0%} "
        "would have to go"
    )


def _every_case(rows: Sequence[Row]) -> str:
    """A line a case; where it has no numbers, why."""
    gaps, lines = Gaps(), []
    for scene in scenes_of(rows):
        by_measure = [scene.points(measure) for measure in MEASURES]
        for number, row in enumerate(scene.rows):
            points = [mine[number] for mine in by_measure]
            errors = [m.shape.format(p.error) for m, p in zip(MEASURES, points, strict=True)]
            where = [str(standing(p, mine)) for p, mine in zip(points, by_measure, strict=True)]
            lines.append([scene.name, label(row), *errors, _cost(points[0]), *where])
        lines += [[scene.name, label(row), *[gaps.because(lacks(row))] * (3 + len(MEASURES))] for row in scene.lacking]
    headings = [*(measure.short for measure in MEASURES), "ms", *(f"by {measure.short}" for measure in MEASURES)]
    return gaps.table(["scene", "technique", *headings], lines)
