"""The command line. Heavy imports wait until a command needs them, so that `--help` answers at once."""

from __future__ import annotations

import sys
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, Literal

import typer

from experiments.accuracy_cli import accuracy
from experiments.agree_cli import agree
from experiments.attribute_cli import attribute
from experiments.benchmark_cli import benchmark_app
from experiments.cache_cli import cache_app
from experiments.compare_cli import compare
from experiments.exactness_cli import exactness
from experiments.figures_cli import figures
from experiments.gate_cli import gate
from experiments.mathematics_cli import atlas, audit, quadrature, spectra
from experiments.meshes_cli import meshes_app
from experiments.options import (
    TYPER_STYLE,
    Parameters,
    Percentile,
    RelError,
    SampleLimit,
    SceneArgument,
    Size,
    TimeLimit,
    given_beside,
    parse_parameters,
)
from experiments.pareto_cli import pareto
from experiments.render_cli import render
from experiments.run_cli import page, run
from experiments.termination import terminated_cleanly
from reference.goal import Goal
from scenes.errors import InputError

app = typer.Typer(
    name="airlight",
    help="How accurate a real-time volumetric-shadow technique is, where its error comes from, and what it costs.",
    **TYPER_STYLE,
)
app.add_typer(meshes_app)
app.add_typer(cache_app)
app.add_typer(benchmark_app)


def main() -> None:
    """Run the command line: what cannot be used ends in one sentence and exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        # a name that the terminal's encoding lacks is shown as well as it can be
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        app()
    except InputError as error:
        # one line, whatever a file's name holds
        print(f"airlight: {' '.join(str(error).split())}", file=sys.stderr)
        sys.exit(2)


@app.command()
def doctor() -> None:
    """Look at Python, OpenGL, Mitsuba, LLVM and meshes, and say the cure where something is missing.

    Exits with 1 where the main job cannot run.  Example: airlight doctor
    """
    from experiments.console import console
    from experiments.doctor import examine, report

    findings = examine()
    console.print(report(findings))
    if any(finding.state == "missing" for finding in findings):
        raise typer.Exit(1)


@app.command("list")
def list_() -> None:
    """List scenes, techniques and their parts, suites and meshes.

    Example: airlight list
    """
    from experiments.console import console
    from experiments.listing import listing

    for table in listing():
        console.print(table)


app.command()(render)


@app.command()
def reference(
    context: typer.Context,
    scene: SceneArgument,
    out: Annotated[Path | None, typer.Option(help="The EXR file to write.")] = None,
    parameter: Parameters = None,
    size: Size = None,
    rel_error: RelError = 0.005,
    percentile: Percentile = 95.0,
    time_limit: TimeLimit = 600.0,
    sample_limit: SampleLimit = None,
    pixel_filter: Annotated[
        Literal["centre", "box"], typer.Option(help="Rays through pixel centres, or averages over pixels.")
    ] = "centre",
    deterministic: Annotated[
        bool,
        typer.Option(
            "--deterministic", help="Ray casting and quadrature instead of samples; goals and limits are idle."
        ),
    ] = False,
    export: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Write camera, depths and conventions there, to match the scene with another engine; without --out "
            "nothing is estimated.",
        ),
    ] = None,
) -> None:
    """Estimate a scene's reference in Mitsuba and write it with its standard error.

    It is kept in the cache. One that was stopped, by a limit or by Ctrl-C, goes on where it was when it is asked for
    again.

    Example: airlight reference sphere --size 256 256 --rel-error 0.005 --out sphere.exr
    """
    import airlight
    from experiments.console import say
    from experiments.export import check_folder, write_export
    from experiments.exr import check_writable
    from experiments.terminal import ReferenceWatcher, announce_reference, announce_scene, announce_variant, told

    # refused before the scene is loaded
    Goal(rel_error, time_limit, percentile, sample_limit)
    if out:
        check_writable(out, ".exr")
    elif not export:
        raise InputError("reference needs --out with a file for the estimate, or --export with a folder, or both.")
    elif given := given_beside(context, ("scene", "parameter", "size", "export")):
        raise InputError(f"Without --out nothing is estimated; leave {' and '.join(given)} out.")
    if export:
        check_folder(export)
    loaded = airlight.load(scene, size, **parse_parameters(parameter))
    announce_scene(loaded)
    announce_variant()
    if export:
        write_export(export, loaded)
        say(f"{export}: {loaded.name}, camera, depths and conventions; README.txt there says how to use them")
    if not out:
        return
    with terminated_cleanly(), ReferenceWatcher(rel_error) as watcher:
        result = airlight.reference(
            loaded,
            rel_error,
            time_limit,
            watcher.reference,
            percentile=percentile,
            sample_limit=sample_limit,
            pixel_filter=pixel_filter,
            deterministic=deterministic,
        )
    announce_reference(result)
    airlight.save(out, loaded, result)
    say(f"{out}: {loaded.name}, {told(result)}")


for command in (
    compare,
    attribute,
    run,
    page,
    gate,
    accuracy,
    exactness,
    agree,
    audit,
    atlas,
    quadrature,
    spectra,
    figures,
    pareto,
):
    app.command()(command)
