"""`airlight benchmark`: what things cost, each measured beside what it is compared with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from experiments.options import SCENE_HELP, TYPER_STYLE
from experiments.termination import terminated_cleanly
from reference.goal import FEWEST_PASSES, Goal

benchmark_app = typer.Typer(name="benchmark", help="Measure what things cost.", **TYPER_STYLE)

SCENES = ["sphere", "donut_dragon", "yeahright"]


@benchmark_app.command()
def reference(
    scene: Annotated[
        list[str] | None,
        typer.Argument(metavar="SCENE", help=f"{SCENE_HELP} By default {', '.join(SCENES)}.", show_default=False),
    ] = None,
    size: Annotated[tuple[int, int], typer.Option("--size", metavar="W H", help="Image size in pixels.")] = (256, 256),
    rel_error: Annotated[float, typer.Option(help="Relative standard error of each pixel's airlight.")] = 0.005,
    volpath_spp: Annotated[
        int, typer.Option(min=FEWEST_PASSES, max=1 << 16, help="Samples a pixel that volpath takes at least.")
    ] = 1024,
    out: Annotated[Path | None, typer.Option(help="Folder for the page, the tables and the figure.")] = None,
) -> None:
    """Time the reference's estimator against Mitsuba's volpath, pixel by pixel, and say what limits it.

    Five minutes on two quiet cores.

    Example: airlight benchmark reference --out results/reference_benchmark
    """
    import airlight
    from experiments.benchmark.report import run_benchmark
    from experiments.pages import prepare_page
    from experiments.terminal import announce_scene

    # refused before the work
    Goal(rel_error)
    if out:
        from experiments.benchmark.page import TITLE

        prepare_page(out, TITLE)
    loaded = [airlight.load(name, size) for name in scene or SCENES]
    for one in loaded:
        announce_scene(one)
    with terminated_cleanly():
        run_benchmark(loaded, rel_error, volpath_spp, out)
