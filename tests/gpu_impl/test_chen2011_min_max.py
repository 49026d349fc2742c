"""The trees over the rectified shadow map's rows, and where lit intervals end: brute force and closed forms."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from light_places import PLACES, POINTS, sun
from rectified_rows import Rectified, rectified
from scene_files import sphere, write_scene

from gpu_impl.given import Found
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Array, Scene

OCCLUDERS = sphere(0.5, 0.3, 1, 0.4) + sphere(-0.9, -0.4, -0.5, 0.5)


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


def brute_force(scene: Scene, found: Rectified) -> list[tuple[int, float, float]]:
    """Lit runs of columns as (cell, begin, end), by comparing every column that a ray crosses; in float64."""
    eye = scene.camera.origin
    distance = float(np.linalg.norm(scene.lights[0].position - eye))
    axis = (scene.lights[0].position - eye) / distance
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
        away = np.array([distance, 0.0]) - [(o - eye) @ axis, (o - eye) @ side]
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
    assert len(np.unique(pieces.cell)) > 100
    assert len(pieces.cell) > 1.1 * len(np.unique(pieces.cell))
    np.testing.assert_array_equal(pieces.cell, expected[:, 0])
    # of lengths up to 25; measured 4.6e-5
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


def shadow_begins(scene: Scene, towards_light: np.ndarray, height: float, shadow_map: int) -> np.ndarray:
    """By how much the first lit piece of each ray, (n,), misses its end, relative to the end's distance.

    It ends on the plane through the light and the edge x = 0, y = `height` of a shelf that goes on to negative x. Only
    rays that begin in the light and reach the plane below the shelf.
    """
    found = rectified(scene, downsample=2, shadow_map=shadow_map)
    origin, direction, _ = scene.camera.rays(found.pieces.positions.astype(np.float64))
    normal = np.cross([0, 0, 1.0], towards_light)
    exact = ([0, height, 0] - origin) @ normal / (direction @ normal)
    below = (origin + exact[..., None] * direction)[..., 1] < height
    crosses = below & (exact > 0) & (exact < 0.9 * found.t_max)
    cells, first = np.unique(found.pieces.cell, return_index=True)
    end = (found.pieces.t0 + found.pieces.dt)[first]
    off = end / exact.ravel()[cells] - 1
    return off[(found.pieces.t0[first] == 0) & crosses.ravel()[cells]]


@pytest.mark.parametrize("light", ["point", "sun"])
def test_a_lit_interval_ends_where_the_shadow_of_a_straight_edge_begins(light: str, tmp_path) -> None:
    """Off by up to a column and a texel, which shrink with the shadow map."""
    if light == "point":
        scene, height = load("half_plane", size=(32, 32)), 1.9
        towards_light = scene.lights[0].position - [0, height, 0]
    else:
        height = 1.2
        shelf = (
            "<shape type='rectangle'><transform name='to_world'><scale value='8'/><rotate x='1' angle='-90'/>"
            f"<translate x='-8' y='{height}'/></transform></shape>"
        )
        scene = write_scene(tmp_path, emitters=sun("-0.5, -1, -0.3"), shapes=shelf, size=(32, 32))
        towards_light = -scene.lights[0].direction
    off = [np.abs(shadow_begins(scene, towards_light, height, shadow_map)) for shadow_map in (256, 512, 1024, 2048)]
    assert len(off[0]) > 300
    # medians. Measured 1.9e-2, 7.5e-3, 2.9e-3, 2.3e-3 (point), 3.5e-2, 1.9e-2, 8.0e-3, 6.3e-3 (sun): many
    # texels of a straight edge may be off to one side
    assert np.median(off[-1]) < np.median(off[0]) / 4
    # the worst ray: measured, of the sun, 9.3e-2 to 1.3e-2
    assert off[-1].max() < off[0].max() / 3


def test_without_an_occluder_a_ray_is_one_piece(tmp_path) -> None:
    """The picture of a strategy that samples, bit for bit: both report the whole ray, or what is in the cone."""
    for name, emitters in PLACES.items():
        with Renderer(write_scene(tmp_path, emitters=emitters, size=(12, 12))) as renderer:
            frame, sampled = (
                renderer.render(find_technique(f"{visibility}+quadrature", steps=16, shadow_map=32))
                for visibility in ("min_max", "lit_intervals:unbounded")
            )
        assert frame.lit_intervals.max() == 1
        np.testing.assert_array_equal(frame.lit_intervals, sampled.lit_intervals, err_msg=name)
        np.testing.assert_array_equal(frame.scattering, sampled.scattering, err_msg=name)


def test_given_intervals_are_found_to_a_column() -> None:
    """With the shadow's exact ends in place of the map, what is left is that a column is lit or dark as a whole."""
    scene = load("half_plane", size=(32, 32))

    def exact(scene: Scene, number: int, positions: Array, ends: Array) -> Found:
        origin, direction, t_max = scene.camera.rays(positions)
        position = scene.lights[number].position
        towards_light = position - [0, 1.9, 0]
        normal = np.cross([0, 0, 1.0], towards_light)
        end = (position - origin) @ normal / (direction @ normal)
        for height, edge in ((0, 1e9), (1.9, 0)):
            hit = (height - origin[..., 1]) / direction[..., 1]
            is_hit = (hit > 0) & ((origin + hit[..., None] * direction)[..., 0] < edge)
            t_max = np.where(is_hit, np.minimum(t_max, hit), t_max)
        end = np.where((end > 0) & (end < t_max), end, t_max).ravel()
        return Found(np.arange(end.size + 1), np.zeros(end.size), end)

    off = []
    for shadow_map in (128, 512, 2048):
        with Renderer(scene, find_lit=exact) as renderer:
            technique = find_technique("min_max+quadrature", shadow_map=shadow_map, shadow_source="rays")
            image = renderer.render(technique).scattering
            truth = renderer.render(find_technique("given+quadrature")).scattering
        one = np.abs(image / truth - 1)
        off.append(np.percentile(one, 95))
    # first order; measured 4.6e-2, 1.2e-2, 2.8e-3
    assert off[-1] < 5e-3
    for coarse, fine in itertools.pairwise(off):
        assert fine < 0.4 * coarse


def test_trees_that_no_buffer_holds_are_refused(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Renderer(write_scene(tmp_path, size=(16, 16))) as renderer:
        monkeypatch.setitem(renderer.device.context.info, "GL_MAX_SHADER_STORAGE_BLOCK_SIZE", 1 << 16)
        with pytest.raises(InputError, match=r"64 rows of 128 thresholds take 0\.131 MB, .* holds 0\.0655 MB"):
            renderer.render(find_technique("min_max+quadrature", shadow_map=64))
