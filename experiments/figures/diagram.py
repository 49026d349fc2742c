"""Draws the plane of a ray and its light: what is lit, what is cut, and what the thesis's names are on it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from experiments.figures.plane import Array
from experiments.figures.rays import DrawnRay
from experiments.sheet import display

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from experiments.figures.stage import Stage

# Okabe and Ito's colours, which colour-blind people can tell apart; orange is the thesis's for lit pieces
LIT, DARK, REGION = "#e69f00", "#3b3b3b", "#56b4e9"
POLYGON, RAY, LIGHT = "#0072b2", "#7f7f7f", "#d55e00"
FOG_LIT = "#fff4cc"
# left, right, bottom and top of a picture, whatever its pixels
PICTURE = (0.0, 1.0, 1.0, 0.0)
# of the height of the drawing, from the ray to the texts below it
BELOW = 0.05


class RayDiagram:
    """A drawing of one ray's plane, with the ray from left to right and the light above.

    Parameters
    ----------
    axes : to draw on
    window : (x0, x1, y0, y1)   what is shown [scene unit]; by default from the eye to behind the ray's end
    """

    def __init__(self, axes: Axes, ray: DrawnRay, window: Sequence[float] | None = None) -> None:
        self.axes, self.ray = axes, ray
        x_h, h = ray.x_h, ray.h
        # a ray may go on far behind all that the light reaches
        left, right = min(0.0, x_h), max(min(ray.end, 1.2 * ray.reached[1]), x_h)
        margin = 0.06 * (right - left)
        self.window = tuple(window or (left - margin, right + 2 * margin, -0.28 * max(h, 2.0), h + 0.8))
        self.height = self.window[3] - self.window[2]
        self._surroundings()

    def _surroundings(self) -> None:
        from matplotlib.collections import LineCollection

        axes, plane = self.axes, self.ray.plane
        x0, x1, y0, y1 = self.window
        corners = np.array([(x, y) for x in (x0, x1) for y in (y0, y1)])
        reach = float(np.linalg.norm(corners - plane.light, axis=1).max())
        axes.fill(*plane.lit_outline(reach).T, color=FOG_LIT, lw=0, zorder=0)
        axes.add_collection(LineCollection(list(plane.cuts), colors="black", linewidths=1.6, zorder=3))
        lines = list(plane.shadow_lines(reach))
        axes.add_collection(LineCollection(lines, colors=POLYGON, linewidths=0.8, linestyles="--", zorder=2))
        axes.plot([0, self.ray.end], [0, 0], color=RAY, lw=1.2, zorder=4)
        axes.plot(*plane.light, "*", color=LIGHT, ms=13, zorder=6, clip_on=True)
        axes.plot(0, 0, ">", color="black", ms=9, zorder=6, clip_on=True)
        for place, text in ((plane.light, "light"), (np.zeros(2), "eye")):
            if x0 <= place[0] <= x1 and y0 <= place[1] <= y1:
                axes.annotate(
                    text, (place[0], place[1]), xytext=(0, 8), textcoords="offset points", ha="center", fontsize=8
                )
        axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal")
        axes.set_axis_off()

    def lit(self, pieces: Array | None = None) -> None:
        """Draw lit pieces of the ray, by default all of them, as the thesis's orange segments."""
        for begin, end in self.ray.lit if pieces is None else pieces:
            self.axes.plot([begin, end], [0, 0], color=LIT, lw=4, solid_capstyle="butt", zorder=5)

    def region(self, name: str = "") -> None:
        """Shade the ray's shadow region, from its first to its last shadow polygon."""
        from matplotlib.patches import Rectangle

        half = 0.5 * BELOW * self.height
        front, final = self.ray.front, self.ray.final
        self.axes.add_patch(
            Rectangle((front, -half), final - front, 2 * half, color=REGION, alpha=0.45, lw=0, zorder=1)
        )
        if name:
            self.axes.text(0.5 * (front + final), 1.3 * half, name, ha="center", va="bottom", fontsize=9, zorder=7)

    def place(self, at: float, name: str, colour: str = "black", row: int = 1) -> None:
        """Mark a place on the ray; `row` counts lines of text below it, or above it where it is negative."""
        self.axes.plot(at, 0, "o", color=colour, ms=5, zorder=8)
        down = -row * BELOW * self.height
        self.axes.annotate(
            name,
            (at, 0),
            (at, 1.15 * down),
            fontsize=9,
            ha="center",
            va="center",
            color=colour,
            arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.6},
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8, "alpha": 0.8},
            zorder=8,
        )

    def length(self, begin: float, end: float, name: str, row: int = 2) -> None:
        """A dimension line below the ray, or above it where `row` is negative, from one place to another."""
        y = -row * BELOW * self.height
        arrow = {"arrowstyle": "<->", "lw": 0.8, "color": "black", "shrinkA": 0, "shrinkB": 0}
        self.axes.annotate("", (begin, y), (end, y), arrowprops=arrow, zorder=7)
        self.axes.text(
            0.5 * (begin + end),
            y,
            name,
            ha="center",
            va="center",
            fontsize=8,
            zorder=8,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8},
        )

    def samples(self) -> None:
        """The samples in the shadow region, orange where they are lit and dark where not."""
        at, is_lit = self.ray.samples, self.ray.is_lit
        for chosen, colour in ((is_lit, LIT), (~is_lit, DARK)):
            there = at[chosen]
            self.axes.plot(there, np.zeros(len(there)), "o", color=colour, ms=5, mec="white", mew=0.5, zorder=9)


def beside_picture(stage: Stage, ray: DrawnRay, width: float = 9.0) -> tuple[Figure, Axes]:
    """A figure with the scene's picture, the ray's pixel marked in it, at the left, and axes for the diagram."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, 0.46 * width), layout="constrained")
    picture, diagram = figure.subplots(1, 2, width_ratios=(1, 3))
    show_pixel(picture, stage, ray)
    return figure, diagram


def show_pixel(axes: Axes, stage: Stage, ray: DrawnRay) -> None:
    """The picture whose ray it is, with the place of the ray marked."""
    image = stage.frame(stage.scene(ray.scene.name), "Weng2010").composite
    axes.imshow(display(image, image), extent=PICTURE)
    axes.plot(*place_in_picture(ray), "s", mfc="none", mec=LIGHT, ms=7, mew=1.5)
    row, column = ray.pixel
    width, height = ray.scene.camera.width, ray.scene.camera.height
    axes.set_title(f"{ray.scene.name}, the ray of\npixel ({column}, {row}) of {width} x {height}", fontsize=7)
    axes.set_axis_off()


def place_in_picture(ray: DrawnRay) -> tuple[float, float]:
    """Where a ray passes a picture of any size that covers `PICTURE`, (x, y)."""
    row, column = ray.pixel
    return (column + 0.5) / ray.scene.camera.width, (row + 0.5) / ray.scene.camera.height
