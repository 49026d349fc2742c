"""`airlight benchmark techniques`: references first, then the clocks, then what is printed and written."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from rich.table import Table
from rich.text import Text

from experiments.console import console, notices, plain_table, say
from experiments.technique_benchmark.contenders import ERROR_LIMITS, Contender, published_rate
from experiments.technique_benchmark.measurement import Result, measure_scene
from experiments.technique_benchmark.page import write_page
from experiments.technique_benchmark.summary import fastest, is_within
from experiments.technique_benchmark.tables import title
from experiments.terminal import announce_reference
from reference.estimate import estimate_reference
from reference.goal import Goal
from scenes.model import Scene

# Where Mesa and NVIDIA keep compiled shaders on disk, compiling would be timed on the first run of a machine only.
NO_SHADER_CACHE = {"MESA_SHADER_CACHE_DISABLE": "true", "__GL_SHADER_DISK_CACHE": "0"}


def run_benchmark(
    scenes: Sequence[Scene],
    contenders: Sequence[Contender],
    rounds: int,
    goal: Goal,
    options: Mapping[str, object],
    out: Path | None = None,
) -> list[Result]:
    """Estimate all references, then measure scene by scene; print a table, and write the page where asked to.

    The page is written after each scene, so that whoever stops the rest keeps what is measured.

    Parameters
    ----------
    rounds : int      that count
    goal : Goal       of the references
    options : dict    of the command line, for the page

    Raises
    ------
    InputError
        A reference cannot be estimated, there is no OpenGL, or the files cannot be written.
    """
    os.environ.update(NO_SHADER_CACHE)
    results, references = [], []
    with notices.status("benchmark") as status:
        for scene in scenes:
            status.update(f"{scene.name}, {scene.phase.name}: reference")
            references.append(estimate_reference(scene, goal))
        for scene, reference in zip(scenes, references, strict=True):
            announce_reference(reference)

            def tell(what: str, name: str = f"{scene.name}, {scene.phase.name}") -> None:
                status.update(f"{name}: {what}")

            results.append(measure_scene(scene, reference, rounds, tell, contenders))
            if out:
                write_page(out, results, scenes, options)
    console.print(rates(results))
    if out:
        say(f"Benchmark: {(out / 'README.md').resolve()}")
    return results


def rates(results: Sequence[Result]) -> Table:
    """Time and error of every contender; a star for the fast row of a scene where it keeps the limits."""
    table = plain_table(Text("Milliseconds a frame, and the error of the scattering layer"))
    table.add_column("scene", overflow="fold")
    table.add_column("contender", overflow="fold")
    for heading in ("ms", "of the march", "frames/s", "median", "95 %"):
        table.add_column(heading, justify="right", no_wrap=True)
    starred = False
    for result in results:
        best = fastest(result)
        starred |= best is not None and is_within(best)
        for name, one in result.contenders.items():
            if one.refusal or not one.metrics:
                continue
            median = float(np.median(one.times.milliseconds))
            errors = (one.metrics.rel_50, one.metrics.rel_95)
            table.add_row(
                title(result),
                Text(f"{name}{' *' if one is best and is_within(one) else ''}"),
                f"{median:.1f}",
                f"{float(np.median(result.ratios(name))):.3f}",
                f"{1e3 / median:.1f}",
                *("" if error is None else f"{error:.2%}" for error in errors),
            )
        if published := published_rate(result.scene):
            table.add_row(title(result), "Table 5.1, on other hardware", "", "", str(published), "", "")
    limits = f"{ERROR_LIMITS[0]:.0%} (median) and {ERROR_LIMITS[1]:.0%} (95th percentile)"
    star = f"* the fast row, off by at most {limits}. " if starred else ""
    table.caption = f"{star}Passes by {results[0].clock}."
    return table
