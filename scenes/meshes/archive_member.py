"""One known file taken out of an archive that nobody vouches for."""

from __future__ import annotations

import errno
import hashlib
import lzma
import tarfile
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import IO

from scenes.errors import InputError

# the largest original that is fetched has 34 MB
LARGEST_MEMBER = 256 * 2**20
# what an archive may unpack to on the way to its member
LARGEST_CONTENT = 2 * 2**30
CHUNK = 2**20
# what the readers of tar, zip and their compressions raise for bytes that are wrong
DAMAGED = (
    *(tarfile.TarError, zipfile.BadZipFile, zlib.error, lzma.LZMAError),
    *(EOFError, OSError, NotImplementedError, ValueError, RuntimeError),
)


def unpack_member(archive: Path, member: str, sha256: str, target: Path, address: str) -> None:
    """Write the file called `member`, in whatever folder of the archive it is, to `target`, if its bytes are right.

    No path of the archive is ever used, only compared: a `..` or a link in it leads nowhere.

    Parameters
    ----------
    sha256 : hexadecimal hash that the file must have
    address : where the archive came from, for the sentence

    Raises
    ------
    InputError   it is no tar or zip archive, is damaged or too large, or has no such file with this hash; `target`
                 may then exist
    OSError      `target` cannot be written
    """
    found = ""
    try:
        for stream in _members(archive, member):
            found = _copy(stream, target)
            if found == sha256:
                return
    except DAMAGED as error:
        # a full disk has a number of its own; damaged gzip has none, a seek to nowhere has EINVAL
        if isinstance(error, OSError) and error.errno not in (None, errno.EINVAL):
            raise
        raise InputError(
            f"{address} gave something that is no whole tar or zip archive; look at that address in a browser."
        ) from None
    if found:
        raise InputError(
            f"{address} has a {member} with the sha256 {found} where {sha256} is expected: it was changed, there or on "
            "the way, and is not used."
        )
    raise InputError(f"{address} has no file {member} of up to {LARGEST_MEMBER >> 20} MB; it has changed there.")


def _members(archive: Path, member: str) -> Iterator[IO[bytes]]:
    """The regular files of this name, opened one after the other."""
    total = 0
    if zipfile.is_zipfile(archive):
        with zipfile.ZipFile(archive) as zipped:
            for info in zipped.infolist():
                # bit 0: encrypted, which no original is
                if _is_it(info.filename, info.file_size, member) and not info.flag_bits & 1:
                    with zipped.open(info) as stream:
                        yield stream
        return
    with tarfile.open(archive, "r:*") as tarred:
        for entry in tarred:
            total += entry.size
            if total > LARGEST_CONTENT:
                raise tarfile.TarError("larger than any archive of meshes")
            if entry.isreg() and _is_it(entry.name, entry.size, member):
                opened = tarred.extractfile(entry)
                if opened:
                    with opened:
                        yield opened


def _is_it(path: str, size: int, member: str) -> bool:
    return PurePosixPath(path).name == member and size <= LARGEST_MEMBER


def _copy(stream: IO[bytes], target: Path) -> str:
    """Copy at most LARGEST_MEMBER bytes, whatever the archive declares; the hash of what was copied."""
    digest, left = hashlib.sha256(), LARGEST_MEMBER
    with target.open("wb") as file:
        while left > 0 and (chunk := stream.read(min(CHUNK, left))):
            file.write(chunk)
            digest.update(chunk)
            left -= len(chunk)
    return digest.hexdigest()
