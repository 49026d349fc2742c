"""What `min_max` makes of a scene: its rows with their trees, and the pieces of rays that lie in rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gpu_impl.recording import Pieces
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from gpu_impl.visibilities.min_max import MinMax
from scenes.model import Scene


@dataclass(frozen=True)
class Rectified:
    """What the strategy makes and reports: trees (rows, 2 * columns, 2), pieces of the lattice's rays, their t_max."""

    trees: np.ndarray
    pieces: Pieces
    t_max: np.ndarray


def rectified(scene: Scene, **settings: int) -> Rectified:
    """On the slices of the epipolar lattice, each of which is a row."""
    technique = find_technique("Chen2011", **settings)
    with Renderer(scene) as renderer:
        view = renderer.passes.see(technique)
        inputs = renderer.passes.inputs(technique, view, 0)
        supply = MinMax(inputs)
        rows = inputs.lattice.size[1]
        trees = np.frombuffer(supply.buffer.read(), np.float32).reshape(rows, -1, 2).astype(np.float64)
        supply.give_back(renderer.device)
        (pieces,) = renderer.record(technique)
        t_max = renderer.passes.rays(technique, view, 0)[..., 3].astype(np.float64)
    return Rectified(trees, pieces, t_max)
