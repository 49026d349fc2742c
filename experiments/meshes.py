"""What `airlight meshes` shows: the list of meshes, and the progress of fetching them."""

from __future__ import annotations

from typing import Any

from rich.progress import BarColumn, DownloadColumn, TextColumn, TransferSpeedColumn
from rich.table import Table

from experiments.bars import Bars
from experiments.console import plain_table, say
from scenes.meshes import catalogue, procedural
from scenes.meshes.fetch import Watcher
from scenes.meshes.files import VARIABLE, MeshFile, available, sha256
from scenes.meshes.notes import read_note


def describe_meshes() -> list[dict[str, Any]]:
    """Every mesh that a scene can name without a folder, in the order of their names.

    `sha256` is None where the file is made only once a scene asks for it; `reference_copy` says whether it has the
    bytes with which the results of this repository were made, and `steps` how a fetched one was made.

    Raises
    ------
    InputError   AIRLIGHT_MESH_DIR names a missing folder, or a mesh cannot be read
    """
    return [_describe(mesh) for mesh in available()]


def _describe(mesh: MeshFile) -> dict[str, Any]:
    known, recipe = catalogue.MESHES.get(mesh.name), procedural.RECIPES.get(mesh.name)
    bytes_ = sha256(mesh.path) if mesh.path.is_file() else None
    row: dict[str, Any] = {"name": mesh.name, "from": mesh.origin, "path": str(mesh.path), "sha256": bytes_}
    if mesh.origin == "generated" and recipe:
        what = (recipe.make.__doc__ or "").partition("\n")[0].rstrip(".")
        # a file of our own making has the recorded bytes, or is made again
        ours = {"what": what, "reference_copy": True, "credit": None, "licence": "BSD-3-Clause", "page": None}
        return {**row, **ours, "get": "made when a scene asks for it", "steps": []}
    if known is None:
        yours = {"what": None, "reference_copy": None, "credit": None, "licence": None, "page": None}
        return {**row, **yours, "get": "a file of yours", "steps": []}
    note = read_note(mesh.path) if mesh.path.is_file() and not mesh.is_stand_in else None
    return {
        **row,
        "what": known.what,
        "reference_copy": catalogue.is_reference_copy(mesh),
        "credit": known.credit,
        "licence": known.licence,
        "page": known.page,
        "get": catalogue.how_to_get(mesh.name),
        "steps": [record.model_dump() for record in note.steps] if note else [],
    }


def meshes_table(rows: list[dict[str, Any]]) -> Table:
    """The list for people."""
    table = plain_table("meshes")
    for heading in ("name", "what", "from", "as measured", "licence", "path, or how to get it"):
        table.add_column(heading, overflow="fold", no_wrap=heading == "name")
    for row in rows:
        same = {True: "yes", False: "no", None: "-"}[row["reference_copy"]]
        real = row["get"] if row["from"] in ("stand-in", "generated") else row["path"]
        table.add_row(row["name"], row["what"] or "-", row["from"], same, row["licence"] or "-", real)
    table.caption = (
        "as measured: whether it has the very bytes with which the results of this repository were made. By hand: put "
        f"it into a folder that {VARIABLE} names; --json has the addresses."
    )
    return table


class FetchWatcher(Bars, Watcher):
    """A bar while an archive comes, a line a step after it; a context manager."""

    def __init__(self) -> None:
        super().__init__(TextColumn("{task.description}"), BarColumn(), DownloadColumn(), TransferSpeedColumn())
        self._tasks: dict[str, Any] = {}

    def downloading(self, address: str, done: int, total: int) -> None:
        """Move the bar of an archive."""
        # opened by the first bytes: a server that refuses leaves no empty bar
        self._progress.start()
        if address not in self._tasks:
            self._tasks[address] = self._progress.add_task(address.rpartition("/")[2], total=None)
        self._progress.update(self._tasks[address], completed=done, total=total or None)

    def doing(self, mesh: str, what: str) -> None:
        """Say which step begins."""
        say(f"{mesh}: {what}")
