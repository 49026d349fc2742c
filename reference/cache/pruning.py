"""What of the cache is of no more use, and its removal."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

from reference.cache.listing import entries, other_files
from scenes.errors import InputError

DAY = 86400.0


@dataclass(frozen=True)
class Removal:
    """A file that was removed, or would be."""

    path: Path
    size: int
    why: str


def prune(
    everything: bool = False,
    older_than: float | None = None,
    stale: bool = False,
    damaged: bool = False,
    dry_run: bool = False,
) -> list[Removal]:
    """Remove what any of the given conditions names; without one, what is stale or damaged.

    Only files that airlight named go; nothing outside `folder()` and no other file in it is touched. What is being
    written, or may be, stays: a leftover goes when it is a day old.

    Parameters
    ----------
    everything : every entry, and what was set aside
    older_than : what was not used for so many days
    stale : entries of other versions, which no present estimate would take
    damaged : entries that are not what was written, by their checksum; what was set aside; leftovers
    dry_run : only tell what would go

    Raises
    ------
    InputError
        A file cannot be read or removed.
    """
    if not (everything or older_than is not None or stale or damaged):
        stale = damaged = True
    now, beside = time.time(), other_files()
    chosen: list[tuple[Path, str]] = []
    for entry in entries(check_bytes=damaged):
        idle, scene = (now - entry.last_used) / DAY, entry.scene or "unknown scene"
        if damaged and entry.damaged:
            chosen.append((entry.path, f"{scene}, damaged: {entry.damaged}"))
        elif stale and entry.stale:
            chosen.append((entry.path, f"{scene}, stale: {entry.stale}"))
        elif older_than is not None and idle > older_than:
            chosen.append((entry.path, f"{scene}, not used for {idle:.0f} days"))
        elif everything:
            chosen.append((entry.path, scene))
    if damaged or everything:
        chosen += [(path, "a damaged entry that was set aside") for path in beside.set_aside]
        old = [path for path in beside.leftovers if now - _last_change(path) > DAY]
        chosen += [(path, "left half written by a program that was killed") for path in old]
    return [removal for path, why in chosen if (removal := _remove(path, why, dry_run))]


def _last_change(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:  # its writer has just renamed it
        return time.time()


def _remove(path: Path, why: str, dry_run: bool) -> Removal | None:
    """Remove a file; None where somebody else did."""
    try:
        size = path.stat().st_size
        if not dry_run:
            path.unlink()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise InputError(f"{path} cannot be removed ({error.strerror}): make its folder writable.") from None
    return Removal(path, size, why)
