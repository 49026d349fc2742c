"""`airlight exactness`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from experiments.options import SCENE_HELP


def exactness(
    scene: Annotated[
        list[str] | None,
        typer.Argument(metavar="SCENE", help=f"{SCENE_HELP} By default all that are shipped.", show_default=False),
    ] = None,
    size: Annotated[tuple[int, int], typer.Option("--size", metavar="W H", help="Image size in pixels.")] = (128, 128),
    shadow_map: Annotated[
        int | None,
        typer.Option(help="Texels on a side of a tile before they double.", show_default="1344 of a cube, 8192"),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for the page.")] = None,
) -> None:
    """Hold the controls, exact x quadrature and given x quadrature, against the reference.

    Exits with 1 where a scene's image mean or its given intervals are off.

    Example: airlight exactness --out results/exactness
    """
    from experiments.console import console, notices, say
    from experiments.exactness.page import TITLE, write_page
    from experiments.exactness.study import study
    from experiments.exactness.table import exactness_table, verdict
    from experiments.pages import prepare_page
    from experiments.termination import terminated_cleanly
    from scenes.catalogue import shipped

    if out:
        prepare_page(out, TITLE)
    scenes = scene or shipped()
    with terminated_cleanly(), notices.status("exactness") as status:
        cases = []
        for case in study(scenes, size, shadow_map, status.update):
            cases.append(case)
            if out:
                write_page(out, cases, scenes, size, shadow_map)
    console.print(exactness_table(cases))
    say(f"{verdict(cases)}.")
    if out:
        say(f"Exactness: {(out / 'README.md').resolve()}")
    if not all(case.unbiased and case.given.agrees for case in cases):
        raise typer.Exit(1)
