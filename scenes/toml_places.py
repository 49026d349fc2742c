"""On which line of a TOML file a key stands, which TOML's reader does not keep."""

from __future__ import annotations

import tomllib
from typing import Any

Key = tuple[str | int, ...]


def is_there(found: Any, key: Key) -> bool:
    """Whether a file's tables have such a key."""
    at = found
    for part in key:
        # a text has parts too, but no keys
        if not isinstance(at, dict | list):
            return False
        try:
            at = at[part]  # type: ignore[index]
        except (LookupError, TypeError):
            return False
    return True


def line_of(text: str, key: Key) -> int | None:
    """The line on which a key stands: the first with which the file, cut off behind it, would have it.

    A value over several lines makes all cuts inside it unreadable, so its first line is the one after the last readable
    cut. Of a key that is missing, the line of the table that lacks it; None where that is the whole file.
    """
    while key:
        before = 0
        lines = text.splitlines(keepends=True)
        for number in range(1, len(lines) + 1):
            try:
                cut = tomllib.loads("".join(lines[:number]))
            except tomllib.TOMLDecodeError:
                continue
            if is_there(cut, key):
                return before + 1
            before = number
        key = key[:-1]
    return None
