"""Tables in Markdown."""

from __future__ import annotations

from collections.abc import Sequence


def table(headings: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """A table: its first column and those that hold words mostly to the left, those of numbers to the right."""
    columns = [[line[number] for line in lines] for number in range(len(headings))]
    rule = "|".join("---" if number == 0 or _words(column) else "--:" for number, column in enumerate(columns))
    return "\n".join([f"| {' | '.join(headings)} |", f"|{rule}|", *(f"| {' | '.join(line)} |" for line in lines)])


def _words(column: Sequence[str]) -> bool:
    """Whether most of its cells begin with a letter."""
    return sum(cell[:1].isalpha() for cell in column) > len(column) / 2
