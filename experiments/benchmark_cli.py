"""`airlight benchmark`: what things cost, each measured beside what it is compared with."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from experiments.options import SCENE_HELP, TYPER_STYLE, Parameters, parse_parameters
from experiments.termination import terminated_cleanly
from reference.goal import FEWEST_PASSES, Goal
from scenes.errors import InputError

if TYPE_CHECKING:
    from scenes.model import Scene

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


@benchmark_app.command()
def techniques(
    scene: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SCENE",
            help=f"{SCENE_HELP} By default those of Table 5.1 and wire_mesh.",
            show_default=False,
        ),
    ] = None,
    size: Annotated[tuple[int, int], typer.Option("--size", metavar="W H", help="Image size in pixels.")] = (
        1024,
        1024,
    ),
    phase: Annotated[
        list[str] | None,
        typer.Option(help="Phase function; repeatable. By default isotropic and rayleigh.", show_default=False),
    ] = None,
    parameter: Parameters = None,
    contender: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME", help="Row of the table beside the march; repeatable. By default all.", show_default=False
        ),
    ] = None,
    frames: Annotated[
        int, typer.Option(min=6, max=1000, help="Rounds that count, in each of which every technique draws a frame.")
    ] = 15,
    triangles: Annotated[
        int | None, typer.Option(min=1, help="Decimate each scene's meshes to about so many triangles in all.")
    ] = None,
    rel_error: Annotated[float, typer.Option(help="Relative standard error of the references' airlight.")] = 0.01,
    out: Annotated[Path | None, typer.Option(help="Folder for the page, the tables and the figure.")] = None,
) -> None:
    """Time the techniques beside a brute-force march in the same rounds, with the error, work and memory of each.

    References are estimated first; nothing else should run on the machine meanwhile.

    Example: airlight benchmark techniques dragon --size 512 512 --phase isotropic --out results/technique_benchmark
    """
    from experiments.pages import prepare_page
    from experiments.technique_benchmark.contenders import SCENES as THESIS_SCENES
    from experiments.technique_benchmark.contenders import chosen
    from experiments.technique_benchmark.report import run_benchmark
    from experiments.terminal import announce_scene

    # refused before the work
    goal, contenders = Goal(rel_error), chosen(contender)
    if out:
        from experiments.technique_benchmark.page import TITLE

        prepare_page(out, TITLE)
    settings = parse_parameters(parameter)
    if "phase" in settings:
        raise InputError(f"-p phase={settings['phase']}: give it as --phase {settings['phase']}.")
    phases = phase or ["isotropic", "rayleigh"]
    loaded = [
        _load(name, triangles, size, {**settings, "phase": one}) for name in scene or THESIS_SCENES for one in phases
    ]
    for one in loaded:
        announce_scene(one)
    options = {
        "size": size,
        "phase": phases,
        "contender": contender or [],
        "parameter": parameter or [],
        "frames": frames,
        "triangles": triangles,
        "rel-error": rel_error,
    }
    with terminated_cleanly():
        run_benchmark(loaded, contenders, frames, goal, options, out)


def _load(name: str, triangles: int | None, size: tuple[int, int], parameters: dict[str, str]) -> Scene:
    import airlight

    if triangles is None:
        return airlight.load(name, size, **parameters)
    from experiments.technique_benchmark.budget import load_within

    return load_within(name, triangles, size, **parameters)
