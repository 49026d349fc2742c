"""Weng 2010, Figure 1.2, as one picture: what too few samples do to a march, and what engines do about it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from experiments.figures.panels import error_bar, in_words, picture_grid, scattering_error, show, show_error
from experiments.heat_maps.heat_map import HeatMap
from gpu_impl.frame import Frame
from reference.estimate import Reference

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# few enough for bands that a picture of this size shows
STEPS = 16
TECHNIQUES = {
    "regular march": "Nishita1987",
    "jittered": "uniform_march:jittered+riemann",
    "blue noise": "uniform_march:blue_noise+riemann",
    "Weng2010": "Weng2010",
}
# side of a picture on the page [inch]
SIDE = 2.9
# errors up to those of a sample that is missed or stands for too much
HEAT_MAP = HeatMap(signed=True, unit="relative", logarithmic=False, limit=100.0)


class Draw(Protocol):
    """Draws a scene with a technique of this name, and settings of it."""

    def __call__(self, technique: str, *, steps: int) -> Frame: ...


def figure_1_2(draw: Draw, truth: Reference, steps: int = STEPS) -> tuple[Figure, str]:
    """Draw the airlight by marches, regular, jittered and by blue noise, and by lit intervals; the errors below.

    Parameters
    ----------
    draw : of the scene that `truth` is the reference of; it takes the thesis's closed form
    steps : samples a ray, of each of them

    Returns
    -------
    Figure, and its caption
    """
    figure, axes = picture_grid(2, len(TECHNIQUES) + 1, SIDE)
    told, error = [], None
    for column, (title, technique) in enumerate(TECHNIQUES.items()):
        frame = draw(technique, steps=steps)
        show(axes[0, column], frame.scattering, truth.scattering, f"{title}, {steps} samples")
        error = show_error(axes[1, column], frame.scattering, truth.scattering, "error", HEAT_MAP)
        told.append(f"{title} {in_words(scattering_error(frame, truth))}")
    show(axes[0, -1], truth.scattering, truth.scattering, "reference")
    error_bar(figure, error, axes[1, -1], HEAT_MAP)
    # a mean of neighbours would hide the grain, which is of single pixels
    for picture in (picture for one in axes.flat for picture in one.images):
        picture.set_interpolation("nearest")
    height, width = truth.scattering.shape[:2]
    return figure, f"Airlight at {width} x {height}, {steps} samples a ray. Errors: {'; '.join(told)}."
