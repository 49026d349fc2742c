"""Layers of any program's EXR file: channels sorted under the names that airlight uses, colours in Rec.709."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiments.exr_parts import Part, metadata_of
from reference.estimate import LAYERS
from scenes.errors import InputError
from scenes.messages import readable

Layers = dict[str, np.ndarray]
# the layer that a viewer shows which knows no layers
MAIN = "composite"
# what programs call a channel's colour; a lone one of GREY is a luminance
LETTERS = {"r": "R", "red": "R", "g": "G", "green": "G", "b": "B", "blue": "B"}
GREY = ("y", "l", "luminance")
ALPHA = ("a", "alpha")
# what programs call the picture itself, in lower case: Arnold, Blender, Houdini, Nuke, Unreal, V-Ray and others
PICTURES = ("beauty", "rgba", "rgb", "color", "colour", "combined", "c", "ci", "finalimage", "main")
# of a chromaticity: Rec.709's as written by different programs differ by less, other colour spaces by more
SAME_COLOUR = 1e-3


def layers_of(path: Path, parts: list[Part]) -> tuple[Layers, list[str]]:
    """Sort channels into layers of three colours, or of one channel; whatever else there is, is no picture of ours.

    Plain R, G and B, or a plain luminance, are the layer "composite" where none has that name. Another program's file
    that has neither has one here too, where it is plain which: its only colours, or those that are called as programs
    call the picture. A luminance becomes a grey picture.

    Returns
    -------
    layers : name to (H, W, 3) or (H, W), float32    linear Rec.709
    notices : what people should know of how they were taken

    Raises
    ------
    InputError
        The file's chromaticities are of no colour space.
    """
    layers: Layers = {}
    notices = []
    for part in parts:
        found = _grouped(part)
        colours = [name for name, image in found.items() if image.ndim == 3]
        to_rec709 = _to_rec709(path, part.header.get("chromaticities")) if colours else None
        if to_rec709 is not None:
            notices.append(f"{path} has other primaries than Rec.709 and was converted, its white kept white.")
            found |= {name: (found[name] @ to_rec709.T).astype(np.float32) for name in colours}
        # of parts with one layer name the first counts, as it is the one that other programs show
        layers = found | layers
    plain = layers.pop("", None)
    if plain is not None:
        layers.setdefault(MAIN, plain)
    if MAIN not in layers and not metadata_of(parts) and (name := _main(layers)):
        layers[MAIN] = layers[name]
        notices.append(f"The layer {readable(name)} of {path} is taken for its composite.")
    if MAIN in layers and layers[MAIN].ndim == 2:
        layers[MAIN] = np.repeat(layers[MAIN][..., None], 3, axis=2)
        notices.append(f"{path} has a luminance and no colours; it is taken for a grey picture.")
    # parts of one kind say the same
    return layers, list(dict.fromkeys(notices))


def _grouped(part: Part) -> Layers:
    """One part's layers by their full names; what is plain in the file has the part's name, or none."""
    grouped: dict[str, dict[str, NDArray[np.float32]]] = {}
    for channel, plane in part.channels.items():
        layer, _, letter = channel.rpartition(".")
        if not (layer == part.name or layer.startswith(f"{part.name}.")):
            layer = ".".join(filter(None, (part.name, layer)))
        grouped.setdefault(layer, {})[letter] = plane
    layers: Layers = {}
    for layer, planes in grouped.items():
        colours = {LETTERS[letter.lower()]: plane for letter, plane in planes.items() if letter.lower() in LETTERS}
        if len(colours) == 3:
            layers[layer] = np.stack([colours[letter] for letter in "RGB"], axis=-1)
            continue
        single = {letter.lower(): plane for letter, plane in planes.items() if letter.lower() not in ALPHA}
        # without a name only a luminance is a picture, and not a depth
        if len(single) == 1 and (layer or single.keys() <= set(GREY)):
            (layers[layer],) = single.values()
    return layers


def _main(layers: Mapping[str, NDArray[np.float32]]) -> str | None:
    """Name of the layer that is the picture; None where the file does not say."""
    if layers.keys() & set(LAYERS):
        # whoever uses airlight's names means what they say
        return None
    colours = [name for name, image in layers.items() if image.ndim == 3]
    if len(colours) == 1:
        return colours[0]
    called = [name for name in layers if name.lower().rpartition(".")[2] in PICTURES]
    named = [name for name in called if name in colours] or called
    return named[0] if len(named) == 1 else None


def _to_rec709(path: Path, chromaticities: Sequence[float] | None) -> NDArray[np.floating] | None:
    """Matrix from a file's colours to Rec.709, (3, 3), white to white (Bradford); None where they are Rec.709.

    Parameters
    ----------
    chromaticities : x and y of red, green, blue and white, as an EXR's header has them; None means Rec.709 by the
        format's own rule
    """
    if chromaticities is None:
        return None
    import colour

    ours = colour.RGB_COLOURSPACES["ITU-R BT.709"]
    theirs = np.asarray(chromaticities, np.float64).reshape(4, 2)
    if np.allclose(theirs, [*ours.primaries, ours.whitepoint], rtol=0, atol=SAME_COLOUR):
        return None
    with np.errstate(all="ignore"):
        try:
            space = colour.RGB_Colourspace("of the file", theirs[:3], theirs[3])
            matrix = np.asarray(colour.matrix_RGB_to_RGB(space, ours, "Bradford"))
        except np.linalg.LinAlgError:
            matrix = np.full((3, 3), np.nan)
    # a white of no luminance is no white
    if not (np.isfinite(matrix).all() and theirs[3, 1] > 0):
        raise InputError(f"{path} has chromaticities of no colour space in its header; correct or remove them.")
    return matrix
