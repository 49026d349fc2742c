"""The counting build draws the same picture, and counts right where the numbers can be known."""

from __future__ import annotations

import numpy as np
import pytest
from scene_files import point, sphere, write_scene

from gpu_impl.airlight_models import QUADRATURE_NODES
from gpu_impl.device import read, shared_device
from gpu_impl.passes.scattering import COUNTERS
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Scene

STEPS = 12
COLOURED = "<rgb name='sigma_t' value='0.05, 0.1, 0.2'/>"
# pieces, reads, Ei and exponentials of one ray on which nothing casts a shadow, in grey fog
UNSHADOWED = {
    "lit_intervals:unbounded+weng2010": (1, STEPS, 2, 2),
    "lit_intervals:unbounded+quadrature": (1, STEPS, 0, QUADRATURE_NODES + 1),
    # a march multiplies each of the three channels by its own exponential
    "uniform_march+riemann": (STEPS, STEPS, 0, 3 * STEPS),
    "uniform_march+weng2010": (STEPS, STEPS, 2 * STEPS, 2 * STEPS),
}


def counted(scene: Scene, technique: str, steps: int = STEPS, **settings: int) -> dict[str, np.ndarray]:
    with Renderer(scene) as renderer:
        return renderer.counts(find_technique(technique, steps=steps, shadow_map=16, **settings))


@pytest.mark.parametrize(("technique", "expected"), UNSHADOWED.items())
def test_counts_without_an_occluder_are_known(technique: str, expected: tuple[int, ...]) -> None:
    found = counted(load("empty", size=(8, 6)), technique)
    assert tuple(found) == COUNTERS
    for counts, number in zip(found.values(), expected, strict=True):
        np.testing.assert_array_equal(counts, np.full((6, 8), number))


def test_coloured_fog_counts_each_channel(tmp_path) -> None:
    coloured = write_scene(tmp_path, sigma_t=COLOURED, size=(8, 6))
    for technique, (pieces, reads, integrals, exponentials) in UNSHADOWED.items():
        found = counted(coloured, technique)
        # the march does all three channels in any fog
        times = 1 if technique.endswith("riemann") else 3
        expected = (pieces, reads, times * integrals, times * exponentials)
        assert [int(counts.max()) for counts in found.values()] == list(expected), technique
        assert [int(counts.min()) for counts in found.values()] == list(expected), technique


def test_lights_add_up(tmp_path) -> None:
    two = write_scene(tmp_path, emitters=point(0, 3, 0) + point(1, 2, 0), size=(8, 6))
    for technique, expected in UNSHADOWED.items():
        for counts, number in zip(counted(two, technique).values(), expected, strict=True):
            np.testing.assert_array_equal(counts, np.full((6, 8), 2 * number))


def test_the_arrays_are_of_the_lattice() -> None:
    found = counted(load("empty", size=(17, 9)), "lit_intervals:unbounded+quadrature", downsample=4)
    assert {counts.shape for counts in found.values()} == {(3, 5)}


def test_shadows_split_the_ray(tmp_path) -> None:
    """Where a ray has k lit intervals there are k pieces, and as many times the exponentials of one."""
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), size=(24, 24))
    found = counted(scene, "lit_intervals:unbounded+quadrature")
    assert set(np.unique(found["pieces"])) == {1, 2}
    np.testing.assert_array_equal(found["exponentials"], (QUADRATURE_NODES + 1) * found["pieces"])
    # however often light changes, each sample is looked up once
    np.testing.assert_array_equal(found["shadow_map_reads"], STEPS)
    march = counted(scene, "uniform_march+riemann")
    # dark samples are read, and are no pieces
    assert march["pieces"].min() < STEPS
    np.testing.assert_array_equal(march["shadow_map_reads"], STEPS)
    np.testing.assert_array_equal(march["exponentials"], 3 * march["pieces"])


def test_samples_are_taken_in_the_shadow_region_only(tmp_path) -> None:
    """A ray reads the map a few times to find its region, and STEPS times in it; most rays here meet no shadow."""
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), size=(24, 24))
    steps = 4 * STEPS
    reads = counted(scene, "lit_intervals+quadrature", steps)["shadow_map_reads"]
    sampled = reads >= steps
    assert 0.2 < sampled.mean() < 0.6
    # beside the samples the region's ends are looked up, and changes again: measured 4, and 5 to 12
    assert (reads[~sampled] <= 8).all()
    assert (reads[sampled] <= steps + 16).all()


@pytest.mark.parametrize("technique", [*UNSHADOWED, "lit_intervals+one_ei", "lit_intervals+weng2010:three-ei"])
@pytest.mark.parametrize("sigma_t", ["<float name='sigma_t' value='0.1'/>", COLOURED], ids=["grey", "coloured"])
def test_the_counting_build_draws_the_same_bits(technique: str, sigma_t: str, tmp_path) -> None:
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), sigma_t=sigma_t, size=(24, 24))
    chosen = find_technique(technique, steps=STEPS, shadow_map=64)
    with Renderer(scene) as renderer:
        view = renderer.passes.see(chosen)
        target, counts = (renderer.passes.lattice_texture(chosen) for _ in range(2))
        drawn = []
        for counted_in in (None, counts):
            renderer.passes.scatter_light(target, chosen, view, 0, counts=counted_in, first=True)
            drawn.append(read(target))
        normal, counting = drawn
        assert read(counts)[..., 0].max() > 1
    shared_device().release_spare_textures()
    assert normal[..., :3].max() > 0
    np.testing.assert_array_equal(counting, normal)


def test_what_a_technique_refuses_is_not_counted() -> None:
    with pytest.raises(InputError, match="isotropic"):
        counted(load("empty", size=(8, 6), phase="rayleigh"), "lit_intervals+weng2010")
