"""The parts of any program's EXR file: what is in them, and whether that is whole pictures of square pixels."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes.camera import LARGEST_SIDE
from scenes.errors import InputError
from scenes.file_names import check_name
from scenes.messages import readable

# of the attributes that airlight writes
PREFIX = "airlight:"
# of the height of a pixel: header fields are float32, and nobody's pixels are this nearly square by design
SQUARE = 1e-4


@dataclass(frozen=True)
class Part:
    """One part of a file, and of most files the only one.

    Attributes
    ----------
    name : str          empty where the file has one part
    header : dict       its attributes, as the library gives them
    channels : dict     full name to (H, W) float32, row 0 at the top, over the whole display window, which by the
                        format's rule is the same for every part
    outside : int       pixels of the display window that the file holds nothing for, and that are black therefore
    """

    name: str
    header: dict[str, Any]
    channels: dict[str, NDArray[np.float32]]
    outside: int


def read_parts(path: Path) -> list[Part]:
    """Read every part of a file, scanlines or tiles (of those with levels, the finest), half or float.

    Raises
    ------
    InputError
        The file is missing, is not an EXR, is larger than any picture of ours, or has deep pixels, pixels that are not
        square or subsampled channels.
    """
    import OpenEXR

    check_name(path)
    if not os.path.isfile(path):
        raise InputError(f"There is no file {path}.")
    try:
        # first without pixels: deep ones are refused before they fill the memory
        with OpenEXR.File(str(path), header_only=True) as file:
            number = len(file.parts)
            for part in file.parts:
                _check(path, part.header)
        with OpenEXR.File(str(path), separate_channels=True) as file:
            found = [_part(part, number > 1) for part in file.parts]
        if not found or len(found) < number:
            # the library leaves a part out whose pixels it cannot read
            raise ValueError
    except (RuntimeError, ValueError, TypeError, OSError):
        raise InputError(f"{path} is not an OpenEXR file that can be read.") from None
    return found


def _check(path: Path, header: dict[str, Any]) -> None:
    """Raise InputError where a part holds no flat picture of square pixels."""
    import OpenEXR

    if header["type"] in (OpenEXR.deepscanline, OpenEXR.deeptile):
        raise InputError(f"{path} holds deep pixels, each with any number of samples; flatten it, and compare that.")
    first, last = np.asarray(header["displayWindow"], np.int64)
    width, height = last - first + 1
    if not max(width, height) <= LARGEST_SIDE:
        raise InputError(f"{path} has {width} x {height} pixels, and airlight takes {LARGEST_SIDE} on each side.")
    aspect = float(header.get("pixelAspectRatio", 1.0))
    if not abs(aspect - 1) < SQUARE:
        raise InputError(
            f"{path} has pixels {aspect:g} times as wide as high, and airlight's are square; render it with such."
        )
    for channel in header["channels"]:
        if (channel.xSampling, channel.ySampling) != (1, 1):
            raise InputError(
                f"{path} has the channel {readable(channel.name)} at only every {channel.xSampling} x "
                f"{channel.ySampling} pixels; save it as RGB, every channel at every pixel."
            )


def _part(part: Any, several: bool) -> Part:
    # copies: the file empties its own when it is closed
    header = dict(part.header)
    first, last = header["displayWindow"]
    width, height = map(int, last - first + 1)
    x, y = map(int, header["dataWindow"][0] - first)
    channels, inside = {}, 0
    for name, channel in part.channels.items():
        channels[name], inside = _windowed(np.asarray(channel.pixels, np.float32), x, y, (height, width))
    return Part(str(header.get("name", "")) if several else "", header, channels, width * height - inside)


def _windowed(data: NDArray[np.float32], x: int, y: int, shape: tuple[int, int]) -> tuple[NDArray[np.float32], int]:
    """What lies in a display window of `shape` of a plane whose first pixel is at (x, y) in it; and how many pixels."""
    whole = np.zeros(shape, np.float32)
    rows = slice(max(y, 0), max(min(y + data.shape[0], shape[0]), 0))
    columns = slice(max(x, 0), max(min(x + data.shape[1], shape[1]), 0))
    target = whole[rows, columns]
    if target.size:
        target[:] = data[rows.start - y : rows.stop - y, columns.start - x : columns.stop - x]
    return whole, target.size


def notices_of(path: Path, parts: list[Part]) -> Iterator[str]:
    """What people should know of how the file's pixels were taken."""
    if missing := max(part.outside for part in parts):
        yield f"{path} holds nothing for {missing} of its pixels (its data window is smaller); they count as black."


def metadata_of(parts: list[Part]) -> dict[str, str]:
    """What airlight wrote about the file, without the prefix; empty for another program's."""
    header = parts[0].header
    return {key.removeprefix(PREFIX): str(value) for key, value in header.items() if key.startswith(PREFIX)}
