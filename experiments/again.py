"""Draws the picture of an EXR file again, from what its metadata say, and compares the two bit for bit."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from experiments.pictures import Picture, read_picture
from experiments.provenance import TECHNIQUE_KEYS, environment, file_hashes
from experiments.renderers import open_renderer
from gpu_impl.frame import Frame
from gpu_impl.own_technique import OwnTechnique, make_known
from gpu_impl.techniques import Technique
from scenes.catalogue import FOLDER
from scenes.errors import InputError
from scenes.loader import load
from scenes.messages import readable
from scenes.model import Scene


@dataclass(frozen=True)
class Again:
    """A picture, drawn anew.

    Attributes
    ----------
    scene : Scene
    frame : Frame            as drawn now
    differing : int          pixels of which some layer differs from the file's in some bit
    layers : tuple of str    those that differ
    largest : float          the largest difference of a value; not finite where the file holds such values
    changed : dict           what draws now and drew then, where the two are not the same: key to (then, now)
    """

    scene: Scene
    frame: Frame
    differing: int
    layers: tuple[str, ...]
    largest: float
    changed: dict[str, tuple[str, str]]

    @property
    def is_expected(self) -> bool:
        """Whether the same program on the same renderer drew the same, or something has changed that explains it."""
        return not self.differing or bool(self.changed)

    def report(self, before: Path) -> str:
        """Say whether these are the same pixels as those of the file `before`."""
        changes = "; ".join(f"{key} was {then} and is {now}" for key, (then, now) in self.changed.items())
        if not self.differing:
            note = f" (though {changes})" if changes else ""
            return f"the same pixels as {before}, bit for bit in {', '.join(self.frame.layers)}{note}"
        by = f"by at most {self.largest:.3g}" if np.isfinite(self.largest) else "which holds values that are not finite"
        pixels = f"{self.differing} of {self.frame.depth.size} pixels differ"
        found = f"{pixels} from {before}, {by}, in {', '.join(self.layers)}"
        return f"{found}; that may be, for {changes}" if changes else f"{found}, though drawn by the same program"


def draw_again(path: Path, scene: str | None = None) -> Again:
    """Draw the picture of an EXR file, or the technique's part of a suite's case, again.

    Parameters
    ----------
    path : the file, written by airlight
    scene : where the scene's file is now; by default where it was

    Raises
    ------
    InputError
        The file does not say how it was drawn, or its scene or one of the meshes is not what it was.
    """
    picture = read_picture(path)
    _check_origin(picture)
    technique = _technique(picture)
    loaded = _load(picture, scene)
    with open_renderer(loaded) as renderer:
        frame = renderer.render(technique)
    drawn = {name: np.ascontiguousarray(image, np.float32) for name, image in frame.layers.items()}
    differing = np.zeros(frame.depth.shape, bool)
    layers, largest = [], 0.0
    for name, image in drawn.items():
        before = _layer(picture, name, image.shape)
        different = before.view(np.uint32) != image.view(np.uint32)
        if different.any():
            layers.append(name)
            # np.maximum, for max() may drop a NaN
            largest = float(np.maximum(largest, np.max(np.abs(image.astype(np.float64) - before))))
        differing |= different.any(axis=-1) if image.ndim == 3 else different
    now = environment() | {"gl_renderer": frame.gl.renderer, "gl_version": frame.gl.version}
    then = {key: _shown(picture, key) for key in now}
    changed = {key: (then[key], now[key]) for key in now if then[key] != now[key]}
    return Again(loaded, frame, int(differing.sum()), tuple(layers), largest, changed)


def _check_origin(picture: Picture) -> None:
    path = picture.path
    if "technique" in picture.metadata:
        return
    if "estimator" in picture.metadata:
        raise InputError(
            f"{path} is a reference, which no technique drew; estimate it again by `airlight reference` with the scene "
            f"{_shown(picture, 'scene')}, --size {_shown(picture, 'size')} and --rel-error "
            f"{_shown(picture, 'rel_error_asked')}."
        )
    raise InputError(f"{path} does not say how it was drawn; give a file that `airlight render` or a suite wrote.")


def _shown(picture: Picture, key: str) -> str:
    """One of the metadata for a sentence, where it may be of any length."""
    return readable(picture.metadata.get(key, "unknown"))


def _text(picture: Picture, key: str) -> str:
    if key not in picture.metadata:
        raise InputError(
            f"{picture.path} lacks '{key}' in its metadata, which another version of airlight wrote "
            f"({_shown(picture, 'airlight')}); render the scene anew."
        )
    return picture.metadata[key]


def _value(picture: Picture, key: str, kind: Any, parse: Callable[[str], Any] = json.loads) -> Any:
    """One of the metadata as a value of some type."""
    text = _text(picture, key)
    try:
        # pydantic's error is a ValueError too
        return TypeAdapter(kind).validate_python(parse(text))
    except (ValueError, RecursionError):
        raise _unusable(picture, key) from None


def _unusable(picture: Picture, key: str) -> InputError:
    return InputError(
        f"{picture.path} says {key} = '{_shown(picture, key)}' in its metadata, which cannot be; render the scene anew."
    )


def _technique(picture: Picture) -> Technique:
    """The technique of a file, each of its fields; one of somebody's own from the texts that it was drawn with."""
    kind = OwnTechnique if TECHNIQUE_KEYS["texts"] in picture.metadata else Technique
    texts = {field.name: _text(picture, TECHNIQUE_KEYS.get(field.name, field.name)) for field in fields(kind)}
    try:
        technique = TypeAdapter(kind).validate_python(texts)
    except ValidationError as error:
        wrong = str(error.errors()[0]["loc"][0])
        raise _unusable(picture, TECHNIQUE_KEYS.get(wrong, wrong)) from None
    if isinstance(technique, OwnTechnique):
        try:
            make_known(technique.file, technique.texts)
        except (ValueError, RecursionError, InputError):
            raise _unusable(picture, TECHNIQUE_KEYS["texts"]) from None
    technique.check()
    return technique


def _load(picture: Picture, override: str | None) -> Scene:
    """The scene of a file, at its size and with its parameters, where it still is the same scene."""
    name = _text(picture, "scene_file")
    parameters = _value(picture, "parameters", dict[str, str])
    if "size" in parameters:
        # no scene can have been given one
        raise _unusable(picture, "parameters")
    width, height = _value(picture, "size", tuple[int, int], str.split)
    path = Path(name) if Path(name).is_absolute() else FOLDER / f"{name}.xml"
    if override is None and not os.path.isfile(path):
        raise InputError(
            f"{picture.path} was drawn from the scene {readable(name)}, which is not there; say where it is now: "
            f"airlight render SCENE --again {picture.path}."
        )
    scene = load(override or path, (width, height), **parameters)
    if scene.digest != _text(picture, "scene_digest"):
        raise _other_scene(picture, scene)
    return scene


def _other_scene(picture: Picture, scene: Scene) -> InputError:
    """What is not as it was: a mesh or a picture, or else the scene's own text."""
    now = file_hashes(scene)
    found = {path.name: path for path in now.values()}
    for name, _, sha256 in (text.rpartition(":") for text in _value(picture, "files", list[str]) if text not in now):
        if name not in found:
            continue
        if name in picture.metadata.get("stand_ins", "").split():
            return InputError(
                f"{picture.path} was drawn with airlight's stand-in for {name}, and the scene now finds {found[name]}: "
                "move that away for the moment, or unset AIRLIGHT_MESH_DIR."
            )
        name, sha256 = readable(name), readable(sha256)
        cure = "into a folder that AIRLIGHT_MESH_DIR names" if name in scene.stand_ins else "in its place"
        return InputError(
            f"{picture.path} was drawn with another {name} than {found[name]}: put the one whose SHA-256 is {sha256} "
            f"{cure}."
        )
    drawn_by = ", ".join(f"{key} {_shown(picture, key)}" for key in ("airlight", "commit", "mitsuba"))
    return InputError(
        f"{picture.path} was not drawn from {scene.path} as it is now: its text, or a file that it includes, differs; "
        f"give the scene as it was ({drawn_by}): airlight render SCENE --again {picture.path}."
    )


def _layer(picture: Picture, name: str, shape: tuple[int, ...]) -> np.ndarray:
    image = picture.layers.get(name)
    if image is None or image.shape != shape:
        raise InputError(
            f"{picture.path} has no layer '{name}' of {shape[1]} x {shape[0]} pixels, as airlight writes it; give the "
            "file as it was written."
        )
    return np.ascontiguousarray(image)
