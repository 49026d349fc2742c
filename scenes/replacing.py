"""Files written whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from scenes.errors import InputError

CACHE_CURE = "make room there, make it writable, or set XDG_CACHE_HOME to another folder"


def make_folder(folder: Path, cure: str) -> None:
    """Make a folder and those above it; where that fails, or it may not be written to, InputError has the cure."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be made ({error.strerror}): {cure}.") from None
    if not os.access(folder, os.W_OK):
        raise InputError(f"{folder} cannot be written to: {cure}.")


@contextmanager
def replacing(path: Path, cure: str = "make room there, or choose another place") -> Iterator[Path]:
    """Give a new file beside `path` to write to; it takes the place of `path` where the block ends well.

    Whatever goes wrong, an interruption too, the new file is gone and the old one is as it was.

    Parameters
    ----------
    cure : what to do where the folder cannot be written

    Raises
    ------
    InputError
        An OSError on the way, as one sentence.
    """
    temporary = None
    try:
        # what a link points to is written, and the link stays
        target = Path(os.path.realpath(path)) if path.is_symlink() else path
        beside = target.with_name(f".{target.stem[:40]}-{secrets.token_hex(4)}.part{target.suffix}")
        # the umask decides who may read it, as for any new file
        os.close(os.open(beside, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        temporary = beside
        yield temporary
        temporary.replace(target)
    except OSError as error:
        raise InputError(f"{path} cannot be written ({error.strerror or error}): {cure}.") from None
    finally:
        if temporary:
            temporary.unlink(missing_ok=True)
