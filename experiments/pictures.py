"""Frames and references as layered EXR files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from experiments.exr import Layers, write_exr
from experiments.metrics import signed_relative_error
from experiments.provenance import describe_frame, describe_reference, describe_scene
from gpu_impl.frame import Frame
from reference.estimate import Reference
from scenes.model import Scene

LAYERS = ("composite", "scattering", "surface")


def frame_layers(frame: Frame) -> Layers:
    """Layers of a frame."""
    pictures = {layer: getattr(frame, layer) for layer in LAYERS}
    return pictures | {"depth": frame.depth, "lit_intervals": frame.lit_intervals}


def reference_layers(reference: Reference) -> Layers:
    """Layers of a reference, with its standard errors."""
    pictures = {layer: getattr(reference, layer) for layer in LAYERS}
    return pictures | {f"standard_error.{layer}": reference.standard_error(layer) for layer in LAYERS}


def write_frame(path: Path, scene: Scene, frame: Frame) -> None:
    """Write what a technique drew."""
    write_exr(path, frame_layers(frame), describe_scene(scene) | describe_frame(frame))


def write_reference(path: Path, scene: Scene, reference: Reference) -> None:
    """Write what was estimated."""
    write_exr(path, reference_layers(reference), describe_scene(scene) | describe_reference(reference))


def write_case(path: Path, scene: Scene, frame: Frame, reference: Reference) -> None:
    """Write technique, reference and signed relative error in one file."""
    layers = frame_layers(frame)
    for layer in LAYERS:
        truth = getattr(reference, layer)
        layers[f"reference.{layer}"] = truth
        layers[f"standard_error.{layer}"] = reference.standard_error(layer)
        if np.any(truth):
            layers[f"error.{layer}"] = signed_relative_error(getattr(frame, layer), truth)
    write_exr(path, layers, describe_scene(scene) | describe_frame(frame) | describe_reference(reference))
