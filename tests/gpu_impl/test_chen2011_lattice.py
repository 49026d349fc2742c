"""The epipolar lattice: where its samples are, and what the image gets back from them."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from light_places import PLACES
from oracles import SphereScene
from scene_files import point, sphere, write_scene
from scipy.ndimage import maximum_filter, minimum_filter
from scipy.spatial import cKDTree

from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from gpu_impl.visibilities import VISIBILITIES
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Scene

SIZE = (40, 28)
CENTRES = np.stack(np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5), axis=-1)


def positions(scene: Scene, downsample: int) -> np.ndarray:
    """Of the samples, (slices, samples, 2) [pixel]."""
    with Renderer(scene) as renderer:
        technique = find_technique("Chen2011", downsample=downsample, shadow_map=8)
        view = renderer.passes.see(technique)
        return renderer.passes.rays(technique, view, 0)[..., :2].astype(np.float64)


def reconstructed(scene: Scene, downsample: int, values: np.ndarray) -> np.ndarray:
    """One channel at all pixels, (H, W), from its values at the samples."""
    with Renderer(scene) as renderer:
        technique = find_technique("Chen2011", downsample=downsample, shadow_map=8)
        return renderer.reconstructed(technique, [np.repeat(values[..., None], 3, axis=-1)])[..., 0]


@pytest.mark.parametrize("downsample", [1, 4])
@pytest.mark.parametrize("name", PLACES)
def test_slices_lie_in_planes_through_the_light_and_cover_the_image(name: str, downsample: int, tmp_path) -> None:
    scene = write_scene(tmp_path, emitters=PLACES[name], size=SIZE)
    found = positions(scene, downsample)
    slices, samples = 2 * sum(SIZE) // downsample, max(SIZE) // downsample
    assert found.shape == (slices, samples, 2)
    # inside the image, whose outermost pixels are a quarter cut off
    assert found.min() > 0.2
    assert (found < np.array(SIZE) - 0.2).all()
    (light,) = scene.lights
    axis = -light.direction if light.kind == "directional" else light.position - scene.camera.origin
    if name != "at the eye":
        direction = scene.camera.rays(found)[1]
        # a slice's two ends give its plane, which holds the axis
        normal = np.cross(direction[:, :1], direction[:, -1:])
        # short slices have no plane to speak of
        long = np.linalg.norm(found[:, -1] - found[:, 0], axis=-1) > 2
        height = np.abs(normal @ (axis / np.linalg.norm(axis))) / np.linalg.norm(normal, axis=-1)
        # measured: 7.8e-7
        assert height[long].max() < 4e-6
    gaps = np.linalg.norm(np.diff(found, axis=1), axis=-1)
    # this image's diagonal over its samples less one; measured 1.14 of the longer side's part
    assert gaps.max() < np.hypot(*SIZE) / (samples - 1)
    # evenly spread along each slice [pixel]; measured 7.8e-6
    assert np.ptp(gaps, axis=1).max() < 4e-5
    nearest, _ = cKDTree(found.reshape(-1, 2)).query(CENTRES.reshape(-1, 2))
    # half a diagonal of the gaps between slices and between samples; measured 0.99, and 0.89 of 4
    assert nearest.max() < 1.1 * downsample


@pytest.mark.parametrize("name", PLACES)
def test_level_values_stay_level_and_slanted_ones_slanted(name: str, tmp_path) -> None:
    scene = write_scene(tmp_path, emitters=PLACES[name], size=SIZE)
    places = positions(scene, 2)
    level = reconstructed(scene, 2, np.ones(places.shape[:2]))
    # weights add up to 1, whatever their sum rounds to; measured 0
    np.testing.assert_allclose(level, 1, rtol=5e-7)
    slanted = reconstructed(scene, 2, 1 + places @ [0.02, 0.05])
    off = np.abs(slanted - (1 + CENTRES @ [0.02, 0.05]))
    # of values that change by 0.05 a pixel: measured 9.9e-4; and 5.7e-2 before the light, where the last samples stand
    # for what is nearer to it
    assert np.median(off) < 3e-3
    assert off.max() < 0.1


WALL = "<shape type='rectangle'><transform name='to_world'><scale value='9'/><translate z='-1'/></transform></shape>"


@pytest.mark.parametrize("behind", ["", WALL], ids=["nothing behind", "a wall close behind"])
def test_values_do_not_cross_a_depth_edge(behind: str, tmp_path) -> None:
    """Samples are 1 on a ball and 0 behind it: pixels get the value of what they see."""
    scene = write_scene(tmp_path, emitters=point(3, 1.5, 0), shapes=sphere(0.1, 0.2, 0, 0.8) + behind, size=SIZE)
    with Renderer(scene) as renderer:
        depth = renderer.render(find_technique("Nishita1987", steps=1, shadow_map=8)).depth
    on_ball = depth < (5 if behind else 10)
    assert 0.1 < on_ball.mean() < 0.4
    places = positions(scene, 4)
    seen = on_ball[tuple(np.floor(places).astype(int)[..., ::-1].reshape(-1, 2).T)].reshape(places.shape[:2])
    off = np.abs(reconstructed(scene, 4, seen.astype(float)) - on_ball)
    # pixels whose four samples all see the other, measured 0 and 1 %; without weights by depth 17 % are off, and before
    # the wall 14 % with a SURFACE_SIGMA of 0.2
    assert (off > 0.01).mean() < 0.02


@pytest.mark.parametrize("visibility", [name for name, strategy in VISIBILITIES.items() if strategy.grid_only])
def test_strategies_that_draw_on_pixels_are_refused(visibility: str) -> None:
    with pytest.raises(InputError, match=f"{visibility} draws on the image's pixels, and the lattice epipolar"):
        find_technique(f"{visibility}+quadrature", lattice="epipolar")


def test_each_light_has_slices_of_its_own(tmp_path) -> None:
    """And the map may stand in a buffer."""
    shapes, images = sphere(0.1, 0.2, 0, 0.8), []
    for names in (["beside it", "behind the eye"], ["beside it"], ["behind the eye"]):
        emitters = "".join(PLACES[name] for name in names)
        with Renderer(write_scene(tmp_path, emitters=emitters, shapes=shapes, size=SIZE)) as renderer:
            storage = "texture" if len(names) == 2 else "buffer"
            images.append(renderer.render(find_technique("Chen2011", shadow_storage=storage)).scattering)
    # measured 0
    np.testing.assert_allclose(images[0], images[1] + images[2], rtol=1e-6)


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (3, 2)])
def test_the_smallest_images_are_drawn(size: tuple[int, int], tmp_path) -> None:
    scene = write_scene(tmp_path, emitters=PLACES["far"], size=size)
    with Renderer(scene) as renderer:
        image, truth = (
            renderer.render(find_technique("Chen2011", lattice=lattice, downsample=1)).scattering
            for lattice in ("epipolar", "grid")
        )
    # measured: 5.6e-2 in the single pixel, which is 45 degrees wide and has its samples on its borders
    np.testing.assert_allclose(image, truth, rtol=0.1)


def test_the_technique_converges_to_the_exact_shadow() -> None:
    """With a fine rectified map, each halving of both spacings brings the picture nearer to the closed form."""
    scene = load("sphere", size=(64, 64))
    truth = SphereScene(scene).scattering()
    with Renderer(scene) as renderer:
        images = [
            renderer.render(find_technique("Chen2011", downsample=step, shadow_map=2048)).scattering
            for step in (8, 4, 2, 1)
        ]
    off = [np.abs(image / truth - 1) for image in images]
    # first order at shadows' edges, second elsewhere. 95th percentiles, measured 1.9e-1, 6.1e-2, 1.7e-2, 5.3e-3
    for coarse, fine in itertools.pairwise(np.percentile(one, 95) for one in off):
        assert fine < 0.5 * coarse
    assert np.percentile(off[-1], 95) < 0.01
    # measured 2.8e-4 and +2.4e-4
    assert np.median(off[-1]) < 6e-4
    assert images[-1].mean() == pytest.approx(truth.mean(), rel=6e-4)


def test_what_is_lost_at_depth_edges() -> None:
    """The fault of epipolar samples that do not look for depth edges: airlight jumps there, and samples miss where."""
    scene, step = load("sphere", size=(128, 128)), 2
    with Renderer(scene) as renderer:
        frame = renderer.render(find_technique("min_max+quadrature"))
        image = renderer.render(find_technique("Chen2011", downsample=step)).scattering
    square = ((image.astype(np.float64) - frame.scattering) ** 2).mean(axis=-1)
    window = 2 * step + 1
    edge = maximum_filter(frame.depth, window) > 1.2 * minimum_filter(frame.depth, window)
    # measured 0.12, where there is 0.67 of the squared error: an rms of 8.9e-3 of the mean, elsewhere 2.3e-3
    assert edge.mean() < 0.15
    assert square[edge].sum() > 0.5 * square.sum()
    assert np.sqrt(square[edge].mean()) < 0.015 * frame.scattering.mean()
    assert np.sqrt(square[~edge].mean()) < 4e-3 * frame.scattering.mean()
