"""The public face of airlight, for scripts and notebooks.

>>> import airlight
>>> scene = airlight.load("sphere", size=(64, 64))
>>> frame = airlight.render(scene, "Weng2010")
>>> truth = airlight.reference(scene, rel_error=0.02)
>>> airlight.compare(frame, truth, layer="scattering").rel_50 < 0.05
True
>>> frame.layers["scattering"].shape
(64, 64, 3)

Frames, references and the files of `save` call their arrays alike: `composite`, `scattering`, `surface`, and beside
them a frame's `depth` and `lit_intervals`, or a reference's `standard_error.composite`, `.scattering` and `.surface`.
All are linear Rec.709 with row 0 at the top.

Import it before `drjit` or `mitsuba`: it chooses an LLVM library that Dr.Jit works with.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenes.errors import InputError

if TYPE_CHECKING:
    from experiments.attribution.measurement import Attribution
    from experiments.compare import Layered
    from experiments.metrics import Image, Metrics
    from experiments.pictures import Picture
    from gpu_impl.frame import Frame
    from gpu_impl.techniques import Technique
    from reference.convergence import Progress
    from reference.deterministic import LitIntervals
    from reference.estimate import Reference
    from reference.goal import PixelFilter
    from scenes.model import Scene

__all__ = [
    "InputError",
    "attribute",
    "compare",
    "lit_intervals",
    "load",
    "milliseconds",
    "read",
    "reference",
    "render",
    "save",
]


def load(scene: str | Path, /, size: tuple[int, int] | None = None, **parameters: object) -> Scene:
    """Load a scene.

    Parameters
    ----------
    scene : name of a shipped scene, or path of any Mitsuba XML file
    size : (width, height) [pixel]; the film's own by default
    parameters : values for the file's `$name` parameters, such as sigma_t=0.2

    Raises
    ------
    InputError
        The file is missing, is not a scene, or holds something outside the supported subset.
    """
    from scenes.loader import load as load_scene

    return load_scene(scene, size, **parameters)


def render(scene: Scene, technique: str = "Weng2010", **settings: Any) -> Frame:
    """Draw a scene with an OpenGL technique.

    Parameters
    ----------
    technique : a name, or a cell of the product such as "lit_intervals+quadrature"
    settings : those of `gpu_impl.techniques.Technique`, such as steps=256; the technique's own by default

    Returns
    -------
    Frame
        Its arrays by name are `layers`; `scattering`, `surface`, `composite` (H, W, 3), `depth` [scene unit] and
        `lit_intervals` (H, W) are attributes too; float32.

    Raises
    ------
    InputError
        There is no such technique or setting, it cannot take this scene, or there is no OpenGL.
    """
    from experiments.renderers import open_renderer

    chosen = _technique(technique, settings)
    with open_renderer(scene) as renderer:
        return renderer.render(chosen)


def milliseconds(scene: Scene, technique: str = "Weng2010", **settings: Any) -> float:
    """Median time of a frame [ms]: wall clock, all passes up to glFinish, nothing kept from the frame before.

    Parameters and what is raised: see `render`.
    """
    from experiments.renderers import open_renderer

    chosen = _technique(technique, settings)
    with open_renderer(scene) as renderer:
        # the first frame compiles and allocates
        renderer.render(chosen)
        return renderer.milliseconds(chosen)


def reference(
    scene: Scene,
    rel_error: float = 0.005,
    time_limit: float = 600.0,
    report: Callable[[Progress], None] | None = None,
    *,
    percentile: float = 95.0,
    sample_limit: int | None = None,
    pixel_filter: PixelFilter = "centre",
    deterministic: bool = False,
) -> Reference:
    """Estimate a scene's reference in Mitsuba, or take it from the cache, or go on with one that was stopped.

    Parameters
    ----------
    rel_error : standard error to reach, relative to the pixel, at a percentile of lit pixels
    time_limit : [s]; where it is reached first, the reference says how far it got
    report : called after each pass, for a progress bar
    percentile : which one
    sample_limit : samples a pixel, on average over the image; the reference says so where it is reached first
    pixel_filter : "centre" for rays through pixel centres, as techniques are drawn, or "box" for averages over pixels
    deterministic : ray casting and quadrature instead of samples, through pixel centres; goals and limits are idle

    Returns
    -------
    Reference
        Its arrays by name are `layers`; `scattering`, `surface`, `composite` are attributes and `standard_error(layer)`
        a method; (H, W, 3) float64.

    Raises
    ------
    InputError
        The goal cannot be meant, the estimate is zero everywhere or not finite, or the cache cannot be written.
    """
    from reference.estimate import deterministic_reference, estimate_reference
    from reference.goal import Goal

    if deterministic:
        if pixel_filter != "centre":
            raise InputError("The deterministic reference is of pixel centres; leave the pixel filter out.")
        return deterministic_reference(scene)
    return estimate_reference(scene, Goal(rel_error, time_limit, percentile, sample_limit), report, pixel_filter)


def lit_intervals(scene: Scene) -> LitIntervals:
    """Find which pieces of each pixel's ray each light reaches and sees, by ray casting in Mitsuba.

    Returns
    -------
    LitIntervals
        Flat arrays `pixel`, `light`, `begin` and `end` [scene unit along the pixel's ray], sorted, and `offsets` into
        them; see `reference.deterministic`.

    Raises
    ------
    InputError
        There is no usable LLVM, without which rays are too slow.
    """
    from reference.deterministic import lit_intervals as find

    return find(scene)


def compare(
    test: Image | Layered,
    truth: Image | Layered,
    standard_error: Image | None = None,
    layer: str | None = None,
    sheet: str | Path | None = None,
) -> Metrics:
    """Measure how far a picture is from its reference, and draw the two with their errors where asked to.

    Parameters
    ----------
    test, truth : what `render`, `reference` or `read` returned, or arrays (H, W, 3)
    standard_error : (H, W, 3)    of the reference, which the bias is corrected by; a `Reference` brings its own
    layer : which one of results: "composite", the default, "scattering" or "surface"
    sheet : a PNG file to write

    Returns
    -------
    Metrics
        Relative errors as fractions; see `experiments.metrics.Metrics`.

    Raises
    ------
    InputError
        The sizes or the scenes differ, a layer is missing, values are not finite, or the sheet cannot be written.
    """
    from experiments.compare import compare as compare_results

    return compare_results(test, truth, standard_error, layer, Path(sheet) if sheet else None)


def attribute(scene: Scene, truth: Reference, technique: str = "Weng2010", **settings: Any) -> Attribution:
    """Split the error of a technique's airlight over airlight model, visibility, shadow map, lattice and float32.

    Parameters
    ----------
    truth : what `reference` returned for the scene
    technique, settings : see `render`

    Returns
    -------
    Attribution
        Its `split` has the `whole` error, the Shapley value of each of the `parts`, and what `remains`; each with a
        `value`, a `standard_error` and a `signed` error per pixel.

    Raises
    ------
    InputError
        As `render`; or an exact part cannot take the scene.
    """
    from experiments.attribution.measurement import attribute as split_error
    from experiments.attribution.pictures import Pictures

    chosen = _technique(technique, settings)
    with Pictures(scene) as pictures:
        return split_error(pictures, chosen, truth)


def save(path: str | Path, scene: Scene, result: Frame | Reference, truth: Reference | None = None) -> None:
    """Write a frame, a reference, or a frame beside its reference, with their errors, as one layered float32 EXR.

    Its metadata say what made it: `airlight render --again` draws a frame anew from them.

    Parameters
    ----------
    scene : the scene that was drawn
    truth : the reference beside a frame

    Raises
    ------
    InputError
        The file cannot be written, is not called .exr, or would name a scene that the result is not of.
    """
    from experiments.exr import check_writable
    from experiments.pictures import write_case, write_frame, write_reference
    from gpu_impl.frame import Frame

    check_writable(Path(path), ".exr")
    if truth is not None and (not isinstance(result, Frame) or isinstance(truth, Frame)):
        raise InputError(f"{path}: a frame may have a reference beside it, and nothing else; save each alone.")
    if not isinstance(result, Frame):
        write_reference(Path(path), scene, result)
    elif truth is None:
        write_frame(Path(path), scene, result)
    else:
        write_case(Path(path), scene, result, truth)


def read(path: str | Path) -> Picture:
    """Read an EXR file of any program: its `layers` by name, float32, and its `metadata`.

    Raises
    ------
    InputError
        The file is missing or is not an EXR.
    """
    from experiments.pictures import read_picture

    return read_picture(path)


def _technique(name: str, settings: dict[str, Any]) -> Technique:
    """Look a technique up, with settings that it has."""
    from gpu_impl.techniques import SETTINGS, find_technique

    known = ("visibility", "airlight", *SETTINGS)
    for setting in settings:
        if setting not in known:
            raise InputError(f"There is no setting '{setting}'; a technique has {', '.join(known)}.")
    return find_technique(name, **settings)
