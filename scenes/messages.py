"""Mitsuba's error messages, boiled down to the sentence that people read."""

from __future__ import annotations

import re
from pathlib import Path

# what a scene holds may be of any length, and a sentence may not
LONGEST = 400


def one_sentence(path: Path, message: str) -> str:
    """Boil a message of Mitsuba's down to one sentence that names the file."""
    # where in Mitsuba's own sources, and which of its classes
    lines = [re.sub(r"\[[\w./]+(:\d+)?\] ", "", line).strip() for line in message.splitlines()]
    if any("unused parameters" in line for line in lines):
        names = ", ".join(line.removeprefix("- ").split("=")[0] for line in lines if line.startswith("- "))
        return f"{path} has no use for the parameter {names} with these settings; correct its name or leave it out."
    innermost = next((line for line in reversed(lines) if any(map(str.isalpha, line))), "")
    if not innermost:
        # some builds of Python drop a message that quotes bytes of another encoding
        return f"{path}: Mitsuba refuses it, and why cannot be read; check that it is UTF-8."
    innermost = readable(innermost.removeprefix("Error while loading ").removeprefix("At ")).rstrip(".!")
    return innermost + "." if path.name in innermost else f"{path}: {innermost}."


def readable(text: str) -> str:
    """Shorten a text in its middle and replace what cannot be printed."""
    if len(text) > LONGEST:
        text = f"{text[: LONGEST // 2]} ... {text[-LONGEST // 2 :]}"
    return "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in text)
