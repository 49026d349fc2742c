"""`airlight meshes`: which meshes there are, and those of others fetched from their makers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from experiments.options import TYPER_STYLE
from experiments.termination import terminated_cleanly
from scenes.errors import InputError

if TYPE_CHECKING:
    from scenes.meshes.fetch import Fetched

meshes_app = typer.Typer(
    name="meshes",
    help="The meshes that scenes name: where they come from, on what terms, and how to get the real ones.",
    **TYPER_STYLE,
)


@meshes_app.command("list")
def list_(json: Annotated[bool, typer.Option("--json", help="Print the list as JSON.")] = False) -> None:
    """List the meshes: what each is, where it would come from now, its licence, how to get the real one.

    Example: airlight meshes list
    """
    import json as json_module

    from experiments.console import console
    from experiments.meshes import describe_meshes, meshes_table

    rows = describe_meshes()
    if json:
        print(json_module.dumps(rows, indent=2))
    else:
        console.print(meshes_table(rows))


@meshes_app.command()
def fetch(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME...", help="Meshes, such as dragon_97k_fixed.ply.")
    ] = None,
    all_: Annotated[bool, typer.Option("--all", help="Every mesh that can be fetched.")] = False,
) -> None:
    """Fetch meshes from their makers, check and repair them, and put them into the user's data folder.

    Example: airlight meshes fetch dragon_97k_fixed.ply
    """
    from experiments.console import say
    from experiments.meshes import FetchWatcher
    from scenes.meshes.catalogue import MESHES
    from scenes.meshes.fetch import check_names, fetch, fetchable

    if bool(names) == all_:
        raise InputError(f"Name the meshes to fetch, or give --all for {', '.join(fetchable())}.")
    chosen = names or fetchable()
    check_names(chosen)
    # the terms come before the bytes
    for name in chosen:
        say(f"{name}: {MESHES[name].what}. Credit: {MESHES[name].credit}. Licence: {MESHES[name].licence}.")
    with terminated_cleanly(), FetchWatcher() as watcher:
        for mesh in fetch(chosen, watcher):
            say(_told(mesh))


def _told(mesh: Fetched) -> str:
    if mesh.note is None:
        return f"{mesh.path}: was there already, and is the reference copy"
    if not mesh.fresh:
        return f"{mesh.path}: was there already, from the same original by the same steps"
    steps = [f"{record.step} -> {record.polygons} polygons" for record in mesh.note.steps]
    return f"{mesh.path}: {mesh.note.member}, {', '.join(steps)}; {mesh.note.triangles} triangles"
