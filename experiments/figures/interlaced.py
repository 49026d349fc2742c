"""Figure 5.4: dark and light pieces of a ray behind a wire mesh."""

from __future__ import annotations

import numpy as np

from experiments.figures.diagram import REGION, RayDiagram, place_in_picture
from experiments.figures.entry import Drawn
from experiments.figures.panels import above_and_below, in_words, scattering_error, show
from experiments.figures.rays import DrawnRay, RayField
from experiments.figures.stage import Stage

SCENE = "wire_mesh"


def most_pieces(stage: Stage) -> DrawnRay:
    """The ray with the most lit pieces; of several the one whose shortest piece is longest."""

    def score(field: RayField, pixel: int) -> float:
        lit = field.pieces(pixel)
        # no piece is as long as the far plane is away
        return len(lit) + float(np.diff(lit.ravel()).min()) / field.scene.camera.far if len(lit) > 1 else -np.inf

    return stage.field(SCENE).best(score)


def dark_and_light(stage: Stage) -> Drawn:
    """Figure 5.4."""
    scene = stage.scene(SCENE)
    frame, truth = stage.frame(scene, "Weng2010"), stage.reference(scene)
    ray = most_pieces(stage)
    figure, upper, lower = above_and_below(9.6, (3.0, 4.2))
    axes = upper.subplots(1, 3)
    show(axes[0], frame.composite, truth.composite, "Weng2010")
    show(axes[1], truth.composite, truth.composite, "reference")
    counted = axes[2].imshow(frame.lit_intervals, cmap="cividis")
    axes[2].set_title("lit pieces of a ray", fontsize=8)
    upper.colorbar(counted, ax=axes[2])
    for one in axes:
        one.plot(*(np.array(place_in_picture(ray)) * stage.size - 0.5), "s", mfc="none", mec=REGION, ms=8)
        one.set_axis_off()
    begin, end = ray.reached
    wide = end - begin
    drawing = RayDiagram(lower.subplots(), ray, (begin - wide, end + wide, -0.5 * wide, ray.h + 0.5))
    drawing.lit()
    found, most = frame.lit_intervals, int(frame.lit_intervals.max())
    return Drawn(
        figure,
        f"`{SCENE}` by `Weng2010`, {found[found > 0].mean():.2f} lit pieces a ray that has any, {most} at most. "
        f"Below: the marked pixel's ray, which ray casting finds {len(ray.lit)} lit pieces on. Errors of the airlight: "
        f"{in_words(scattering_error(frame, truth))}.",
    )
