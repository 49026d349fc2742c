"""`airlight agree`: the reference held against independent witnesses, and against itself spoilt on purpose."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from experiments.options import SCENE_HELP, Parameters, Size, parse_parameters


def agree(
    scene: Annotated[
        list[str] | None, typer.Argument(metavar="SCENE...", help=f"{SCENE_HELP} Any number of them.")
    ] = None,
    all_scenes: Annotated[bool, typer.Option("--all", help="Every shipped scene.")] = False,
    every_phase: Annotated[
        bool, typer.Option("--every-phase", help="Each scene with each of the shipped phase functions.")
    ] = False,
    parameter: Parameters = None,
    size: Size = (64, 64),
    time_limit: Annotated[
        float,
        typer.Option(
            help="Seconds for volpath in each case, which else goes on until a bias of 0.1 % of the image mean would "
            "show."
        ),
    ] = 600.0,
    mutations: Annotated[
        bool, typer.Option("--mutations", help="Spoil the estimator in eight ways, each of which has to be noticed.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for a README.md, agreement.json, a histogram of the scores, and of a single case z.exr."
        ),
    ] = None,
) -> None:
    """Compare the main estimator, the deterministic mode and Mitsuba's volpath, each with each.

    Exits with 1 where two of them disagree, a case of several fails, or a mutation goes unnoticed.

    Example: airlight agree --all --every-phase --time-limit 15 --out results/agreement
    """
    from experiments.agree.cases import list_cases
    from experiments.agree.report import run_agree

    parameters = parse_parameters(parameter)
    cases = list_cases(scene or [], all_scenes, every_phase, parameters)
    if out:
        from experiments.agree.page import prepare_folder

        # refused before the work
        prepare_folder(out)
    words = ["airlight", "agree", *(["--all"] if all_scenes else scene or [])]
    words += ["--every-phase"] if every_phase else []
    words += [part for name, value in parameters.items() for part in ("-p", f"{name}={value}")]
    words += ["--size", *map(str, size)] if size else []
    words += ["--time-limit", f"{time_limit:g}", *(["--mutations"] if mutations else []), "--out", str(out)]
    if not run_agree(cases, size, time_limit, mutations, out, shlex.join(words)):
        raise typer.Exit(1)
