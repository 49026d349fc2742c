"""Entries put into the cache and found again."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO

import platformdirs

from reference.cache import entry_file
from reference.cache.entry_file import Arrays, DamagedError, OldFormatError, Record
from scenes.errors import InputError
from scenes.replacing import CACHE_CURE, make_folder, replacing

Recipe = dict[str, Any]
SET_ASIDE = ".damaged"


def folder() -> Path:
    """Where the entries are."""
    return Path(platformdirs.user_cache_dir("airlight")) / "references"


def key(recipe: Recipe) -> str:
    """Hash of a recipe and of the format of the file: where its entry is."""
    text = json.dumps({"format": entry_file.FORMAT, "recipe": recipe}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def load(recipe: Recipe, tell: Callable[[str], None] | None = None) -> tuple[Arrays, Record] | None:
    """Return an entry's arrays and its record, or None.

    Every byte is held against the checksum. A damaged entry is set aside (renamed) and counts as missing.

    Parameters
    ----------
    recipe : whatever JSON holds
    tell : called with a sentence for the person where an entry was damaged
    """
    path = _path(recipe)
    try:
        file = path.open("rb")
    except OSError:
        return None
    with file:
        try:
            arrays, record = entry_file.read(file)
            if key(record["recipe"]) != key(recipe):
                raise DamagedError("it is the entry of another recipe")
        except (DamagedError, OldFormatError, OSError) as error:
            # an old format has no place at this address either
            moved = _set_aside(path, file)
            if tell:
                where = f"is set aside as {moved}" if moved else f"stays at {path} until another takes its place"
                tell(f"An entry of the cache is damaged ({error}) and {where}; its reference is estimated again.")
            return None
    # by this `airlight cache` knows what is used; a folder that only others may write keeps its times
    with contextlib.suppress(OSError):
        os.utime(path)
    return arrays, record


def load_record(recipe: Recipe) -> Record | None:
    """Return an entry's record alone, or None where there is no whole one; its arrays are not read."""
    try:
        with _path(recipe).open("rb") as file:
            return entry_file.read_record(file)
    except (DamagedError, OldFormatError, OSError):
        return None


def check_writable() -> None:
    """Raise InputError where an entry could not be kept: better before the estimate than after it."""
    make_folder(folder(), CACHE_CURE)
    if not os.access(folder(), os.W_OK):
        raise InputError(f"The references cannot be kept in {folder()}: {CACHE_CURE}.")


def store(recipe: Recipe, arrays: Arrays, record: Record) -> None:
    """Keep an entry, whole or not at all; it takes the place of an earlier one of the same recipe.

    Parameters
    ----------
    record : whatever JSON holds; "recipe" is added to it

    Raises
    ------
    InputError
        The cache folder cannot be written.
    """
    make_folder(folder(), CACHE_CURE)
    with replacing(_path(recipe), CACHE_CURE) as beside, beside.open("r+b") as file:
        entry_file.write(file, arrays, record | {"recipe": recipe})
        # or a machine that loses its power could keep the new name without the bytes, and lose both entries
        file.flush()
        os.fsync(file.fileno())


def _set_aside(path: Path, file: BinaryIO) -> Path | None:
    """Rename a damaged entry; None where that fails, or where somebody has replaced it meanwhile."""
    aside = path.with_suffix(SET_ASIDE)
    with contextlib.suppress(OSError):
        if os.path.samestat(os.fstat(file.fileno()), path.stat()):
            path.replace(aside)
            return aside
    return None


def _path(recipe: Recipe) -> Path:
    return folder() / f"{key(recipe)}.npz"
