"""Pictures that a scene names as reflectance or before a spot."""

from __future__ import annotations

import os
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenes.messages import one_sentence
from scenes.mitsuba_setup import mitsuba
from scenes.model import Texture
from scenes.xml_nodes import Node

# of a side: more than any OpenGL has to offer
LARGEST_SIDE = 16384
FILTERS = ("bilinear", "nearest")
WRAPS = ("repeat", "mirror", "clamp")


def load_texture(node: Node, scene_folder: Path) -> Texture:
    """Read a `bitmap`; the node's file name is replaced by the path of the picture that was found.

    Raises
    ------
    InputError
        Another texture plugin, a property that airlight does not know, a picture that is missing or cannot be used.
    """
    if node.plugin != "bitmap":
        raise node.refuse("is not supported as a texture; use bitmap or an <rgb>.")
    path = Path(scene_folder, node.text("filename")).absolute()
    node.props["filename"] = str(path)
    raw = node.flag("raw")
    filter_type, wrap = node.text("filter_type", "bilinear"), node.text("wrap_mode", "repeat")
    for name, value, known in (("filter_type", filter_type, FILTERS), ("wrap_mode", wrap, WRAPS)):
        if value not in known:
            raise node.refuse(f"has {name} = '{value}'; use {', '.join(known)}.")
    to_uv = node.transform("to_uv")
    # how Mitsuba keeps it, and how it upsamples colours in spectral variants
    node.ignore("format", "accel")
    node.finish()
    pixels = _pixels(node, path, raw)
    return Texture(pixels, to_uv[:2, [0, 1, 3]], filter_type == "nearest", wrap, path)  # type: ignore[arg-type]


def _pixels(node: Node, path: Path, raw: bool) -> NDArray[np.float32]:
    if not os.path.isfile(path):
        raise node.refuse(f"names the picture {path}, and there is no such file.")
    try:
        pixels = _read(path, raw, path.stat().st_mtime_ns)
    except Exception as error:
        # what Mitsuba's readers of seven formats raise is of many types
        raise node.refuse(f"cannot use its picture; {one_sentence(path, str(error))}") from None
    if max(pixels.shape[:2]) > LARGEST_SIDE or 0 in pixels.shape:
        raise node.refuse(f"names {path}, of {pixels.shape[1]} x {pixels.shape[0]} pixels; use 1 to {LARGEST_SIDE}.")
    if not np.isfinite(pixels).all() or (pixels < 0).any():
        raise node.refuse(f"names {path}, which has pixels that are negative or not finite.")
    return pixels


@lru_cache(maxsize=16)
def _read(path: Path, raw: bool, modified: int) -> NDArray[np.float32]:
    mi = mitsuba()
    bitmap = mi.Bitmap(str(path))
    if raw:
        # numbers as they stand: the file's claim that they are sRGB is not believed
        bitmap.set_srgb_gamma(False)
    linear = bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
    pixels = np.array(linear, np.float32)
    pixels.setflags(write=False)
    return pixels
