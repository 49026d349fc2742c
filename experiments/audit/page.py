"""results/audit: the audit as JSON and as a page."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from analytic.thesis.audit import LARGEST_RIGHT, Entry
from experiments.pages import made_by
from scenes.replacing import replacing

__all__ = ["TITLE", "write_page"]

TITLE = "The equations of Weng 2010, audited"
PAGE = """# {title}

{made}

Each equation of the thesis is in code as printed and, where that is wrong, repaired (`analytic/thesis/`, one file per
section). It is compared with a truth that does not use it: particles and thin slabs for chapter 3 and Eq. 13, a lamp of
finite size for Eqs. 14 and 15, and for the airlight an oracle that proves a bound of its own error
(`analytic/oracle/`). Eqs. 31 and 32 alone relate the thesis's own i and j, which Eqs. 20, 23 and 26 hold against the
oracle. Eq. 29's exponent, the kappa_i of Eqs. 22 and 24 and the capital I of Eq. 23 are read from an extracted text of
the thesis, not from its pages. A residual is the largest relative error over the cases, 1 where everything is lost;
above {limit:g} an equation is called wrong. Where a print can be read in several ways, the best reading counts and the
finding tells the others. How large the residual of a wrong equation is depends on the cases (h from 0.03 to 10,
extinction from 0.01 to 4, the light's projection before, inside and behind the segment); that it is wrong does not.
[derivations.md](derivations.md) derives each repair, [audit.json](audit.json) holds the same numbers in full. A
residual beyond float64 is given as the largest float.

{right} are right as printed, {wrong} are wrong.

| equation | verdict | as printed | repaired |
|---|---|---|---|
{rows}

## What was compared, and what was found

{findings}
"""


def write_page(folder: Path, entries: Sequence[Entry]) -> None:
    """Write audit.json and README.md, over those that are there.

    Parameters
    ----------
    folder : Path  one that is there
    entries : sequence of Entry

    Raises
    ------
    InputError
        If the files cannot be written.
    """
    right = sum(entry.verdict == "right" for entry in entries)
    text = PAGE.format(
        title=TITLE,
        made=made_by("airlight audit --out results/audit", "mpmath"),
        limit=LARGEST_RIGHT,
        right=right,
        wrong=len(entries) - right,
        rows="\n".join(map(_row, entries)),
        findings="\n".join(f"- **{entry.equation}**: {_plain(entry.finding)}" for entry in entries),
    )
    with replacing(folder / "audit.json") as beside:
        beside.write_text(json.dumps([asdict(entry) for entry in entries], indent=2) + "\n", encoding="utf-8")
    with replacing(folder / "README.md") as beside:
        beside.write_text(text, encoding="utf-8")


def _row(entry: Entry) -> str:
    repaired = "" if entry.verdict == "right" else _residual(entry.residual_repaired)
    return f"| {entry.equation} | {_plain(entry.verdict)} | {_residual(entry.residual_printed)} | {repaired} |"


def _residual(value: float | None) -> str:
    return "" if value is None else f"{value:.1e}" if value else "0"


def _plain(text: str) -> str:
    """Markdown that shows the text's own signs."""
    for sign in "\\_*^|<>":
        text = text.replace(sign, f"\\{sign}")
    return text
