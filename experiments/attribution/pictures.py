"""The pictures of all coalitions: the cells that OpenGL draws, and their pieces evaluated in float64."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from experiments.attribution.coalitions import EVERY_PIXEL, FLOAT32, replaced
from experiments.attribution.float64 import Pieces, airlight_of_pieces
from experiments.attribution.shapley import Coalition
from experiments.renderers import find_lit
from gpu_impl.given import Found
from gpu_impl.recording import Pieces as Recorded
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import Technique
from gpu_impl.visibilities import VISIBILITIES
from reference.deterministic.ray_spans import Rays
from scenes.model import Array, Scene


class Pictures:
    """Draws one scene with parts of techniques replaced; a context manager.

    What the reference's rays found is remembered: every coalition without a shadow map asks for the same.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._found: dict[tuple[int, bytes], Found] = {}
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
        lights = []
        for number, recorded in enumerate(self._renderer.record(cell)):
            positions = recorded.positions.astype(np.float64)
            end = (recorded.start + np.maximum(recorded.t_max, 0)).astype(np.float64).ravel()
            rays = Rays.of_camera(self.scene, end, positions)
            if VISIBILITIES[cell.visibility].given:
                # as they were found, before OpenGL rounded them
                pieces = _whole(self._find_lit(self.scene, number, positions))
            else:
                pieces = _reported(recorded)
            light = self.scene.lights[number]
            airlight = airlight_of_pieces(self.scene, light, cell.airlight, cell.steps, rays, pieces)
            lights.append(airlight.reshape(*recorded.start.shape, 3))
        if cell.lattice == EVERY_PIXEL and cell.downsample == 1:
            # the cells are the pixels: nothing is left for OpenGL to round
            return np.sum(lights, axis=0)
        return self._renderer.reconstructed(cell, lights)

    def _find_lit(self, scene: Scene, number: int, positions: Array) -> Found:
        key = number, positions.tobytes()
        if key not in self._found:
            self._found[key] = find_lit(scene, number, positions)
        return self._found[key]


def _reported(recorded: Recorded) -> Pieces:
    t0, length, weight = (part.astype(np.float64) for part in (recorded.t0, recorded.dt, recorded.w))
    return Pieces(recorded.cell, recorded.start.ravel()[recorded.cell] + t0, length, weight)


def _whole(found: Found) -> Pieces:
    ray = np.repeat(np.arange(found.offsets.size - 1), np.diff(found.offsets))
    return Pieces(ray, found.begin, found.end - found.begin, np.ones_like(found.begin))
