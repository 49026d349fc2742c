"""What `airlight benchmark techniques --out` writes: a page, two tables and a figure."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import polars

from experiments.atlas.timing import processor
from experiments.intervals import CONFIDENCE
from experiments.pages import made_by
from experiments.provenance import commit, scene_file
from experiments.technique_benchmark.contenders import BASELINE, ERROR_LIMITS, FAST, STEPS
from experiments.technique_benchmark.figure import draw_figure
from experiments.technique_benchmark.measurement import Result
from experiments.technique_benchmark.summary import Row, pair_rows, rows
from experiments.technique_benchmark.tables import contenders_table, pairs_table, passes_table, rates_table, title
from gpu_impl.device import shared_device
from scenes.model import Scene
from scenes.replacing import replacing

TITLE = "What the techniques cost"
PAGE = """# {title}

{made} On {processor}; OpenGL {gl_version} on {renderer}.{progress}

Frames of {width} x {height}, surfaces and fog, in which eye and lights move from frame to frame, so that none reuses
another.{decimated} {rounds} rounds run every contender once, in an order drawn anew; medians over them, in brackets
quartiles. A ratio is of two frames of the same round, the median over the rounds, in brackets the interval that holds
it {confidence:.0%} of the time (sign test).

{sections}

{stand_ins}[results.csv](results.csv) holds all numbers{pairs_file}.
"""
RATES = """## Beside Table 5.1

{rates}

The last column of frames a second is Weng 2010's, on a GeForce 9800 GT of 2008 at 1024 x 1024 with meshes of other
sizes. This is other hardware, so the two columns say nothing about each other's method; the thesis's is what was called
real-time, and a goal. The fast row is the quickest of those that evaluate the fog on every {downsample}th pixel with
{steps} samples, where there is one of those whose scattering is off by at most {median:.0%} (median) and {worst:.0%}
(95th percentile). Errors are of the picture at rest; the frames that are timed are of the scene in motion, which is
another picture each time."""
PASSES_OF_FAST = """## Pass by pass

The fast rows [ms], by {clock}. "frame, clocked" is the wall clock of a frame with that clock running, "frame" without
it, and which of the two comes first changes from round to round: over all contenders the first is {overhead} times the
second (median).

{passes}"""
CLAIMS = """## The thesis's claims, in pairs

{pairs}

Of {intervals} intervals of {confidence:.0%} here, frames' and passes', about one in twenty is expected to exclude 1 by
chance where there is no difference. A frame has the shadow polygons in it, which bound the region and which a march of
the whole ray does without; the scattering pass alone has not. "as dense": with as many samples as make the average
spacing that of the shadow region's samples, over the rays that have a shadow region. "same work": both models counted
the same evaluations, so that the scene says nothing about the claim; three and four evaluations of Ei are two where no
lit piece contains the light's projection on its ray."""
EVERY = """## Every contender

`{baseline}` is a brute-force march of {steps} point samples at full resolution. Errors are those of the scattering
layer of the picture at rest, at the size that is timed, of pixels with airlight, against a reference that was estimated
before (relative standard error {reference}). Counts are means over the rays that are evaluated: lit pieces handed to
the airlight model, texels read from the shadow map, exponential integrals, exponentials (a colour's are three). Kept:
what a technique holds on the GPU from one frame to the next beside meshes and pictures. In a frame: the most that it
holds beside that. Compile: what its shaders take the first time, with the driver's cache on disk switched off. Set-up:
what the first frame of a scene takes beyond later ones, adjacency of the meshes included; not in it is what every
technique needs, the meshes' upload and the search for those that are closed, whose far sides are never drawn.

![ms of each pass](passes.png)

Bars: the passes, by {clock}; the tick: the frame without that clock; dotted: `{baseline}`.

{scenes}"""


def write_page(folder: Path, results: Sequence[Result], scenes: Sequence[Scene], options: Mapping[str, object]) -> None:
    """Write results.csv, pairs.csv, passes.png and README.md, over those that are there; no pairs.csv without pairs.

    Parameters
    ----------
    results : of the scenes that are measured so far
    scenes : all that are to be measured
    options : of the command line and their values, as `command_line` takes them

    Raises
    ------
    InputError
        The files cannot be written.
    """
    line, info = command_line(scenes, options, folder), shared_device().info
    every, pairs = [rows(result) for result in results], [row for result in results for row in pair_rows(result)]
    flat = [row for table in every for row in table]
    for name, table in (("results.csv", flat), ("pairs.csv", pairs)):
        if table:
            with replacing(folder / name) as beside:
                polars.DataFrame(table, infer_schema_length=None).write_csv(beside)
        else:
            (folder / name).unlink(missing_ok=True)
    draw_figure(folder / "passes.png", results, f"{line}; commit {commit()}; {info.renderer}, {processor()}")
    camera, budget = scenes[0].camera, options.get("triangles")
    stand_ins = sorted({name for result in results for name in result.scene.stand_ins})
    text = PAGE.format(
        title=TITLE,
        made=made_by(line, "moderngl", "mitsuba", "drjit", "numpy"),
        processor=processor(),
        renderer=info.renderer,
        gl_version=info.version,
        progress="" if len(results) == len(scenes) else f" So far {len(results)} of {len(scenes)} cases are measured.",
        width=camera.width,
        height=camera.height,
        decimated=f" Meshes are decimated to {budget:,} triangles where a scene has more." if budget else "",
        rounds=next(row["rounds"] for row in flat if not row["refusal"]),
        confidence=CONFIDENCE,
        sections="\n\n".join(_sections(results, flat, len(pairs))),
        stand_ins=f"* Procedural stand-ins serve for {', '.join(stand_ins)}.\n\n" if stand_ins else "",
        pairs_file=", [pairs.csv](pairs.csv) those of the pairs" if pairs else "",
    )
    with replacing(folder / "README.md") as beside:
        beside.write_text(text, encoding="utf-8")


def _sections(results: Sequence[Result], flat: Sequence[Row], pairs: int) -> Iterator[str]:
    """The sections of which there is something to say."""
    drawn = [row for row in flat if not row["refusal"]]
    if rates := rates_table(results):
        median, worst = ERROR_LIMITS
        yield RATES.format(rates=rates, downsample=FAST["downsample"], steps=STEPS, median=median, worst=worst)
    clock = results[0].clock
    if passes := passes_table(results):
        overhead = _span([row["clocked_over_plain"] for row in drawn], "{:.2f}")
        yield PASSES_OF_FAST.format(clock=clock, overhead=overhead, passes=passes)
    if pairs:
        # of the frame and of its scattering pass
        yield CLAIMS.format(pairs=pairs_table(results), intervals=2 * pairs, confidence=CONFIDENCE)
    yield EVERY.format(
        baseline=BASELINE.name,
        steps=STEPS,
        clock=clock,
        reference=_span([row["reference_error"] for row in drawn], "{:.2%}"),
        scenes="\n\n".join(f"### {title(result)}\n\n{contenders_table(result)}" for result in results),
    )


def command_line(scenes: Sequence[Scene], options: Mapping[str, object], out: Path) -> str:
    """The command that makes the page again; an option that is None was not given."""
    words = ["airlight", "benchmark", "techniques", *dict.fromkeys(map(scene_file, scenes))]
    for name, value in options.items():
        values = value if isinstance(value, list) else [value]
        # a tuple is one option's several words
        words += [
            str(word)
            for one in values
            if one is not None
            for word in (f"--{name}", *(one if isinstance(one, tuple) else [one]))
        ]
    return shlex.join([*words, "--out", str(out)])


def _span(values: Sequence[float], shape: str) -> str:
    """The least and the most."""
    least, most = shape.format(min(values)), shape.format(max(values))
    return least if least == most else f"{least} to {most}"
