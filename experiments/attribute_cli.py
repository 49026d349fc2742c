"""`airlight attribute`."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from experiments.options import SCENE_HELP, Parameters, RelError, TimeLimit, given_beside, parse_parameters
from experiments.technique_options import Downsample, LatticeName, ShadowMapSize, Steps, Upsample
from experiments.termination import terminated_cleanly
from reference.goal import Goal
from scenes.errors import InputError

TECHNIQUES = ["Weng2010"]


def attribute(
    context: typer.Context,
    scene: Annotated[str | None, typer.Argument(metavar="SCENE", help=SCENE_HELP)] = None,
    technique: Annotated[
        list[str] | None,
        typer.Option(help="A technique, or a cell such as lit_intervals+quadrature; repeatable. By default Weng2010."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the page, the tables, the bars and the maps.")] = Path(
        "attribution"
    ),
    parameter: Parameters = None,
    size: Annotated[tuple[int, int], typer.Option("--size", metavar="W H", help="Image size in pixels.")] = (128, 128),
    steps: Steps = None,
    shadow_map: ShadowMapSize = None,
    lattice: LatticeName = None,
    downsample: Downsample = None,
    upsample: Upsample = None,
    rel_error: RelError = 0.005,
    time_limit: TimeLimit = 600.0,
    planted: Annotated[
        bool, typer.Option("--planted", help="Plant errors on purpose: each must show up in its own part.")
    ] = False,
) -> None:
    """Split the error of techniques over airlight model, visibility, shadow map, lattice and float32.

    Every combination of parts is replaced by exact ones, up to 32 pictures a technique, and the parts are charged by
    Shapley values.

    Example: airlight attribute donut_dragon --technique Weng2010 --technique Nishita1987 --out attribution

    With --planted it exits with 1 where an error that was planted is not told for what it is.
    """
    if planted:
        if given := given_beside(context, ("planted",)):
            raise InputError(f"--planted has scenes and techniques of its own; leave {' and '.join(given)} out.")
        _plant()
        return
    if scene is None:
        raise InputError("attribute needs a SCENE, or --planted.")
    import airlight
    from experiments.attribution.measurement import check_size
    from experiments.attribution.page import TITLE
    from experiments.attribution.report import run_attribution
    from experiments.console import warn
    from experiments.pages import prepare_page
    from experiments.terminal import ReferenceWatcher, announce_reference, announce_scene, announce_variant
    from gpu_impl.techniques import find_technique

    # refused before the work
    Goal(rel_error, time_limit)
    settings = {
        "steps": steps,
        "shadow_map": shadow_map,
        "lattice": lattice,
        "downsample": downsample,
        "upsample": upsample,
    }
    chosen = [find_technique(name, **settings) for name in technique or TECHNIQUES]
    prepare_page(out, TITLE)
    loaded = airlight.load(scene, size, **parse_parameters(parameter))
    check_size(loaded)
    announce_scene(loaded)
    announce_variant()
    for one in chosen:
        one.check_scene(loaded)
        for notice in one.notices(loaded):
            warn(notice)
    with terminated_cleanly():
        with ReferenceWatcher(rel_error) as watcher:
            truth = airlight.reference(loaded, rel_error, time_limit, watcher.reference)
        announce_reference(truth)
        options = {
            "technique": technique or TECHNIQUES,
            "parameter": parameter or [],
            "size": size,
            **settings,
            "rel-error": rel_error,
            "out": out,
        }
        run_attribution(loaded, chosen, truth, out, _command(scene, options))


def _command(scene: str, options: Mapping[str, object]) -> str:
    """The command that makes the page again; an option that is None was not given."""
    words = ["airlight", "attribute", scene]
    for name, value in options.items():
        for one in value if isinstance(value, list) else [value]:
            if one is not None:
                # a tuple is one option's several words
                words += [f"--{name.replace('_', '-')}", *map(str, one if isinstance(one, tuple) else (one,))]
    return shlex.join(words)


def _plant() -> None:
    from experiments.attribution.planted import LEAST, PLANTED, planted_table, try_planted
    from experiments.console import console, notices, say, warn

    outcomes = []
    with terminated_cleanly(), notices.status("planted errors") as status:
        for one in PLANTED:
            status.update(one.name)
            outcomes.append(try_planted(one))
    console.print(planted_table(outcomes))
    unnoticed = [outcome.planted.name for outcome in outcomes if not outcome.is_noticed]
    if unnoticed:
        warn(f"Hardly changes the picture, so that no part can be told: {', '.join(unnoticed)}.")
    missed = [outcome.planted.name for outcome in outcomes if outcome.is_noticed and outcome.own_share <= LEAST]
    if missed:
        warn(f"Not told for what it is: {', '.join(missed)}.")
    if unnoticed or missed:
        raise typer.Exit(1)
    say(f"All {len(outcomes)} planted errors show up in their own part at more than {LEAST:.0%}.")
