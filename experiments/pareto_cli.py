"""`airlight pareto`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from experiments.options import SCENE_HELP

SUITE = "techniques"


def pareto(
    scene: Annotated[
        list[str] | None,
        typer.Argument(metavar="SCENE", help=f"{SCENE_HELP} By default the thesis's five.", show_default=False),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the page, the table and the plots.")] = Path("pareto"),
    runs: Annotated[Path, typer.Option(help="Folder in which the folder of the run is made.")] = Path("runs"),
    change: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="As if the suite had it: --set rounds=15; repeatable."),
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Begin anew, even where a stopped run could go on.")] = False,
) -> None:
    """Draw error against cost for every technique, and say which are on the front and what keeps ours from it.

    It is the suite `techniques`, run and told: the same command again goes on with a run that was stopped. Nothing else
    may run on the machine meanwhile.

    Example: airlight pareto --out results/techniques
    """
    from experiments.console import say
    from experiments.pages import prepare_page
    from experiments.pareto.ours import verdict
    from experiments.pareto.points import scenes_of
    from experiments.run.folder import read_table
    from experiments.run.page import write_page
    from experiments.run_cli import run
    from experiments.studies.pareto import TITLE

    # refused before the work
    prepare_page(out, TITLE)
    scenes = [f"scenes={json.dumps(scene, ensure_ascii=False)}"] if scene else []
    folder = run(SUITE, out=runs, change=[*(change or []), *scenes], fresh=fresh)
    page = write_page(folder, out)
    say(verdict(scenes_of(list(read_table(folder).iter_rows(named=True)))))
    say(f"Page: {page.resolve()}")
