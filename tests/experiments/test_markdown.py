"""Tables of Markdown, read back by a reader of Markdown."""

from __future__ import annotations

import re
from html import unescape

import pytest
from markdown_it import MarkdownIt

from experiments.markdown import table

HOSTILE = "a | b \\| c <img src=x> &lt; & \\ \\\\| d\\"


def cells(text: str) -> list[str]:
    """What a reader sees in each cell."""
    html = MarkdownIt("commonmark", {"html": True}).enable("table").render(text)
    return [unescape(cell) for cell in re.findall(r"<t[hd](?: [^>]*)?>(.*?)</t[hd]>", html, re.DOTALL)]


@pytest.mark.parametrize("cell", [HOSTILE, "|", "<b>", "\\|", "&amp;", "1 < 2", "x\\"])
def test_a_cell_is_what_it_was_given(cell: str) -> None:
    assert cells(table(["name", cell], [[cell, "1"], ["b", cell]])) == ["name", cell, cell, "1", "b", cell]


def test_a_cell_is_one_line() -> None:
    text = table(["a", "b"], [["one\n\n| two |", "1"]])
    assert len(text.splitlines()) == 3
    assert cells(text) == ["a", "b", "one | two |", "1"]


def test_numbers_stand_to_the_right() -> None:
    assert table(["a", "b", "c"], [["1", "2.5", "words"]]) == "| a | b | c |\n|---|--:|---|\n| 1 | 2.5 | words |"
