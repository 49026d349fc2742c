"""`airlight benchmark reference`: measure the scenes, print what was found, and write it where asked to."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.table import Table
from rich.text import Text

from experiments.benchmark.measurement import Measurement, measure
from experiments.benchmark.page import write_page
from experiments.benchmark.summary import LINES, heading, method, numbers, verdict
from experiments.console import console, notices, plain_table, say
from scenes.model import Scene


def run_benchmark(
    scenes: Sequence[Scene], rel_error: float, volpath_spp: int, out: Path | None = None
) -> list[Measurement]:
    """Measure the scenes, print a table, and write page, tables and figure where asked to.

    Parameters
    ----------
    rel_error : float    of each pixel, at which the clock stops
    volpath_spp : int    samples a pixel that `volpath` takes at least, before it is extrapolated

    Raises
    ------
    InputError
        As `measure`; or the files cannot be written.
    """
    measurements = []
    with notices.status("benchmark") as status:
        for scene in scenes:

            def tell(what: str, name: str = scene.name) -> None:
                status.update(f"{name}: {what}")

            measurements.append(measure(scene, rel_error, volpath_spp, tell))
    console.print(benchmark_table(measurements))
    for measured in measurements:
        say(verdict(measured))
    if out:
        write_page(out, measurements)
        say(f"Benchmark: {(out / 'README.md').resolve()}")
    return measurements


def benchmark_table(measurements: Sequence[Measurement]) -> Table:
    """A column a scene."""
    table = plain_table(
        Text(
            f"To a relative standard error of {measurements[0].goal.rel_error:.2%}: medians over the pixels [quartiles]"
        )
    )
    table.add_column("", no_wrap=True)
    for measured in measurements:
        table.add_column(heading(measured), justify="right")
    columns = [numbers(measured) for measured in measurements]
    for name, cell in LINES.items():
        # as text: brackets are no markup here
        table.add_row(Text(name), *(Text(cell(column)) for column in columns))
    table.caption = method(measurements)
    return table
