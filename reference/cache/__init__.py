"""References kept under the user's cache folder, addressed by everything that decides them."""

from __future__ import annotations

from reference.cache.listing import Entry, OtherFiles, entries, other_files
from reference.cache.pruning import Removal, prune
from reference.cache.store import check_writable, folder, key, load, load_record, store

__all__ = [
    "Entry",
    "OtherFiles",
    "Removal",
    "check_writable",
    "entries",
    "folder",
    "key",
    "load",
    "load_record",
    "other_files",
    "prune",
    "store",
]
