"""One ray of a scene with all that the thesis's diagrams name on it, each found by what computes it in earnest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from experiments.figures.plane import Array, RayPlane
from gpu_impl.device import read
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from gpu_impl.visibilities.shadow_polygons import repaired
from reference.deterministic import LitIntervals, lit_intervals
from scenes.model import Scene

# samples of the shadow region that a diagram shows: few enough to be told apart
SAMPLES = 16


@dataclass(frozen=True, eq=False)
class DrawnRay:
    """A pixel's ray, distances along it from its origin [scene unit].

    Attributes
    ----------
    scene : Scene
    pixel : (row, column)
    plane : RayPlane           of the ray and the scene's first light
    end : float                surface distance: X_b, P3 of Figure 4.7
    lit : (k, 2)               lit pieces, begin and end, by Mitsuba's ray casting (`airlight.lit_intervals`)
    reached : (2,)             where the light's cone is entered and left, no further than `end`
    front, final : float       first and last shadow polygon, as OpenGL draws them: P1 and P2; inf and -inf for none
    """

    scene: Scene
    pixel: tuple[int, int]
    plane: RayPlane
    end: float
    lit: Array
    reached: Array
    front: float
    final: float

    @property
    def x_h(self) -> float:
        """Coordinate of the light's projection."""
        return float(self.plane.light[0])

    @property
    def h(self) -> float:
        """Distance of the light from the ray."""
        return float(self.plane.light[1])

    @property
    def dark(self) -> Array:
        """Dark pieces between lit ones, (k - 1, 2)."""
        return np.column_stack([self.lit[:-1, 1], self.lit[1:, 0]])

    @cached_property
    def samples(self) -> Array:
        """`SAMPLES` of Algorithm 4.1, repaired: in the middle of equal steps of the shadow region, (n,)."""
        return self.front + (np.arange(SAMPLES) + 0.5) / SAMPLES * (self.final - self.front)

    @cached_property
    def is_lit(self) -> NDArray[np.bool_]:
        """Which samples the light sees, (n,), asked of the plane."""
        return self.plane.sees(np.column_stack([self.samples, np.zeros(SAMPLES)]))


@dataclass(frozen=True, eq=False)
class RayField:
    """All rays of a scene's picture, one of which a diagram takes.

    Attributes
    ----------
    intervals : LitIntervals
    polygons : (H, W, 2)    first and last shadow polygon of each ray; inf and -inf for none
    end : (H, W)            where each ray ends
    """

    scene: Scene
    intervals: LitIntervals
    polygons: Array
    end: Array

    @cached_property
    def x_h(self) -> Array:
        """Coordinate of the first light's projection on each ray, (H * W,)."""
        origin, direction, _ = self.scene.camera.rays()
        return np.asarray(np.sum((self.scene.lights[0].position - origin) * direction, axis=-1).ravel())

    @classmethod
    def of_scene(cls, scene: Scene) -> RayField:
        """Find lit pieces by ray casting and shadow polygons by OpenGL."""
        return cls(scene, lit_intervals(scene), *_drawn_polygons(scene))

    def pieces(self, pixel: int) -> Array:
        """Lit pieces of one pixel, in row order, under the scene's first light, (k, 2)."""
        offsets, at = self.intervals.offsets, pixel * self.intervals.lights
        mine = slice(offsets[at], offsets[at + 1])
        return np.column_stack([self.intervals.begin[mine], self.intervals.end[mine]])

    def best(self, score: Callable[[RayField, int], float]) -> DrawnRay:
        """The ray with the highest score.

        Parameters
        ----------
        score : of (field, pixel); -inf for one that will not do

        Raises
        ------
        ValueError
            None will do.
        """
        scores = [score(self, pixel) for pixel in range(self.intervals.pixels)]
        pixel = int(np.argmax(scores))
        if scores[pixel] == -np.inf:
            raise ValueError(f"scene must have a ray of the wanted kind, and {self.scene.name} has none")
        return self.ray(pixel)

    def ray(self, pixel: int) -> DrawnRay:
        """The ray of a pixel, in row order."""
        row, column = divmod(pixel, self.scene.camera.width)
        origin, direction, _ = self.scene.camera.rays()
        light = self.scene.lights[0]
        plane = RayPlane.of_ray(self.scene, light, origin[row, column], direction[row, column])
        end = float(self.end[row, column])
        front, final = self.polygons[row, column]
        lit = self.pieces(pixel)
        return DrawnRay(self.scene, (row, column), plane, end, lit, _reached(plane, end), float(front), float(final))


def _drawn_polygons(scene: Scene) -> tuple[Array, Array]:
    """First and last shadow polygon of each pixel's ray, (H, W, 2), and where the ray ends, (H, W), by OpenGL."""
    technique = find_technique("Weng2010")
    with Renderer(scene) as renderer:
        view = renderer.passes.see(technique)
        polygons = repaired(renderer.passes.inputs(technique, view, 0))
        found = read(polygons.texture).astype(float)
        polygons.give_back(renderer.device)
        view.give_back(renderer.device)
        depth = renderer.render(technique).depth.astype(float)
    none = found[..., 0] > 1e38
    return np.where(none[..., None], [np.inf, -np.inf], found * [1, -1]), depth


def _reached(plane: RayPlane, end: float) -> Array:
    """Where a ray enters and leaves the wedge in which a light shines, (2,), within [0, end]."""
    if plane.wedge is None:
        return np.array([0.0, end])
    crossings = [0.0, end]
    for turn in plane.wedge:
        # light + s (cos, sin) on the ray, y = 0
        s = -plane.light[1] / np.sin(turn) if np.sin(turn) else -1.0
        if s > 0:
            crossings.append(float(np.clip(plane.light[0] + s * np.cos(turn), 0, end)))
    ends = np.sort(crossings)
    middles = 0.5 * (ends[:-1] + ends[1:])
    bare = RayPlane(plane.light, np.empty((0, 2, 2)), plane.wedge)
    inside = bare.sees(np.column_stack([middles, np.zeros(len(middles))])) & (np.diff(ends) > 0)
    if not inside.any():
        return np.zeros(2)
    return np.array([ends[:-1][inside].min(), ends[1:][inside].max()])
