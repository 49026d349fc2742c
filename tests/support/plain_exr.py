"""A reader of scanline EXR files with ZIP compression, from the format's description and without its library."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ZIP, ROWS_OF_ZIP = 3, 16
FLOAT32 = 2


@dataclass(frozen=True)
class PlainExr:
    """Channels by their full names, (H, W) float32, row 0 at the top; text attributes."""

    channels: dict[str, np.ndarray]
    texts: dict[str, str]


def read_plain(path: Path) -> PlainExr:
    """Read a file, as https://openexr.com/en/latest/OpenEXRFileLayout.html describes it."""
    data = path.read_bytes()
    magic, version = struct.unpack_from("<iI", data)
    assert magic == 20000630
    # version 2, one part, scanlines, nothing deep; bit 10 allows names of more than 31 bytes
    assert version & ~(1 << 10) == 2
    attributes, place = _attributes(data, 8)
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"][1])
    assert (left, top) == (0, 0)
    width, height = right + 1, bottom + 1
    assert attributes["compression"][1] == bytes([ZIP])
    # increasing y: the first row is the top one
    assert attributes["lineOrder"][1] == bytes([0])
    names = _channel_names(attributes["channels"][1])
    assert names == sorted(names)
    planes = np.empty((len(names), height, width), np.float32)
    blocks = -(-height // ROWS_OF_ZIP)
    for offset in struct.unpack_from(f"<{blocks}Q", data, place):
        y, size = struct.unpack_from("<ii", data, offset)
        rows = min(ROWS_OF_ZIP, height - y)
        raw = _unzip(data[offset + 8 : offset + 8 + size], rows * width * len(names) * 4)
        # each row holds its channels one after the other
        planes[:, y : y + rows] = np.frombuffer(raw, "<f4").reshape(rows, len(names), width).swapaxes(0, 1)
    texts = {name: value.decode() for name, (kind, value) in attributes.items() if kind == "string"}
    return PlainExr(dict(zip(names, planes, strict=True)), texts)


def _attributes(data: bytes, place: int) -> tuple[dict[str, tuple[str, bytes]], int]:
    """Name to type and bytes, and where the header ends."""
    found = {}
    while data[place]:
        name, place = _text(data, place)
        kind, place = _text(data, place)
        (size,) = struct.unpack_from("<i", data, place)
        found[name] = kind, data[place + 4 : place + 4 + size]
        place += 4 + size
    return found, place + 1


def _text(data: bytes, place: int) -> tuple[str, int]:
    end = data.index(0, place)
    return data[place:end].decode(), end + 1


def _channel_names(data: bytes) -> list[str]:
    names, place = [], 0
    while data[place]:
        name, place = _text(data, place)
        kind, _, x_sampling, y_sampling = struct.unpack_from("<iIii", data, place)
        assert (kind, x_sampling, y_sampling) == (FLOAT32, 1, 1)
        names.append(name)
        place += 16
    return names


def _unzip(packed: bytes, size: int) -> bytes:
    """Undo deflate, the differences between neighbours, and the parting of even and odd bytes."""
    if len(packed) == size:
        # what does not shrink is stored as it is
        return packed
    differences = np.frombuffer(zlib.decompress(packed), np.uint8).astype(np.int64)
    differences[1:] -= 128
    parted = np.cumsum(differences).astype(np.uint8)
    whole = np.empty(size, np.uint8)
    half = (size + 1) // 2
    whole[0::2], whole[1::2] = parted[:half], parted[half:]
    return whole.tobytes()
