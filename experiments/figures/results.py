"""Figures 1.4 and 5.1 to 5.3: the thesis's results, airlight alone, surfaces alone and both, beside the reference."""

from __future__ import annotations

import numpy as np

from experiments.figures.entry import Drawn
from experiments.figures.panels import in_words, picture_grid, scattering_error, show
from experiments.figures.stage import Stage

LAYERS = ("scattering", "surface", "composite")
LAYER_TITLES = {"scattering": "airlight", "surface": "scene", "composite": "both"}
# extinction of a scene without fog: the optical depth across any of the scenes is below 1e-4
NO_FOG = 1e-6
# Weng 2010, chapter 5, prints Rayleigh's phase function as 3/4 (1 + cos^2), which is so many times too bright
PRINTED_RAYLEIGH = 4 * np.pi


def media_and_scene(stage: Stage) -> Drawn:
    """Figure 1.4."""
    fog, clear = stage.scene("donut_dragon"), stage.scene("donut_dragon", sigma_t=NO_FOG)
    figure, axes = picture_grid(2, 2)
    told = []
    for column, (scene, layer, title) in enumerate(
        ((fog, "scattering", "participating media alone"), (clear, "surface", "the scene without media"))
    ):
        frame, truth = stage.frame(scene, "Weng2010"), stage.reference(scene)
        image, right = getattr(frame, layer), getattr(truth, layer)
        show(axes[0, column], image, right, title)
        show(axes[1, column], right, right, "reference")
        told.append(f"{title} {image.mean() / right.mean() - 1:+.3%}")
    return Drawn(figure, f"`donut_dragon` by `Weng2010`, below it the reference. Image means: {', '.join(told)}.")


def final_results(stage: Stage, left: str, right: str) -> Drawn:
    """Figures 5.1 and 5.2: (a) to (c) of one scene, (d) to (f) of another."""
    figure, axes = picture_grid(3, 4)
    told = []
    for side, name in enumerate((left, right)):
        scene = stage.scene(name)
        frame, truth = stage.frame(scene, "Weng2010"), stage.reference(scene)
        for row, layer in enumerate(LAYERS):
            letter = "abcdef"[3 * side + row]
            titles = f"({letter}) {name}: {LAYER_TITLES[layer]}", "reference"
            for column, result, title in zip((2 * side, 2 * side + 1), (frame, truth), titles, strict=True):
                show(axes[row, column], getattr(result, layer), truth.composite, title)
        told.append(f"`{name}` {in_words(scattering_error(frame, truth))}")
    return Drawn(
        figure,
        "`Weng2010` (lit intervals, 128 samples in the shadow region, every pixel evaluated) beside the reference, "
        "isotropic phase function; the scene as it is seen through the fog, so that airlight and scene add up to both. "
        f"Errors of the airlight: {'; '.join(told)}.",
    )


def final_results_1(stage: Stage) -> Drawn:
    """Figure 5.1."""
    return final_results(stage, "donut_dragon", "dragon")


def final_results_2(stage: Stage) -> Drawn:
    """Figure 5.2."""
    return final_results(stage, "yeahright", "many_objects")


def phase_functions(stage: Stage) -> Drawn:
    """Figure 5.3, and what it shows where Rayleigh's function is as chapter 5 prints it."""
    figure, axes = picture_grid(2, 3)
    isotropic = stage.reference(stage.scene("donut_dragon")).composite
    told = []
    scenes = stage.scene("donut_dragon", phase="rayleigh"), stage.scene("donut_dragon")
    for column, scene in enumerate(scenes):
        phase = scene.phase.name
        frame, truth = stage.frame(scene, "Weng2010"), stage.reference(scene)
        show(axes[0, column], frame.composite, isotropic, f"{phase}: Weng2010")
        show(axes[1, column], truth.composite, isotropic, "reference")
        told.append(f"{phase} {in_words(scattering_error(frame, truth))}")
        if phase == "rayleigh":
            bright = frame.surface + PRINTED_RAYLEIGH * frame.scattering
            show(axes[0, 2], bright, isotropic, "3/4 (1 + cos²), as printed")
            bright = truth.surface + PRINTED_RAYLEIGH * truth.scattering
            show(axes[1, 2], bright, isotropic, "reference, as bright")
    return Drawn(
        figure,
        f"`donut_dragon`, all at one exposure. Errors of the airlight: {'; '.join(told)}. Right: the airlight times "
        f"{PRINTED_RAYLEIGH:.4f}, which 3/4 (1 + cos²) integrates to over the sphere, where Eq. 7 has 1.",
    )
