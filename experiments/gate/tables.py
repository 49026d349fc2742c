"""What the gate tells in the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from experiments.console import plain_table
from experiments.gate.gating import Result
from experiments.gate.limits import Limit
from experiments.gate.mutations import Outcome
from experiments.gate.update import Change
from experiments.gate.verdicts import Verdict, worst_of


def result_table(result: Result) -> Table:
    """A line for each case: of its values the one nearest to its limit, or farthest beyond."""
    table = plain_table("the gate: of each case the value nearest to its limit")
    table.add_column("case", overflow="fold")
    for heading, justify in (("value", "left"), ("is", "right"), ("measured", "right")):
        table.add_column(heading, justify=justify)  # type: ignore[arg-type]
    table.add_column("margin", justify="right")
    table.add_column("margins off", justify="right")
    table.add_column("")
    for case, one in worst_of(list(result.verdicts)).items():
        word = "" if one.passes else "FAILS"
        table.add_row(case, one.metric, *_numbers(one), f"{one.margins:+.2f}", word)
    for name in result.broken:
        table.add_row(name, "", "", "", "", "", "FAILS")
    return table


def _numbers(verdict: Verdict) -> tuple[str, str, str]:
    return f"{verdict.value:.4g}", f"{verdict.limit.value:.4g}", f"{verdict.limit.margin:.2g}"


def mutation_table(outcomes: Sequence[Outcome], cases: int) -> Table:
    """A line for each mutation: how many cases noticed it, and which value was farthest beyond its limit."""
    table = plain_table(f"mutations, as {cases} cases see them")
    for heading in ("mutation", "what is wrong", "cases", "farthest beyond its limit", "margins off", ""):
        numeric = heading in ("cases", "margins off")
        table.add_column(heading, justify="right" if numeric else "left", overflow="fold")
    for one in outcomes:
        noticed = str(len({verdict.case for verdict in one.failed}))
        word = "" if one.noticed else "UNNOTICED" if one.mutation.must else "unnoticed"
        worst = one.failed[0] if one.failed else None
        far = (f"{worst.case}: {worst.metric}", f"{worst.badness:.3g}") if worst else ("", "")
        table.add_row(one.mutation.name, one.mutation.meaning, noticed, *far, word)
    return table


def change_table(changes: Sequence[Change]) -> Table:
    """Old and new value and margin of each limit that changed."""
    table = plain_table("limits that changed")
    for heading in ("case", "metric", "value", "margin"):
        table.add_column(heading, overflow="fold")
    for one in changes:
        table.add_row(one.case, one.metric, _arrow(one, "value"), _arrow(one, "margin"))
    return table


def _arrow(change: Change, name: str) -> str:
    def told(limit: Limit | None) -> str:
        return "none" if limit is None else f"{getattr(limit, name):.4g}"

    return f"{told(change.old)} -> {told(change.new)}"
