"""Regions of a picture against depths, shafts and errors whose places are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from experiments.measurements.regions import (
    NOISE,
    REACH,
    REGIONS,
    depth_edges,
    measure_regions,
    reached,
    shaft_edges,
    split,
)
from scenes.loader import load
from scenes.model import Camera

WIDTH, HEIGHT = 96, 64


@pytest.fixture(scope="module")
def camera() -> Camera:
    return replace(load("sphere", size=(WIDTH, HEIGHT)).camera, near=0.5, far=50.0)


def plane_depth(camera: Camera, normal: list[float], distance: float) -> np.ndarray:
    """Distance along each ray to the plane normal . x = distance, the far plane where it is missed."""
    origin, direction, t_max = camera.rays()
    along = (distance - origin @ np.array(normal)) / (direction @ np.array(normal))
    return np.where((along > 0) & (along < t_max), along, t_max)


def test_the_reach_is_the_coarsest_lattices() -> None:
    assert REACH == 8


def test_no_plane_has_an_edge_however_steep(camera: Camera) -> None:
    far = camera.rays()[2]
    assert not depth_edges(far, camera).any()
    forward, up = camera.to_world[:3, 2], camera.to_world[:3, 1]
    # seen at right angles, at 45 degrees, and so flat that neighbours' distances are up to 1.7 times each other
    for steepness in (0.0, 1.0, 40.0):
        normal = forward + steepness * up
        depth = plane_depth(camera, normal.tolist(), float(normal @ (camera.origin + 8.0 * forward)))
        on_plane = depth < 0.999 * far
        edges = depth_edges(depth, camera)
        # where all three pixels of a difference lie on it
        inner = on_plane.copy()
        inner[1:-1] &= on_plane[:-2] & on_plane[2:]
        assert inner.sum() > 100
        assert not edges[inner].any(), steepness


def test_no_plane_has_an_edge_where_it_comes_through_the_near_plane(camera: Camera) -> None:
    """There distance from the near plane is nothing, while depth along the axis is as straight as anywhere."""
    camera = replace(camera, near=4.0)
    forward, up = camera.to_world[:3, 2], camera.to_world[:3, 1]
    normal = forward + 3.0 * up
    # through the viewing axis at depth 5: the near plane cuts it within the picture
    depth = plane_depth(camera, normal.tolist(), float(normal @ (camera.to_world[:3, 3] + 5.0 * forward)))
    on_plane = depth < 0.999 * camera.rays()[2]
    assert depth[on_plane].min() < 0.3
    inner = on_plane.copy()
    inner[1:-1] &= on_plane[:-2] & on_plane[2:]
    assert inner.sum() > 1000
    assert not depth_edges(depth, camera)[inner].any()


def test_both_sides_of_a_silhouette_are_edges(camera: Camera) -> None:
    depth = np.full((HEIGHT, WIDTH), 8.0)
    depth[:, 40:] = 8.3
    edges = depth_edges(depth, camera)
    assert set(np.flatnonzero(edges.all(axis=0))) == {39, 40}
    assert set(np.flatnonzero(edges.any(axis=0))) == {39, 40}
    # a wire of one pixel, and the ground beside it
    depth = np.full((HEIGHT, WIDTH), 8.0)
    depth[20] = 7.0
    assert set(np.flatnonzero(depth_edges(depth, camera).any(axis=1))) == {19, 20, 21}
    # 1 % is alike to the upsampling shaders, 4 % is not
    for step, found in ((0.01, False), (0.04, True)):
        depth = np.full((HEIGHT, WIDTH), 8.0)
        depth[:, 40:] *= 1 + step
        assert depth_edges(depth, camera).any() == found


def test_a_cut_reaches_a_lattice_cell_far() -> None:
    cut = np.zeros((HEIGHT, WIDTH), bool)
    cut[30, 50] = True
    rows, columns = np.nonzero(reached(cut))
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (22, 38, 42, 58)
    assert reached(cut).sum() == 17 * 17


def test_a_shaft_s_border_is_found_and_its_slope_is_not() -> None:
    airlight = np.tile(np.exp(np.linspace(0.0, 3.0, WIDTH))[None, :, None], (HEIGHT, 1, 3))
    quiet = np.zeros_like(airlight)
    assert not shaft_edges(airlight, quiet).any()
    airlight[:, 60:] *= 0.5
    assert set(np.flatnonzero(shaft_edges(airlight, quiet).any(axis=0))) == {59, 60}
    # noise of that size hides it, and a channel is enough
    assert not shaft_edges(airlight, 0.2 * airlight).any()
    red = np.ones((HEIGHT, WIDTH, 3))
    red[:, 60:, 0] = 2.0
    assert shaft_edges(red, quiet).any()


def test_noise_alone_is_no_shaft() -> None:
    noise = 0.1 * np.ones((512, 512, 3))
    airlight = 1.0 + np.random.default_rng(3).normal(0.0, 0.1, noise.shape)
    # six differences a pixel, each beyond 4 standard errors in 1 of 15,787, less where 5 % come on top
    # measured: 0.00013; without the factor for the noise of a difference 0.30
    assert shaft_edges(airlight, noise).mean() < 6 / 15_787
    assert NOISE == 4.0


def test_each_pixel_lies_in_one_region(camera: Camera) -> None:
    depth = np.full((HEIGHT, WIDTH), 8.0)
    depth[:, 30:] = 12.0
    truth = np.ones((HEIGHT, WIDTH, 3))
    truth[:, 70:] = 3.0
    truth[:, 30:] += 1.0
    parts = split(depth, camera, truth, np.zeros_like(truth))
    assert tuple(parts) == REGIONS
    np.testing.assert_array_equal(sum(part.astype(int) for part in parts.values()), 1)
    columns = {name: np.flatnonzero(part[10]) for name, part in parts.items()}
    # depth goes before airlight where both are cut
    np.testing.assert_array_equal(columns["edge"], np.arange(29 - 8, 30 + 8 + 1))
    np.testing.assert_array_equal(columns["shaft"], np.arange(69 - 8, 70 + 8 + 1))


def test_errors_are_those_of_their_region() -> None:
    truth = np.ones((HEIGHT, WIDTH, 3))
    truth[:, 80:] = 0.0
    left = np.zeros((HEIGHT, WIDTH), bool)
    left[:, :20] = True
    parts = {"smooth": ~left, "shaft": np.zeros_like(left), "edge": left}
    test, noise = truth.copy(), np.zeros_like(truth)
    test[:, :20] = 1.25
    test[0, :20] = 3.0
    found = measure_regions(test, truth, noise, parts)
    # 1 of 64 rows is off by 2, which neither percentile sees
    assert (found["edge.rel_50"], found["edge.rel_95"]) == (0.25, 0.25)
    assert found["edge.bias"] == pytest.approx(np.sqrt((63 * 0.25**2 + 2.0**2) / 64), rel=1e-12)
    # of the 80 columns with airlight
    assert found["edge.share"] == 0.25
    assert found["smooth.share"] == 0.75
    assert found["smooth.rel_95"] == found["smooth.bias"] == 0.0
    assert found["shaft.share"] == 0.0
    assert found["shaft.rel_50"] is found["shaft.bias"] is None
    # the reference's variance is not the technique's error
    noisy = measure_regions(test, truth, np.full_like(truth, 0.25), parts)
    assert noisy["edge.bias"] == pytest.approx(np.sqrt(found["edge.bias"] ** 2 - 0.25**2), rel=1e-12)
    black = measure_regions(test, np.zeros_like(truth), noise, parts)
    assert set(black.values()) == {None}


def test_airlight_where_the_reference_has_none_counts() -> None:
    truth = np.ones((HEIGHT, WIDTH, 3))
    truth[:, 80:] = 0.0
    right = np.zeros((HEIGHT, WIDTH), bool)
    right[:, 80:] = True
    leak = truth.copy()
    leak[:, 88:] = 0.5
    found = measure_regions(leak, truth, np.zeros_like(truth), {"shaft": right, "smooth": ~right})
    # 8 of the 88 columns in which there is airlight in either
    assert found["shaft.share"] == pytest.approx(8 / 88)
    assert found["shaft.bias"] == 0.5
    assert found["shaft.rel_50"] > 0.5
    assert found["smooth.bias"] == 0.0
