"""What a table of errors and costs says: the fronts, where ours stands, which lattice serves it best, every case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from experiments.intervals import CONFIDENCE
from experiments.markdown import table as markdown_table
from experiments.measurements.same_surface import ALIKE
from experiments.pareto.front import Point, Standing, front, standing
from experiments.pareto.lattices import lattice_section
from experiments.pareto.ours import stands, verdict
from experiments.pareto.points import ALL, MEASURES, Measure, Scene, lacks, over_all, scenes_of
from experiments.studies.cells import Gaps, Row, label, span, values_of
from experiments.studies.timing import SOFTWARE, short
from gpu_impl.timing import WALL_CLOCK

INTRODUCTION = """Frames of {size}, surfaces and fog, drawn by {renderer} and timed by {clock}. {software}Each case
ran in {rounds} rounds with one baseline ({baseline}); a cost is the ratio of the two, times the baseline's median in
that scene, with the interval that holds it {confidence:.0%} of the time (sign test). Other processes kept {others}
processors busy meanwhile (median and most over the cases). {reference}

Errors are taken over the pixels in which technique and reference see the same surface, by depths within {alike:.0%}:
{apart}. The others see what is in front in one and what is behind in the other, in which no technique has any
part.{zeros}

A technique with its settings is on the *front* if no other errs no more and costs no more: *by the median* where one
that errs no more may cost as little by the intervals of both, and for sure where none may. It is *not to be told
apart* from the front if another does, but none that errs no more is cheaper by its interval. All others are behind: one
that errs no more is surely cheaper. The fronts are taken once by {measures}."""
DETERMINISTIC = "The references are deterministic: errors have no noise, and nothing is taken off them."
ZEROS = """ An error of 0 counts in means as half of the least other one of its scene."""
NOISY = "The references have noise (relative standard errors of {noise}), and of errors below it nothing is known."


def text(rows: Sequence[Row]) -> str:
    """All of it, as Markdown."""
    scenes = [scene for scene in scenes_of(rows) if scene.rows]
    if not scenes:
        return f"No case has an error and a cost.\n\n{_every_case(rows)}"
    parts = [
        _introduction(scenes),
        "## The fronts",
        _fronts(scenes),
        "## Ours: `exact` x `quadrature`",
        verdict(scenes),
        stands(scenes),
        lattice_section(scenes),
        "## Every case",
        _every_case(rows),
    ]
    return "\n\n".join(filter(None, parts))


def _introduction(scenes: Sequence[Scene]) -> str:
    rows = [row for scene in scenes for row in scene.rows]

    def listed(column: str) -> str:
        return " and ".join(str(value) for value in values_of(rows, column))

    clock, others = listed("timing.clock"), sorted(row["timing.others"] for row in rows)
    noise = [float(row["rel_error"]) for row in rows if "deterministic" not in row["estimator"]]
    return INTRODUCTION.format(
        size=", ".join(sorted({f"{row['width']} x {row['height']}" for row in rows})),
        renderer=listed("gl_renderer"),
        clock=clock,
        software=SOFTWARE if WALL_CLOCK in clock else "",
        rounds=span((row["timing.rounds"] for row in rows), "{}"),
        baseline=listed("timing.baseline"),
        confidence=CONFIDENCE,
        others=f"{others[len(others) // 2]:.2f} and {others[-1]:.2f}",
        alike=ALIKE,
        apart=f"{span((row['same_surface.others'] for row in rows), '{}')} pixels of a picture are left out",
        zeros=ZEROS if any(row[measure.column] == 0 for row in rows for measure in MEASURES) else "",
        reference=NOISY.format(noise=span(noise, "{:.2%}")) if noise else DETERMINISTIC,
        measures=" and once by ".join(f"*{measure.short}*, the {measure.what}" for measure in MEASURES),
    )


def _fronts(scenes: Sequence[Scene]) -> str:
    """A line a member of a front, cheapest first, and one for those that may be on it."""
    lines = []
    for measure in MEASURES:
        for name, points in _with_mean(scenes, measure):
            lines += [[name, measure.short, p.name, measure.shown(p.error), _cost(p)] for p in front(points)]
            undecided = [p.name for p in points if standing(p, points) == Standing.UNDECIDED]
            if undecided:
                lines.append([name, measure.short, f"*not to be told apart: {'; '.join(undecided)}*", "", ""])
    return markdown_table(["scene", "by", "technique", "error", "ms"], lines)


def _with_mean(scenes: Sequence[Scene], measure: Measure) -> Iterator[tuple[str, list[Point]]]:
    """Each scene's points, and their means over several."""
    for scene in scenes:
        yield scene.name, scene.points(measure)
    if len(scenes) > 1 and (means := over_all(scenes, measure)):
        yield ALL, means


def _cost(point: Point) -> str:
    return f"{short(point.cost)} [{short(point.low)}, {short(point.high)}]"


def _every_case(rows: Sequence[Row]) -> str:
    """A line a case; where it has no numbers, why."""
    gaps, lines = Gaps(), []
    for scene in scenes_of(rows):
        by_measure = [scene.points(measure) for measure in MEASURES]
        for number, row in enumerate(scene.rows):
            points = [mine[number] for mine in by_measure]
            errors = [m.shown(p.error) for m, p in zip(MEASURES, points, strict=True)]
            where = [str(standing(p, mine)) for p, mine in zip(points, by_measure, strict=True)]
            lines.append([scene.name, label(row), *errors, _cost(points[0]), *where])
        lines += [
            [scene.name, label(row), *[gaps.because(lacks(row))] * (1 + 2 * len(MEASURES))] for row in scene.lacking
        ]
    headings = [*(measure.short for measure in MEASURES), "ms", *(f"by {measure.short}" for measure in MEASURES)]
    return gaps.table(["scene", "technique", *headings], lines)
