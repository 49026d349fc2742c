"""The pictures of all coalitions: the cells that OpenGL draws, and their pieces evaluated in float64."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from experiments.attribution.coalitions import EVERY_PIXEL, FLOAT32, replaced
from experiments.attribution.float64 import Pieces, airlight_of_pieces
from experiments.attribution.shapley import Coalition
from experiments.renderers import find_lit_up_to
from gpu_impl.given import Found
from gpu_impl.recording import Pieces as Recorded
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import Technique, find_technique
from gpu_impl.visibilities import VISIBILITIES
from reference.deterministic.ray_spans import Rays
from reference.first_surfaces import first_surfaces
from scenes.model import Array, Scene

# of a distance: two surfaces that differ by less are taken for one, which the two round differently
OTHER_SURFACE = 0.01


class Pictures:
    """Draws one scene with parts of techniques replaced; a context manager.

    What the reference's rays found is remembered: every coalition without a shadow map asks for the same. They end
    where OpenGL's do, so that all coalitions see the same surfaces.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._found: dict[tuple[int, bytes, bytes], Found] = {}
        self._renderer = Renderer(scene, find_lit=self._find_lit)

    def __enter__(self) -> Pictures:
        return self

    def __exit__(self, *_: object) -> None:
        self._renderer.release()

    def draw(self, technique: Technique, coalition: Coalition) -> NDArray[np.floating]:
        """Airlight of a technique with the parts of a coalition replaced, (H, W, 3) [radiance].

        Raises
        ------
        InputError
            The cell cannot draw this scene, or its picture is not finite.
        """
        cell = replaced(technique, coalition)
        if FLOAT32 not in coalition:
            return self._renderer.render(cell).scattering
        visibility, lights = VISIBILITIES[cell.visibility], []
        for number, recorded in enumerate(self._renderer.record(cell)):
            positions = recorded.positions.astype(np.float64)
            # as in FramePasses.given, so that they are found where they are remembered
            ends = recorded.start.astype(np.float64) + np.maximum(recorded.t_max, 0)
            rays = Rays.of_camera(self.scene, ends.ravel(), positions)
            if visibility.given:
                # as they were found, before OpenGL rounded them
                pieces = _whole(self._find_lit(self.scene, number, positions, ends))
                if visibility.in_steps:
                    pieces = pieces.in_steps(rays, cell.steps)
            else:
                pieces = _reported(recorded)
            light = self.scene.lights[number]
            airlight = airlight_of_pieces(self.scene, light, cell.airlight, rays, pieces)
            lights.append(airlight.reshape(*recorded.start.shape, 3))
        if cell.lattice == EVERY_PIXEL and cell.downsample == 1:
            # the cells are the pixels: nothing is left for OpenGL to round
            return np.sum(lights, axis=0)
        return self._renderer.reconstructed(cell, lights)

    @cached_property
    def other_surfaces(self) -> NDArray[np.bool_]:
        """Pixels in which OpenGL sees a surface further off than the reference does, or nearer, (H, W)."""
        ours, theirs = self._renderer.render(find_technique("given+quadrature")).depth, first_surfaces(self.scene).depth
        return np.abs(ours - theirs) > OTHER_SURFACE * theirs

    def _find_lit(self, scene: Scene, number: int, positions: Array, ends: Array) -> Found:
        key = number, positions.tobytes(), ends.tobytes()
        if key not in self._found:
            self._found[key] = find_lit_up_to(scene, number, positions, ends)
        return self._found[key]


def _reported(recorded: Recorded) -> Pieces:
    t0, length, weight = (part.astype(np.float64) for part in (recorded.t0, recorded.dt, recorded.w))
    return Pieces(recorded.cell, recorded.start.ravel()[recorded.cell] + t0, length, weight)


def _whole(found: Found) -> Pieces:
    ray = np.repeat(np.arange(found.offsets.size - 1), np.diff(found.offsets))
    return Pieces(ray, found.begin, found.end - found.begin, np.ones_like(found.begin))
