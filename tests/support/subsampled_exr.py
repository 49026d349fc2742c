"""An EXR file with channels of several sampling rates, byte by byte: the library's Python face writes no such file."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np


def write_subsampled(path: Path, channels: dict[str, tuple[np.ndarray, int]]) -> None:
    """Write planes, each at every so many pixels in x and in y, as the format's description has it: no compression."""
    height, width = next(plane.shape for plane, sampling in channels.values() if sampling == 1)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    listed = b"".join(
        name.encode() + b"\0" + struct.pack("<iIii", 2, 0, sampling, sampling)
        for name, (_, sampling) in sorted(channels.items())
    )
    attributes = [
        ("channels", "chlist", listed + b"\0"),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1)),
        ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1)),
    ]
    header = struct.pack("<iI", 20000630, 2)
    for name, kind, value in attributes:
        header += f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value
    header += b"\0"
    blocks = []
    for y in range(height):
        rows = [
            plane[y // sampling].astype("<f4").tobytes()
            for _, (plane, sampling) in sorted(channels.items())
            if y % sampling == 0
        ]
        blocks.append(struct.pack("<ii", y, sum(map(len, rows))) + b"".join(rows))
    place = len(header) + 8 * height
    offsets = []
    for block in blocks:
        offsets.append(place)
        place += len(block)
    path.write_bytes(header + struct.pack(f"<{height}Q", *offsets) + b"".join(blocks))
