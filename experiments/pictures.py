"""Frames and references as layered EXR files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from experiments.exr import read_with_notices, write_exr
from experiments.exr_layers import Layers
from experiments.metrics import signed_relative_error
from experiments.provenance import (
    describe_files,
    describe_frame,
    describe_own_files,
    describe_reference,
    describe_scene,
)
from gpu_impl.frame import Frame
from reference.estimate import LAYERS, Reference
from scenes.errors import InputError
from scenes.model import Scene


@dataclass(frozen=True)
class Picture:
    """What an EXR file holds.

    Attributes
    ----------
    path : Path
    layers : dict            name to (H, W, 3) or (H, W), float32, row 0 at the top
    metadata : dict          what airlight wrote into it, as text; empty for another program's file
    notices : tuple of str   what people should know of how its pixels were taken
    """

    path: Path
    layers: Layers
    metadata: dict[str, str]
    notices: tuple[str, ...] = ()

    def __repr__(self) -> str:
        """One line, for notebooks."""
        return f"<Picture {self.path.name}: {', '.join(self.layers)}>"


def read_picture(path: str | Path) -> Picture:
    """Read an EXR file of any program; see `experiments.exr.read_with_notices`."""
    layers, metadata, notices = read_with_notices(Path(path))
    return Picture(Path(path), layers, metadata, tuple(notices))


def write_frame(path: Path, scene: Scene, frame: Frame) -> None:
    """Write what a technique drew."""
    _write(path, scene, frame.layers, _drawn(frame), frame)


def write_reference(path: Path, scene: Scene, reference: Reference) -> None:
    """Write what was estimated."""
    _write(path, scene, reference.layers, describe_reference(reference), reference)


def write_case(path: Path, scene: Scene, frame: Frame, reference: Reference) -> None:
    """Write technique, reference and signed relative error in one file."""
    layers = frame.layers
    for layer in LAYERS:
        truth = getattr(reference, layer)
        layers[f"reference.{layer}"] = truth
        layers[f"standard_error.{layer}"] = reference.standard_error(layer)
        if np.any(truth > 0):
            layers[f"error.{layer}"] = signed_relative_error(getattr(frame, layer), truth)
    _write(path, scene, layers, _drawn(frame) | describe_reference(reference), frame, reference)


def _drawn(frame: Frame) -> dict[str, str]:
    return describe_frame(frame) | describe_own_files(frame.technique)


def _write(path: Path, scene: Scene, layers: Layers, metadata: dict[str, str], *results: Frame | Reference) -> None:
    width, height = scene.camera.width, scene.camera.height
    same_scene = all(result.scene_digest == scene.digest for result in results)
    if not same_scene or any(image.shape[:2] != (height, width) for image in layers.values()):
        # the metadata would name a scene that the picture is not of
        parameters = "".join(f", {name}={value}" for name, value in scene.parameters.items())
        what = " or the reference" if len(results) > 1 else ""
        raise InputError(
            f"{path}: the picture{what} is not of the scene {scene.name} at {width} x {height} pixels{parameters}; "
            "give the scene that it was made from."
        )
    write_exr(path, layers, describe_scene(scene) | describe_files(scene) | metadata)
