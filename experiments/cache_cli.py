"""`airlight cache`: which references are kept, and the removal of those that are of no more use."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from experiments.options import TYPER_STYLE
from reference.goal import Goal
from scenes.errors import InputError

if TYPE_CHECKING:
    from rich.table import Table

    from reference.cache import Entry

cache_app = typer.Typer(
    name="cache",
    help="The references that are kept, so that a scene's truth is estimated once.",
    **TYPER_STYLE,
)


@cache_app.command("list")
def list_(json: Annotated[bool, typer.Option("--json", help="Print the list as JSON.")] = False) -> None:
    """List the references that are kept: scene, estimator, error reached and asked for, state, last used.

    Example: airlight cache list
    """
    from dataclasses import asdict
    from json import dumps

    from experiments.console import console, say
    from reference import cache

    entries, beside = cache.entries(), cache.other_files()
    if json:
        told: dict[str, Any] = {"folder": cache.folder(), "bytes": sum(entry.size for entry in entries)}
        print(dumps(told | {"entries": [asdict(entry) for entry in entries]} | asdict(beside), default=str, indent=2))
        return
    if entries:
        console.print(_table(entries))
    say(f"{_count(len(entries), 'reference')}, {_bytes(sum(entry.size for entry in entries))}, in {cache.folder()}")
    if beside.set_aside or beside.leftovers:
        say(
            f"Beside them: {_count(len(beside.set_aside), 'damaged entry', 'damaged entries')} set aside, "
            f"{_count(len(beside.leftovers), 'file')} being written or left half written."
        )
    _tell_of_foreign(beside.foreign)


@cache_app.command()
def prune(
    all_: Annotated[bool, typer.Option("--all", help="Remove every reference.")] = False,
    older_than: Annotated[
        float | None, typer.Option(metavar="DAYS", help="Remove those that were not used for so many days.")
    ] = None,
    stale: Annotated[
        bool, typer.Option("--stale", help="Remove those of another version of the estimator, Mitsuba or Dr.Jit.")
    ] = False,
    damaged: Annotated[
        bool, typer.Option("--damaged", help="Check every byte; remove what is damaged or was left half written.")
    ] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only say what would be removed.")] = False,
) -> None:
    """Remove references that are of no more use: without an option, those that are stale or damaged.

    Example: airlight cache prune --older-than 90
    """
    from experiments.console import say
    from reference import cache

    if older_than is not None and not older_than >= 0:
        raise InputError(f"--older-than {older_than:g} should be a number of days, 0 or more.")
    removed = cache.prune(all_, older_than, stale, damaged, dry_run)
    for removal in removed:
        say(f"{removal.path.name}: {removal.why} ({_bytes(removal.size)})")
    done = "would be removed from" if dry_run else "removed from"
    say(f"{_count(len(removed), 'file')}, {_bytes(sum(removal.size for removal in removed))}, {done} {cache.folder()}")
    _tell_of_foreign(cache.other_files().foreign)


def _table(entries: list[Entry]) -> Table:
    from datetime import datetime

    from rich.markup import escape

    from experiments.console import plain_table

    table = plain_table("references")
    for heading in ("scene", "estimator"):
        table.add_column(heading, overflow="fold")
    for heading in ("size", "error", "asked", "bytes", "last used"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("state", overflow="fold")
    for entry in entries:
        given = "".join(f", {name}={value}" for name, value in entry.parameters.items())
        table.add_row(
            escape(f"{entry.scene or '-'}{given}"),
            f"{entry.estimator} {entry.estimator_version}, {entry.variant}" if entry.estimator else "-",
            " x ".join(map(str, entry.image_size)) if entry.image_size else "-",
            "-" if entry.rel_error is None else f"{100 * entry.rel_error:.3g}%",
            _asked(entry),
            _bytes(entry.size),
            f"{datetime.fromtimestamp(entry.last_used):%Y-%m-%d %H:%M}",
            _state(entry),
        )
    table.caption = (
        "error, asked: relative standard error at the 95th percentile of the lit pixels, or the one that is said; "
        "numerical error of what is deterministic. Each byte is checked when a reference is used, and by "
        "`airlight cache prune`."
    )
    return table


def _asked(entry: Entry) -> str:
    if entry.asked is None:
        return "-"
    percentile = f" at {entry.percentile:g}" if entry.percentile not in (None, Goal().percentile) else ""
    return f"{100 * entry.asked:.3g}%{percentile}"


def _state(entry: Entry) -> str:
    if entry.damaged:
        return f"damaged: {entry.damaged}"
    if entry.stale:
        return f"stale: {entry.stale}"
    return "unfinished" if entry.finished is False else "usable"


def _tell_of_foreign(paths: list[Any]) -> None:
    from experiments.console import warn

    if paths:
        warn(f"Not of airlight's making, and left alone: {', '.join(path.name for path in paths)}")


def _count(number: int, one: str, many: str = "") -> str:
    return f"{number:,} {one if number == 1 else many or one + 's'}"


def _bytes(number: int) -> str:
    """A file's size for people, in the units of SI."""
    size, units = float(number), ["bytes", "kB", "MB", "GB", "TB"]
    while size >= 999.5 and len(units) > 1:
        size, units = size / 1000, units[1:]
    return f"{number} bytes" if units[0] == "bytes" else f"{size:.3g} {units[0]}"
