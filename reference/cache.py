"""References kept under the user's cache folder, addressed by everything that decides them."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs

from scenes.errors import InputError
from scenes.replacing import CACHE_CURE, make_folder, replacing

Recipe = dict[str, Any]
Arrays = dict[str, np.ndarray]


def folder() -> Path:
    """Where the entries are."""
    return Path(platformdirs.user_cache_dir("airlight")) / "references"


def key(recipe: Recipe) -> str:
    """Hash of a recipe."""
    return hashlib.sha256(json.dumps(recipe, sort_keys=True).encode()).hexdigest()


def load(recipe: Recipe) -> tuple[Arrays, Recipe] | None:
    """Return an entry's arrays and its record, or None.

    A damaged entry is set aside (renamed) and counts as missing. npz is a zip: each array carries a checksum.
    """
    path = _path(recipe)
    if not path.is_file():
        return None
    try:
        with np.load(path, allow_pickle=False) as entry:
            arrays = {name: entry[name] for name in entry.files if name != "record"}
            record = json.loads(str(entry["record"]))
        if record["recipe"] != recipe:
            raise ValueError("the recipe is another one")
    except Exception:
        # what zipfile, numpy and json raise on damaged bytes is of many types, struct.error among them
        with contextlib.suppress(OSError):  # a folder that only others may write keeps it
            path.replace(path.with_suffix(".damaged"))
        return None
    return arrays, record


def check_writable() -> None:
    """Raise InputError where an entry could not be kept: better before the estimate than after it."""
    make_folder(folder(), CACHE_CURE)
    if not os.access(folder(), os.W_OK):
        raise InputError(f"The references cannot be kept in {folder()}: {CACHE_CURE}.")


def store(recipe: Recipe, arrays: Arrays, record: Recipe) -> None:
    """Keep an entry, whole or not at all.

    Raises
    ------
    InputError
        The cache folder cannot be written.
    """
    make_folder(folder(), CACHE_CURE)
    with replacing(_path(recipe), CACHE_CURE) as beside, beside.open("wb") as file:
        np.savez(file, record=np.array(json.dumps(record | {"recipe": recipe})), **arrays)  # type: ignore[arg-type]


def _path(recipe: Recipe) -> Path:
    return folder() / f"{key(recipe)}.npz"
