"""Tables in Markdown."""

from __future__ import annotations

import re
from collections.abc import Sequence


def table(headings: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """A table: its first column and those that hold words mostly to the left, those of numbers to the right.

    Cells may hold anything and stay cells; emphasis, code and links in them are Markdown's.
    """
    columns = [[line[number] for line in lines] for number in range(len(headings))]
    rule = "|".join("---" if number == 0 or _words(column) else "--:" for number, column in enumerate(columns))
    return "\n".join([_line(headings), f"|{rule}|", *map(_line, lines)])


def one_line(text: str) -> str:
    """A text on one line that neither ends a table's cell nor begins a tag or an entity of HTML."""
    return re.sub(r"[\\|<]|&(?=#?\w+;)", r"\\\g<0>", " ".join(text.split()))


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(map(one_line, cells))} |"


def _words(column: Sequence[str]) -> bool:
    """Whether most of its cells begin with a letter."""
    return sum(cell[:1].isalpha() for cell in column) > len(column) / 2
