"""Compares two EXR files of any origin."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from experiments.exr import Layers, check_writable, read_exr
from experiments.metrics import Image, Metrics, measure
from experiments.sheet import summary, write_sheet
from scenes.errors import InputError


def compare_files(picture: Path, truth: Path, layer: str, heatmap: Path | None = None) -> Metrics:
    """Measure one layer of a picture against the same layer of a reference.

    Where the reference holds its standard error, the bias is corrected by it.

    Raises
    ------
    InputError
        A file or a layer is missing, the sizes differ, or the heat map cannot be written.
    """
    if heatmap:
        check_writable(heatmap, ".png")
    tested, _ = read_exr(picture)
    reference, metadata = read_exr(truth)
    test_image, reference_image = _layer(picture, tested, layer), _layer(truth, reference, layer)
    metrics = measure(test_image, reference_image, reference.get(f"standard_error.{layer}"))
    if heatmap:
        stand_ins = metadata.get("stand_ins", "")
        note = f"stand-in for {stand_ins}" if stand_ins else ""
        title = f"{picture.name} against {truth.name}: {layer}"
        write_sheet(heatmap, title, test_image, reference_image, summary(asdict(metrics)), note)
    return metrics


def _layer(path: Path, layers: Layers, layer: str) -> Image:
    image = layers.get(layer)
    if image is None or image.ndim != 3:
        colours = [name for name, found in layers.items() if found.ndim == 3]
        raise InputError(f"{path} has no layer '{layer}'; it has {', '.join(colours) or 'no colour layer'}.")
    return image
