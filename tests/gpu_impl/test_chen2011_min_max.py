"""The rectified shadow map and its trees, against brute force, closed forms and samples of the same shadow map."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from light_places import BOX, PLACES, POINTS, SUNS
from oracles import piece_airlight
from scene_files import point, sphere, write_scene
from shadow_volumes import SHADOWS

from gpu_impl.given import Found
from gpu_impl.recording import Pieces
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from gpu_impl.visibilities.min_max import MinMax
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Array, Scene

FLOOR = (
    "<shape type='rectangle'><transform name='to_world'><scale value='20'/><rotate x='1' angle='-90'/>"
    "<translate y='-1.2'/></transform></shape>"
)
OCCLUDERS = sphere(0.5, 0.3, 1, 0.4) + sphere(-0.9, -0.4, -0.5, 0.5) + FLOOR


def chaff(count: int) -> str:
    """Small squares in all directions in front of the eye."""
    rng = np.random.default_rng(2011)
    return "".join(
        "<shape type='rectangle'><bsdf type='twosided'><bsdf type='diffuse'/></bsdf><transform name='to_world'>"
        f"<scale value='0.08'/><rotate x='1' angle='{turn:.0f}'/><rotate y='1' angle='{3 * turn:.0f}'/>"
        f"<translate x='{x:.3f}' y='{y:.3f}' z='{z:.3f}'/></transform></shape>"
        for turn, (x, y, z) in zip(
            rng.uniform(0, 180, count), rng.uniform([-1.5, -1.5, -2], [1.5, 1.5, 3], (count, 3)), strict=True
        )
    )


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
        (pieces,) = renderer.record(technique)
        t_max = renderer.passes.rays(technique, view, 0)[..., 3].astype(np.float64)
    return Rectified(trees, pieces, t_max)


def axis_of(scene: Scene) -> tuple[np.ndarray, float]:
    """Unit vector from the eye to the light, and how far it is."""
    (light,) = scene.lights
    if light.kind == "directional":
        return -light.direction, np.inf
    distance = float(np.linalg.norm(light.position - scene.camera.origin))
    return (light.position - scene.camera.origin) / distance, distance


def brute_force(scene: Scene, found: Rectified, length: float = 0.0) -> list[tuple[int, float, float]]:
    """Lit runs of columns as (cell, begin, end), by comparing every column that a ray crosses; in float64.

    Parameters
    ----------
    length : of the columns' range where light is parallel; that of a point light is half a turn
    """
    axis, distance = axis_of(scene)
    thresholds = found.trees[:, found.trees.shape[1] // 2 :, 0]
    columns = thresholds.shape[1]
    beta = np.pi * np.arange(1, columns) / columns
    origin, direction, _ = scene.camera.rays(found.pieces.positions.astype(np.float64))
    origin = origin + found.pieces.start[..., None] * direction
    runs = []
    for row, sample in np.ndindex(found.t_max.shape):
        o, d, t_max = origin[row, sample], direction[row, sample], found.t_max[row, sample]
        side = d - axis * (d @ axis)
        side /= np.linalg.norm(side)
        # the ray and each light ray as lines in (axis, side): o + t d = distance * axis + r w
        w = np.stack([-np.cos(beta), np.sin(beta)])
        away = np.array([distance, 0.0]) - [(o - scene.camera.origin) @ axis, (o - scene.camera.origin) @ side]
        across = (d @ axis) * w[1] - (d @ side) * w[0]
        t = (away[0] * w[1] - away[1] * w[0]) / across
        # light rays that the ray runs away from are crossed behind its beginning, or never
        borders = np.concatenate([[0.0], np.where(across > 0, np.clip(t, 0, t_max), t_max), [t_max]])
        lit = (d @ axis) / (d @ side) >= thresholds[row]
        used = np.diff(borders) > 0
        begin, end, lit = borders[:-1][used], borders[1:][used], lit[used]
        change = np.flatnonzero(np.diff(np.concatenate([[False], lit, [False]]).astype(int)))
        runs += [
            (row * found.t_max.shape[1] + sample, begin[first], end[last - 1])
            for first, last in zip(change[::2], change[1::2], strict=True)
        ]
    return runs


@pytest.mark.parametrize("name", ["in the picture", "beside it", "behind the eye", "beside the eye", "far"])
def test_the_trees_find_what_brute_force_finds(name: str, tmp_path) -> None:
    scene = write_scene(tmp_path, emitters=POINTS[name], shapes=chaff(120), size=(16, 16))
    found = rectified(scene, downsample=2, shadow_map=256)
    expected = np.array(brute_force(scene, found))
    pieces = found.pieces
    print(name, len(expected), len(pieces.cell))
    assert len(np.unique(pieces.cell)) > 100
    assert len(pieces.cell) > 1.1 * len(np.unique(pieces.cell))
    np.testing.assert_array_equal(pieces.cell, expected[:, 0])
    print(np.abs(pieces.t0 - expected[:, 1]).max(), np.abs(pieces.dt - (expected[:, 2] - expected[:, 1])).max())
    np.testing.assert_allclose(pieces.t0, expected[:, 1], rtol=2e-5, atol=2e-5)
    np.testing.assert_allclose(pieces.dt, expected[:, 2] - expected[:, 1], rtol=2e-5, atol=2e-5)


@pytest.mark.parametrize("name", PLACES)
def test_nodes_hold_the_least_and_the_largest_of_their_columns(name: str, tmp_path) -> None:
    scene = write_scene(tmp_path, emitters=PLACES[name], shapes=OCCLUDERS, size=(16, 16))
    trees = rectified(scene, downsample=4, shadow_map=64).trees
    columns = trees.shape[1] // 2
    assert columns in (64, 128)
    leaves = trees[:, columns:, 0]
    assert (trees[:, columns:, 1] == leaves).all()
    assert not np.isnan(trees).any()
    level = columns
    while level > 1:
        level //= 2
        below = leaves.reshape(len(leaves), level, -1)
        assert (trees[:, level : 2 * level, 0] == below.min(axis=-1)).all()
        assert (trees[:, level : 2 * level, 1] == below.max(axis=-1)).all()
