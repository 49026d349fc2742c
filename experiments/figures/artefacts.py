"""Figures 1.1, 1.2 and 2.1: what the thesis sets out to avoid, drawn by techniques that have it."""

from __future__ import annotations

from functools import partial

import numpy as np

from experiments.figures.choices import SUBJECT, two_shadows
from experiments.figures.diagram import POLYGON, REGION, RayDiagram, place_in_picture
from experiments.figures.entry import Drawn
from experiments.figures.panels import (
    above_and_below,
    error_bar,
    in_words,
    picture_grid,
    scattering_error,
    show,
    show_error,
)
from experiments.figures.stage import Stage

# twice as many as `Dobashi2002` has: still few enough for bands to be seen
SLICES = 128


def too_dark(stage: Stage) -> Drawn:
    """Figure 1.1: with a frontmost and a final shadow polygon alone all between them is dark."""
    scene = stage.scene(SUBJECT)
    wrong, right, truth = stage.frame(scene, "FrontFinal"), stage.frame(scene, "Weng2010"), stage.reference(scene)
    figure, upper, lower = above_and_below(9.6, (2.6, 3.8))
    axes = upper.subplots(1, 4)
    for one in axes:
        one.set_axis_off()
    show(axes[0], wrong.scattering, truth.scattering, "frontmost and final polygon alone")
    show(axes[1], right.scattering, truth.scattering, "samples between them")
    show(axes[2], truth.scattering, truth.scattering, "reference")
    error_bar(upper, show_error(axes[3], wrong.scattering, truth.scattering, "error of the first"), axes[3])
    ray = two_shadows(stage)
    place = np.array(place_in_picture(ray)) * stage.size - 0.5
    for one in axes:
        one.plot(*place, "s", mfc="none", mec=REGION, ms=8)
    drawing = RayDiagram(lower.subplots(), ray)
    drawing.lit()
    drawing.region()
    ends = ray.dark.ravel()
    for number, at in enumerate(ends, start=1):
        drawing.place(at, f"$d_{number}$", POLYGON, row=2)
    drawing.axes.annotate(
        "too dark",
        (0.5 * (ends[1] + ends[2]), 0),
        (30, 45),
        textcoords="offset points",
        arrowprops={"arrowstyle": "->"},
    )
    wrong_error, right_error = scattering_error(wrong, truth), scattering_error(right, truth)
    return Drawn(
        figure,
        f"`{SUBJECT}`, airlight. Below: the marked pixel's ray; d2 = {ends[1]:.3f} to d3 = {ends[2]:.3f} is lit, "
        "and lies "
        f"between the frontmost and the final shadow polygon. Errors: `FrontFinal` {in_words(wrong_error)}; `Weng2010` "
        f"{in_words(right_error)}.",
    )


def aliasing(stage: Stage) -> Drawn:
    """Figure 1.2, with what engines do about it."""
    # the strip takes its panels from this package
    from experiments.studies.marching_strip import figure_1_2

    scene = stage.scene(SUBJECT)
    figure, text = figure_1_2(partial(stage.frame, scene), stage.reference(scene))
    return Drawn(figure, f"`{SUBJECT}`, every pixel evaluated. {text}")


def slices(stage: Stage) -> Drawn:
    """Figure 2.1, by slices parallel to the image."""
    scene = stage.scene("dragon")
    frame, truth = stage.frame(scene, "Dobashi2002", steps=SLICES), stage.reference(scene)
    figure, axes = picture_grid(1, 2, side=3.2)
    show(axes[0, 0], frame.composite, truth.composite, f"Dobashi2002, {SLICES} slices")
    show(axes[0, 1], truth.composite, truth.composite, "reference")
    return Drawn(
        figure,
        "Not Dobashi et al.'s picture, which the thesis shows, but their technique: `Dobashi2002` with "
        f"{SLICES} slices, of which a spot's beam (`dragon`) takes a part. Shafts of light, and bands where slices cut "
        f"their edges. Errors of the airlight: {in_words(scattering_error(frame, truth))}.",
    )
