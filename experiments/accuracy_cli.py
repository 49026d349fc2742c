"""`airlight accuracy`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from experiments.options import SCENE_HELP


def accuracy(
    scene: Annotated[
        list[str] | None,
        typer.Argument(metavar="SCENE", help=f"{SCENE_HELP} By default the thesis's five.", show_default=False),
    ] = None,
    size: Annotated[tuple[int, int], typer.Option("--size", metavar="W H", help="Image size in pixels.")] = (256, 256),
    technique: Annotated[
        str, typer.Option(help="A technique, or a cell such as lit_intervals+quadrature.")
    ] = "lit_intervals+quadrature",
    out: Annotated[Path | None, typer.Option(help="Folder for the page, the table and the figure.")] = None,
) -> None:
    """Measure a technique at full resolution against the deterministic reference, over samples and shadow maps.

    Isotropic, Rayleigh's and Henyey-Greenstein's phase functions. Five minutes on two quiet cores.

    Example: airlight accuracy --out results/accuracy
    """
    from experiments.accuracy.page import TITLE, verdict, write_page
    from experiments.accuracy.study import SCENES, judged, study
    from experiments.accuracy.table import accuracy_table
    from experiments.console import console, notices, say
    from experiments.pages import prepare_page
    from experiments.termination import terminated_cleanly
    from gpu_impl.techniques import find_technique

    # refused before the work
    find_technique(technique)
    if out:
        prepare_page(out, TITLE)
    scenes = scene or list(SCENES)
    with terminated_cleanly(), notices.status("accuracy") as status:
        rows = []
        for case in study(scenes, size, technique, status.update):
            rows += case
            # whoever stops the rest keeps what is measured
            if out:
                write_page(out, rows, technique, scenes)
    console.print(accuracy_table(judged(rows)))
    say(f"{verdict(rows)}.")
    if out:
        say(f"Accuracy: {(out / 'README.md').resolve()}")
