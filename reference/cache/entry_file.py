"""One reference in one file: an npz with the record of the estimate in it, sealed by a checksum of all its bytes.

Any numpy opens it, without airlight:

    np.load(path)["mean.scattering"]; json.loads(str(np.load(path)["record"]))

and any shell checks it: the last 64 characters of the file are the SHA-256 of all before them,

    head -c -64 FILE | sha256sum; tail -c 64 FILE

They stand in the comment with which a zip ends, so a file that lost its end has no seal, and one that was altered has a
wrong one.
"""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
from typing import Any, BinaryIO

import numpy as np

Record = dict[str, Any]
Arrays = dict[str, np.ndarray]

# raised when an older airlight could not read what this one writes; part of an entry's address too
FORMAT = 2
_MARK = f"airlight reference {FORMAT}, SHA-256 of all before: ".encode()
_DIGITS = 2 * hashlib.sha256().digest_size
_RECORD = "record"
_PIECE = 1 << 20
# how a zip without a comment ends: a signature, 16 bytes of sizes and places, the comment's length
_NO_COMMENT = b"PK\x05\x06" + bytes(18)


class DamagedError(Exception):
    """The file is not what was written; the text says how, as the end of a sentence."""


class OldFormatError(Exception):
    """The file is an entry of an earlier version, which had no seal."""


def write(file: BinaryIO, arrays: Arrays, record: Record) -> None:
    """Write an entry.

    Parameters
    ----------
    file : empty, and open for reading too
    arrays : kept bit for bit; their names hold no "/"
    record : whatever JSON holds
    """
    with zipfile.ZipFile(file, "w") as archive:
        # first, and so near to the eye of whoever opens the file in a hurry
        for name, array in {_RECORD: np.array(json.dumps(record)), **arrays}.items():
            # no length is known before it is written, and it may be above 2 GB
            with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, array, allow_pickle=False)
        archive.comment = _MARK + b"0" * _DIGITS
    digest = _digest(file)
    file.seek(-_DIGITS, os.SEEK_END)
    file.write(digest)


def read(file: BinaryIO) -> tuple[Arrays, Record]:
    """Check the seal and read everything.

    Raises
    ------
    DamagedError, OldFormatError
    """
    check(file)
    record = read_record(file)
    # what a sealed file holds was written by somebody, and need not be an entry
    try:
        file.seek(0)
        with np.load(file, allow_pickle=False) as entry:
            return {name: entry[name] for name in entry.files if name != _RECORD}, record
    except Exception as error:
        raise DamagedError(f"it holds no reference: {error}") from None


def check(file: BinaryIO) -> None:
    """Hold all bytes against the seal.

    Raises
    ------
    DamagedError, OldFormatError
    """
    seal = _seal(file)
    if seal is None:
        read_record(file)
        raise OldFormatError("it has no checksum")
    if _digest(file) != seal:
        raise DamagedError("its bytes are not those of its checksum")


def read_record(file: BinaryIO) -> Record:
    """Read the record alone, of which the zip has a checksum (CRC-32) of its own; the arrays stay unread.

    Raises
    ------
    DamagedError
        The file is not whole, or the record in it is not.
    OldFormatError
    """
    try:
        file.seek(0)
        with np.load(file, allow_pickle=False) as entry:
            record = json.loads(str(entry[_RECORD]))
        if not isinstance(record["recipe"], dict):
            raise TypeError
    except Exception:
        # what zipfile, numpy and json raise on damaged bytes is of many types, struct.error among them
        raise DamagedError("it is not whole") from None
    if _seal(file) is None:
        file.seek(-len(_NO_COMMENT), os.SEEK_END)
        end = file.read()
        if end.startswith(_NO_COMMENT[:4]) and end.endswith(_NO_COMMENT[-2:]):
            raise OldFormatError("it has no checksum")
        raise DamagedError("it is not whole")
    return record


def _seal(file: BinaryIO) -> bytes | None:
    """Checksum at the end of the file; None where there is none."""
    size = file.seek(0, os.SEEK_END)
    file.seek(max(size - len(_MARK) - _DIGITS, 0))
    end = file.read()
    return end[len(_MARK) :] if end.startswith(_MARK) and len(end) == len(_MARK) + _DIGITS else None


def _digest(file: BinaryIO) -> bytes:
    """SHA-256 of all but the digits at the end, as they are written there."""
    left = file.seek(0, os.SEEK_END) - _DIGITS
    file.seek(0)
    digest = hashlib.sha256()
    while left > 0 and (piece := file.read(min(left, _PIECE))):
        digest.update(piece)
        left -= len(piece)
    return digest.hexdigest().encode()
