"""Figures 4.2, 4.6 and 4.8: a ray without shadow, and where the light's projection falls on a ray."""

from __future__ import annotations

import numpy as np

from experiments.figures.choices import (
    no_shadow,
    one_shadow,
    projection_before_the_eye,
    projection_behind_the_surface,
)
from experiments.figures.diagram import LIGHT, RayDiagram, beside_picture, show_pixel
from experiments.figures.entry import Drawn
from experiments.figures.rays import DrawnRay
from experiments.figures.stage import Stage


def general_scene(stage: Stage) -> Drawn:
    """Figure 4.2: nothing is sampled where a ray meets no shadow polygon."""
    ray = no_shadow(stage)
    figure, axes = beside_picture(stage, ray)
    drawing = RayDiagram(axes, ray)
    drawing.lit()
    drawing.place(ray.end, "surface point", row=2)
    begin, end = ray.lit[0]
    return Drawn(
        figure,
        f"OpenGL draws no shadow polygon on this ray, and ray casting finds one lit piece, {begin:.4f} to {end:.4f}, "
        "the "
        f"part inside the spot's cone ({ray.reached[0]:.4f} to {ray.reached[1]:.4f}); the surface is at {ray.end:.4f}.",
    )


def single_scattering(stage: Stage) -> Drawn:
    """Figure 4.6: the symbols of Eq. 16."""
    ray = one_shadow(stage)
    figure, axes = beside_picture(stage, ray)
    _symbols(RayDiagram(axes, ray), "$X_h$")
    return Drawn(figure, f"Measured from X_a: X_h = {ray.x_h:.4f}, X_b = {ray.end:.4f}, h = {ray.h:.4f}.")


def light_projections(stage: Stage) -> Drawn:
    """Figure 4.8: before the eye, on the ray, and behind the surface."""
    from matplotlib.figure import Figure

    rays = (projection_before_the_eye(stage), one_shadow(stage), projection_behind_the_surface(stage))
    figure = Figure(figsize=(9, 9.5), layout="constrained")
    panels = figure.subplots(3, 2, width_ratios=(1, 3))
    told = []
    for (picture, axes), ray, number in zip(panels, rays, (1, 2, 3), strict=True):
        show_pixel(picture, stage, ray)
        _symbols(RayDiagram(axes, ray), f"$Xh_{number}$")
        told.append(f"Xh{number} = {ray.x_h:.3f} with X_b = {ray.end:.3f}")
    return Drawn(
        figure, f"Measured from X_a = 0: {'; '.join(told)}. Which formulation the thesis takes follows from it."
    )


def _symbols(drawing: RayDiagram, projection: str) -> None:
    """X_a, X_b, X_h and h of a ray."""
    ray: DrawnRay = drawing.ray
    axes = drawing.axes
    axes.plot(*np.array([ray.plane.light, (ray.x_h, 0)]).T, color=LIGHT, lw=1, ls=":", zorder=5)
    ends = [0.0, ray.end]
    # the line of the ray, on which the projection lies also where the ray does not reach it
    axes.plot([min(ray.x_h, *ends), max(ray.x_h, *ends)], [0, 0], color="0.7", lw=0.8, ls=":", zorder=3)
    axes.annotate("$h$", (ray.x_h, 0.5 * ray.h), (5, 0), textcoords="offset points", fontsize=10)
    drawing.place(0.0, "$X_a$", row=2)
    drawing.place(ray.end, "$X_b$", row=2)
    drawing.place(ray.x_h, projection, LIGHT, row=2)
