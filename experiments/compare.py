"""Measures a picture against its reference, whether they were just made, read from files, or are plain arrays."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Protocol, TypeGuard

import numpy as np

from experiments.exr import check_writable
from experiments.exr_layers import MAIN
from experiments.fits_better import fits_better
from experiments.heat_maps.heat_map import HeatMap
from experiments.metrics import Image, Metrics, measure
from experiments.pictures import Picture
from experiments.sheet import ABSOLUTE, SIGNED_RELATIVE, summary, write_sheets
from gpu_impl.frame import Frame
from reference.estimate import LAYERS, Reference
from scenes.errors import InputError
from scenes.messages import readable


class Layered(Protocol):
    """A result: a frame, a reference, or what was read from a file."""

    @property
    def layers(self) -> Mapping[str, Any]:
        """Name to (H, W, 3) or (H, W)."""


def compare(
    test: Image | Layered,
    truth: Image | Layered,
    standard_error: Image | None = None,
    layer: str | None = None,
    sheet: Path | None = None,
) -> Metrics:
    """Measure one layer of a picture against the same layer of a reference.

    Parameters
    ----------
    test, truth : results, or arrays (H, W, 3)
    standard_error : (H, W, 3)    of the reference; by default what the reference knows of it
    layer : of results: "composite", which is the default, "scattering" or "surface"
    sheet : a PNG file to write, with both pictures and their errors

    Raises
    ------
    InputError
        A layer is missing, the sizes or the scenes differ, or the sheet cannot be written.
    """
    return compare_all([test], truth, standard_error, layer, sheet)[0]


def compare_all(
    tests: Sequence[Image | Layered],
    truth: Image | Layered,
    standard_error: Image | None = None,
    layer: str | None = None,
    sheet: Path | None = None,
    heat_maps: Sequence[HeatMap] = (SIGNED_RELATIVE, ABSOLUTE),
) -> list[Metrics]:
    """Measure pictures against one reference, as `compare` does, and draw them on one scale.

    Parameters
    ----------
    heat_maps : of the sheet
    """
    if sheet:
        check_writable(sheet, ".png")
    if layer and not any(map(_is_result, (*tests, truth))):
        raise InputError(f"An array has no layer '{layer}'; compare results, or leave the layer out.")
    layer = layer or MAIN
    digests = {result.scene_digest for result in (*tests, truth) if isinstance(result, Frame | Reference)}
    if len(digests) > 1:
        raise InputError(
            "The picture is not of the reference's scene, or not with its parameters; make both from the same scene."
        )
    images = [_layer(test, layer, "The picture") for test in tests]
    reference = _layer(truth, layer, "The reference")
    if standard_error is None and _is_result(truth):
        standard_error = truth.layers.get(f"standard_error.{layer}")
    noise = None if _is_deterministic(truth) else standard_error
    metrics = [measure(image, reference, noise) for image in images]
    if sheet:
        names = [_name(test, "a picture") for test in tests]
        against = f"against {_name(truth, 'the reference')}: {layer}"
        lines = [summary(asdict(found)) for found in metrics]
        if len(tests) == 1:
            against = f"{names[0]} {against}"
        else:
            lines = [f"{name};  {line}" for name, line in zip(names, lines, strict=True)]
        stand_ins = truth.metadata.get("stand_ins", "") if isinstance(truth, Picture) else ""
        note = f"stand-in for {readable(stand_ins)}" if stand_ins else ""
        rows = list(zip(lines, images, strict=True))
        write_sheets(sheet, against, rows, reference, standard_error, note, heat_maps)
    return metrics


def notices(test: Picture, truth: Picture, layer: str) -> Iterator[str]:
    """Say what people should know of a comparison of two files that can be compared; nothing where all is plain."""
    for picture in (test, truth):
        yield from picture.notices
        if layer not in picture.layers:
            yield f"The only picture in {picture.path} is taken for its {layer} layer."
    yield from filter(None, [other_scene(test, truth)])
    if better := fits_better(_layer(test, layer, ""), _layer(truth, layer, "")):
        yield f"{test.path} fits far better {better}."


def other_scene(test: Picture, truth: Picture) -> str:
    """Say of what each is where two files are not of one scene; empty where they are, or where one does not say."""
    digests = [picture.metadata.get("scene_digest") for picture in (test, truth)]
    if None in digests or digests[0] == digests[1]:
        return ""
    said = (
        f"{picture.path} is of the scene {readable(picture.metadata.get('scene', 'unknown'))} with the parameters "
        f"{readable(picture.metadata.get('parameters', 'unknown'))}"
        for picture in (test, truth)
    )
    return f"These are not pictures of one scene: {' and '.join(said)}."


def _is_result(result: Any) -> TypeGuard[Layered]:
    return hasattr(result, "layers")


def _is_deterministic(truth: Any) -> bool:
    """Whether what it knows of its errors is a bound, and no noise."""
    if isinstance(truth, Picture):
        return truth.metadata.get("stopped_by") == "exact"
    return isinstance(truth, Reference) and truth.noise(MAIN) is None


def _layer(result: Any, layer: str, role: str) -> Image:
    if not _is_result(result):
        return np.asarray(result)
    image = result.layers.get(layer)
    if image is None and layer in LAYERS and isinstance(result, Picture) and not result.metadata:
        image = _only_picture(result)
    if image is None or image.ndim != 3:
        colours = [name for name, found in result.layers.items() if found.ndim == 3]
        whose = result.path if isinstance(result, Picture) else role
        raise InputError(f"{whose} has no layer '{layer}'; it has {', '.join(colours) or 'no colour layer'}.")
    return image


def _only_picture(picture: Picture) -> Image | None:
    """What a file holds whose program has no name for the layer; None where it holds several pictures, or ours."""
    main = picture.layers.get(MAIN)
    others = {name: image for name, image in picture.layers.items() if image.ndim == 3 and name != MAIN}
    # a layer that was taken for the composite is there under both names
    is_only = all(image is main and name not in LAYERS for name, image in others.items())
    return main if is_only else None


def _name(result: Any, otherwise: str) -> str:
    if isinstance(result, Picture):
        return result.path.name
    return result.technique.name if isinstance(result, Frame) else otherwise
