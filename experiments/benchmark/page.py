"""What `airlight benchmark reference --out` writes: a page, two tables and a figure."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import polars

from experiments.atlas.timing import processor
from experiments.benchmark.efficiency import quartiles
from experiments.benchmark.figure import draw_figure
from experiments.benchmark.measurement import Measurement
from experiments.benchmark.summary import LINES, heading, method, numbers, verdict
from experiments.pages import made_by
from experiments.provenance import describe_scene
from reference.goal import FEWEST_PASSES
from scenes.replacing import replacing

TITLE = "What a reference costs"
PAGE = """# {title}

{made} On {processor}.

Seconds until a pixel's airlight is known to a relative standard error of {goal:.2%}: the main estimator, as
`airlight reference` runs it, and Mitsuba's `volpath` with one scattering event, in the same run, a pass of one after a
pass of the other, both compiled before. Medians and in brackets quartiles over the pixels with airlight.

{table}

{verdicts}

![Error against time](error_against_time.png)

{method}

[results.csv](results.csv) holds all numbers, [strata.csv](strata.csv) those of the curve over strata.
"""


def write_page(folder: Path, measurements: Sequence[Measurement]) -> None:
    """Write results.csv, strata.csv, error_against_time.png and README.md, over those that are there.

    Raises
    ------
    InputError
        The files cannot be written.
    """
    command = command_line(measurements, folder)
    made = [describe_scene(measured.scene) for measured in measurements]
    rows = [{**about, **numbers(measured)} for about, measured in zip(made, measurements, strict=True)]
    for name, table in (("results.csv", rows), ("strata.csv", _strata(measurements))):
        with replacing(folder / name) as beside:
            polars.DataFrame(table).write_csv(beside)
    below = f"{command}; commit {made[0]['commit']}, {made[0]['date'][:10]}; {processor()}"
    draw_figure(folder / "error_against_time.png", measurements, below)
    text = PAGE.format(
        title=TITLE,
        made=made_by(command, "mitsuba", "drjit", "numpy"),
        processor=processor(),
        goal=measurements[0].goal.rel_error,
        table="\n".join(_table(measurements)),
        verdicts="\n".join(f"- {verdict(measured)}" for measured in measurements),
        method=method(measurements),
    )
    with replacing(folder / "README.md") as beside:
        beside.write_text(text, encoding="utf-8")


def command_line(measurements: Sequence[Measurement], out: Path) -> str:
    """The command that makes the page again."""
    first = measurements[0]
    shipped = [
        one.scene.name if one.scene.path.parent.name == "scenes" else str(one.scene.path) for one in measurements
    ]
    size = ["--size", str(first.scene.camera.width), str(first.scene.camera.height)]
    error = ["--rel-error", f"{first.goal.rel_error:g}"]
    samples = ["--volpath-spp", str(first.volpath_samples * FEWEST_PASSES)]
    return shlex.join(["airlight", "benchmark", "reference", *shipped, *size, *error, *samples, "--out", str(out)])


def _table(measurements: Sequence[Measurement]) -> list[str]:
    columns = [numbers(measured) for measured in measurements]
    lines = [f"| | {' | '.join(map(heading, measurements))} |", "|---" * (len(columns) + 1) + "|"]
    return lines + [f"| {name} | {' | '.join(map(cell, columns))} |" for name, cell in LINES.items()]


def _strata(measurements: Sequence[Measurement]) -> list[dict[str, Any]]:
    rows = []
    for measured in measurements:
        for one in measured.strata:
            low, middle, high = quartiles(one.deviation)
            about = {"scene": measured.scene.name, "strata": one.strata, "pass_seconds": one.seconds}
            rows.append({**about, "deviation_25": low, "deviation_50": middle, "deviation_75": high})
    return rows
