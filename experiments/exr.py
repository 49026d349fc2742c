"""Layered float32 EXR files, as tev shows them."""

from __future__ import annotations

import os
import stat
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from experiments.exr_layers import MAIN, Layers, layers_of
from experiments.exr_parts import PREFIX, metadata_of, notices_of, read_parts
from scenes.errors import InputError
from scenes.file_names import check_name
from scenes.replacing import replacing


def write_exr(path: Path, layers: Mapping[str, np.ndarray], metadata: Mapping[str, object]) -> None:
    """Write layers to a file, beside its place first and then renamed.

    Three channels become name.R, name.G and name.B, one becomes name.Y, and a depth becomes depth.Z: in OpenEXR's
    convention Y is a luminance, and compositing programs look for the depth under Z.
    The composite is there a second time as plain R, G and B. Viewers without layers, and image libraries, show nothing
    else; ZIP finds the repetition, and a frame of 1024 x 1024 pixels grows by 1.5 %, a suite's case by 0.4 %.

    Parameters
    ----------
    layers : name to (H, W, 3) or (H, W)    row 0 at the top
    metadata : kept as text attributes with the prefix "airlight:"

    Raises
    ------
    InputError
        The file cannot be written.
    """
    import OpenEXR

    channels: dict[str, np.ndarray] = {}
    for name, image in layers.items():
        letters = "RGB" if image.ndim == 3 else "Z" if name == "depth" else "Y"
        for letter, plane in zip(letters, np.moveaxis(np.atleast_3d(image), -1, 0), strict=True):
            channels[f"{name}.{letter}"] = np.ascontiguousarray(plane, np.float32)
            if name == MAIN and image.ndim == 3:
                channels[letter] = channels[f"{name}.{letter}"]
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    header |= {PREFIX + key: str(value) for key, value in metadata.items()}
    path = Path(path)
    check_writable(path)
    with replacing(path) as beside:
        try:
            OpenEXR.File(header, channels).write(str(beside))
        except RuntimeError as error:
            # what OpenEXR makes of a full disk
            raise OSError(str(error)) from None


def check_writable(path: Path, ending: str = "") -> None:
    """Raise InputError where `path` could not be written, or lacks its ending: better before the work than after it."""
    check_name(path)
    try:
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise InputError(f"{path} is a folder; name a file in it.")
        # a device would be replaced by the file: whoever is root would lose /dev/null
        if not stat.S_ISREG(mode):
            raise InputError(f"{path} is no ordinary file; choose another place.")
    except FileNotFoundError:
        pass
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be written ({error}); choose another place.") from None
    # of a link, what it points to is written
    folder = Path(os.path.realpath(path)).parent
    check_name(folder)
    if not folder.is_dir():
        raise InputError(f"The folder {folder} does not exist; make it first.")
    if not os.access(folder, os.W_OK) or (path.exists() and not os.access(path, os.W_OK)):
        raise InputError(f"{path} cannot be written; choose another place.")
    # one of a command's input pictures is easily named by mistake
    if not path.name.lower().endswith(ending):
        raise InputError(f"{path} will be written as {ending[1:].upper()}; give it a name that ends in {ending}.")


def read_with_notices(path: Path) -> tuple[Layers, dict[str, str], list[str]]:
    """Read a file of any program.

    Returns
    -------
    layers : name to (H, W, 3) or (H, W), float32     linear Rec.709; `experiments.exr_layers` says which is "composite"
    metadata : dict                                   what airlight wrote, without the prefix
    notices : list of str                             what people should know of how the pixels were taken

    Raises
    ------
    InputError
        The file is missing, is not an EXR, or holds no whole flat picture of square pixels.
    """
    parts = read_parts(path)
    layers, notices = layers_of(path, parts)
    return layers, metadata_of(parts), [*notices_of(path, parts), *notices]


def read_exr(path: Path) -> tuple[Layers, dict[str, str]]:
    """Layers and metadata of a file that airlight wrote, which needs no notice; see `read_with_notices`."""
    layers, metadata, _ = read_with_notices(path)
    return layers, metadata
