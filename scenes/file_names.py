"""Names that every library here can take: Mitsuba, OpenEXR and the metadata hold text, and a file's name is bytes."""

from __future__ import annotations

from pathlib import Path

from scenes.errors import InputError


def is_text(name: str) -> bool:
    """Whether a name is text: Python smuggles bytes that are not UTF-8 into one as lone surrogates."""
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True


def check_name(path: str | Path) -> None:
    """Raise InputError where a file's or a folder's name is not UTF-8."""
    if not is_text(str(path)):
        shown = str(path).encode(errors="surrogateescape").decode(errors="backslashreplace")
        raise InputError(f"{shown} has a name that is not UTF-8; rename it.")
