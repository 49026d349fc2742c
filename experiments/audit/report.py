"""`airlight audit`: the thesis's equations, as printed and repaired, each with what was measured of it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from analytic.thesis.audit import EQUATIONS, LARGEST_RIGHT, Entry, audit_one_by_one
from experiments.audit.page import TITLE, write_page
from experiments.bars import Bars
from experiments.console import console, notices, plain_table, say
from experiments.pages import prepare_page

__all__ = ["audit_table", "run_audit"]


class _AuditBar(Bars):
    """One bar, of the equations done; none where standard error is no terminal."""

    def __init__(self) -> None:
        super().__init__(TextColumn("{task.description:<9}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())

    def entries(self) -> list[Entry]:
        """The audit, the bar moving with it."""
        if not notices.is_terminal:
            return list(audit_one_by_one())
        self._progress.start()
        bar = self._progress.add_task("", total=len(EQUATIONS))
        found = []
        for entry in audit_one_by_one():
            found.append(entry)
            self._progress.update(bar, description=entry.equation, advance=1)
        return found


def run_audit(as_json: bool = False, out: Path | None = None) -> bool:
    """Evaluate every equation and print what was found.

    Parameters
    ----------
    as_json : bool  print a list of objects, and nothing else, on standard output
    out : Path      folder for audit.json and README.md; none by default

    Returns
    -------
    bool  whether each repair agrees with the truth to 1e-20

    Raises
    ------
    InputError
        If the folder cannot be made or written.
    """
    if out:
        # refused before half a minute of work
        prepare_page(out, TITLE)
    with _AuditBar() as bar:
        entries = bar.entries()
    if out:
        write_page(out, entries)
    if as_json:
        print(json.dumps([asdict(entry) for entry in entries], indent=2))
    else:
        console.print(audit_table(entries))
        say(_summary(entries))
    return not _unrepaired(entries)


def audit_table(entries: Sequence[Entry]) -> Table:
    """An equation a line; what was found is in the page and in the JSON."""
    table = plain_table("Weng 2010: largest relative error against an independent truth")
    table.add_column("equation", no_wrap=True)
    table.add_column("as printed", justify="right", no_wrap=True)
    table.add_column("repaired", justify="right", no_wrap=True)
    table.add_column("verdict", overflow="fold")
    for entry in entries:
        repaired = "" if entry.verdict == "right" else residual(entry.residual_repaired)
        table.add_row(entry.equation, residual(entry.residual_printed), repaired, entry.verdict)
    return table


def residual(value: float | None) -> str:
    """One digit more than its order of magnitude."""
    return "-" if value is None else f"{value:.1e}" if value else "0"


def _unrepaired(entries: Sequence[Entry]) -> list[str]:
    return [
        entry.equation
        for entry in entries
        if entry.residual_repaired is not None and not entry.residual_repaired <= LARGEST_RIGHT
    ]


def _summary(entries: Sequence[Entry]) -> str:
    right = sum(entry.verdict == "right" for entry in entries)
    text = f"{right} right, {len(entries) - right} wrong as printed: an error up to {LARGEST_RIGHT:g} counts as right."
    if bad := _unrepaired(entries):
        text += f" Not repaired: {', '.join(bad)}."
    return text
