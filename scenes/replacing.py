"""Files written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from scenes.errors import InputError

CACHE_CURE = "make room there, make it writable, or set XDG_CACHE_HOME to another folder"


def make_folder(folder: Path, cure: str) -> None:
    """Make a folder and those above it, or raise InputError with the cure."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be made ({error.strerror}): {cure}.") from None


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
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem[:40]}-", suffix=f".part{path.suffix}")
        os.close(handle)
        temporary = Path(name)
        yield temporary
        # mkstemp's files are for their owner alone
        temporary.chmod(0o644)
        temporary.replace(path)
    except OSError as error:
        raise InputError(f"{path} cannot be written ({error.strerror or error}): {cure}.") from None
    finally:
        if temporary:
            temporary.unlink(missing_ok=True)
