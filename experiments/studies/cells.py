"""What studies call their rows, and cells of tables, none of which is empty without saying why."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from experiments.markdown import one_line, table
from experiments.technique_label import own_settings, technique_label

Row = dict[str, Any]


def label(row: Row, *without: str) -> str:
    """A row's technique with its settings, those left out that have an axis or a column of their own."""
    own = own_settings(row["technique"])
    return technique_label(row["technique"], row | {name: getattr(own, name) for name in without})


def values_of(rows: Iterable[Row], column: str) -> list[Any]:
    """Each value of a column once, numbers in their order, texts as they come."""
    found = list(dict.fromkeys(row[column] for row in rows))
    return sorted(found) if all(isinstance(value, int | float) for value in found) else found


def span(values: Iterable[float], shape: str) -> str:
    """The least and the most of some values."""
    found = list(values)
    least, most = shape.format(min(found)), shape.format(max(found))
    return least if least == most else f"{least} to {most}"


class Gaps:
    """Why cells have no number: a mark for each, and each reason once below the table."""

    def __init__(self) -> None:
        self._reasons: dict[str, int] = {}

    def because(self, reason: str) -> str:
        """The cell of something that has no number for this reason."""
        return f"– ({self._reasons.setdefault(reason, len(self._reasons) + 1)})"

    def cell(self, row: Row | None, column: str, shown: Callable[[Row], str]) -> str:
        """What is shown of a row; where it is not there or has nothing in `column`, why."""
        if row is None:
            return self.because("not among the cases of this run")
        if row["status"] != "done":
            return self.because(f"{row['status']}: {row['reason']}")
        if row.get(column) is None:
            return self.because(f"the run did not measure {column}")
        return shown(row)

    def table(self, headings: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
        """A Markdown table with the reasons below it, where it has cells without number."""
        reasons = (f"- ({number}) {one_line(reason)}" for reason, number in self._reasons.items())
        return "\n\n".join(filter(None, (table(headings, lines), "\n".join(reasons))))
