"""`airlight figures`."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer


def figures(
    only: Annotated[
        list[str] | None,
        typer.Option(metavar="NUMBER", help="A figure, such as 5.1, or table-5.1; repeatable. By default all."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for PNG, PDF and the page.")] = Path("runs/figures"),
    size: Annotated[tuple[int, int], typer.Option("--size", metavar="W H", help="Size of renderings in pixels.")] = (
        512,
        512,
    ),
) -> None:
    """Draw the figures and the table of Weng 2010 anew, and hold its claims against what is measured.

    With --only neither the page nor the claims.

    Example: airlight figures --only 5.1
    """
    from experiments.console import notices, say, warn
    from experiments.figures import FIGURES, find_figure
    from experiments.figures.claims.committed import check_results
    from experiments.figures.files import made_of, write_figure
    from experiments.figures.page import TITLE, write_page
    from experiments.figures.stage import Stage
    from experiments.pages import prepare_page
    from experiments.termination import terminated_cleanly
    from scenes.camera import check_size

    # refused before the work
    check_size(size)
    if not only:
        check_results()
    chosen = [find_figure(number) for number in only] if only else list(FIGURES.values())
    prepare_page(out, TITLE)
    given = [*(part for entry in chosen if only for part in ("--only", entry.number))]
    command = shlex.join(["airlight", "figures", *given, "--size", *map(str, size), "--out", str(out)])
    told = {}
    with terminated_cleanly(), notices.status("figures") as status, Stage(size, status.update) as stage:
        for entry in chosen:
            status.update(entry.name)
            drawn = entry.draw(stage)
            write_figure(out, entry, drawn, made_of(command, stage.gl_renderer, stage.stand_ins))
            told[entry.number] = drawn.text
            say(f"{entry.name}: {out / entry.stem}.png, .pdf")
        if not only:
            status.update("claims")
            write_page(out, told, stage, command)
        if stage.stand_ins:
            warn(f"Procedural stand-ins served for {', '.join(stage.stand_ins)}; the figures say so.")
    if not only:
        say(f"Page: {(out / 'README.md').resolve()}")
