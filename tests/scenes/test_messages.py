"""Mitsuba's messages as one sentence."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenes.messages import LONGEST, one_sentence, readable

PATH = Path("fog.xml")


@pytest.mark.parametrize(
    ("message", "sentence"),
    [
        ("[parser.cpp:451] Error while loading fog.xml (line 1, col 2): odd", "fog.xml (line 1, col 2): odd."),
        ("[a.cpp:1] outer:\n[b.cpp:2] At fog.xml (line 3, col 4): inner!", "fog.xml (line 3, col 4): inner."),
        ("no place", "fog.xml: no place."),
        (
            "[parser.cpp:111] Found unused parameters:\n  - $g=0.3\n",
            "fog.xml has no use for the parameter $g with these settings; correct its name or leave it out.",
        ),
        # Debian's Python hands on nothing where the message quotes bytes that are not UTF-8
        ("", "fog.xml: Mitsuba refuses it, and why cannot be read; check that it is UTF-8."),
        ("x:\n]\n", "fog.xml: x:."),
        ("]\n", "fog.xml: Mitsuba refuses it, and why cannot be read; check that it is UTF-8."),
    ],
)
def test_one_sentence(message: str, sentence: str) -> None:
    assert one_sentence(PATH, message) == sentence


def test_what_is_long_or_cannot_be_printed() -> None:
    text = readable("a" * 5000 + "\n\x07é")
    assert len(text) < LONGEST + 10
    assert text.isprintable()
    assert text.endswith("é")
