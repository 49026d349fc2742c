"""Dobashi 2002: slices of cells, against the same sums in float64, and against what they stand for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles import SphereScene, cone_interval, spot_airlight, whole_ray_airlight
from scene_files import POINT, point, sphere, spot, write_scene
from shadow_volumes import behind_polygon, plate, shadowed_airlight

from gpu_impl.frame import Frame
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes.loader import load
from scenes.model import Camera, Scene

SUN = (
    "<emitter type='directional'><vector name='direction' value='0.6, -1, -0.3'/>"
    "<rgb name='irradiance' value='3, 2, 1'/></emitter>"
)


def box_of_fog(half: tuple[float, float, float]) -> str:
    x, y, z = half
    return (
        "<shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/>"
        f"<transform name='to_world'><scale x='{x}' y='{y}' z='{z}'/></transform></shape>"
    )


def drawn(scene: Scene, visibility: str = "slices", steps: int = 64, shadow_map: int = 1024, **settings) -> Frame:
    with Renderer(scene) as renderer:
        return renderer.render(find_technique(f"{visibility}+riemann", steps=steps, shadow_map=shadow_map, **settings))


def rays_through(camera: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions of rays through places in the image, (..., 3), unit length, and how much longer than their depth."""
    local = np.stack(
        [
            (1 - 2 * x / camera.width) * camera.tan_half_x,
            (1 - 2 * y / camera.height) * camera.tan_half_y,
            np.ones(np.broadcast(x, y).shape),
        ],
        axis=-1,
    )
    stretch = np.linalg.norm(local, axis=-1)
    return (local / stretch[..., None]) @ camera.to_world[:3, :3].T, stretch


def sum_of_slices(
    scene: Scene, t_end: np.ndarray, cell: int, steps: int, lit: Callable[[np.ndarray], np.ndarray]
) -> np.ndarray:
    """What the technique adds up for a point light in fog that fills space, in float64, (H, W, 3).

    Parameters
    ----------
    t_end : (H, W)     where each pixel's ray ends, counted from the near plane
    lit : callable     distances from the near plane, (H, W), to whether the light reaches them, (H, W)
    """
    camera, (light,) = scene.camera, scene.lights
    eye = camera.origin
    sigma_t = np.broadcast_to(scene.medium.sigma_t, 3)
    column, row = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    direction, stretch = rays_through(camera, column, row)
    before = camera.near * stretch
    # the ellipsoid around eye and light, by bisection: both legs together are longer than the straight way by this
    detour = np.log(256) / sigma_t.min()
    straight = np.linalg.norm(light.position - eye - before[..., None] * direction, axis=-1)
    low, high = np.zeros_like(t_end), np.full_like(t_end, 1e4)
    for _ in range(60):
        middle = 0.5 * (low + high)
        way = middle + np.linalg.norm(light.position - eye - (before + middle)[..., None] * direction, axis=-1)
        low, high = np.where(way < straight + detour, (middle, high), (low, middle))
    last = ((np.minimum(low, t_end) + before) / stretch).max()
    thickness = (last - camera.near) / steps

    corner_x, corner_y = np.meshgrid(
        cell * np.arange(-(-camera.width // cell) + 1.0), cell * np.arange(-(-camera.height // cell) + 1.0)
    )
    corner_direction, corner_stretch = rays_through(camera, corner_x, corner_y)
    i, j = (np.floor(place / cell).astype(int) for place in (column, row))
    u, v = column / cell - i, row / cell - j
    total = np.zeros((*t_end.shape, 3))
    for number in range(steps):
        depth = camera.near + (number + 0.5) * thickness
        t = depth * corner_stretch
        to_light = light.position - eye - t[..., None] * corner_direction
        d = np.linalg.norm(to_light, axis=-1)
        cosine = np.einsum("hwi,hwi->hw", to_light, corner_direction) / d
        scattered = scene.phase.evaluate(cosine) / d**2 * thickness * corner_stretch
        way = t - camera.near * corner_stretch + d
        value = scattered[..., None] * np.exp(-np.multiply.outer(way, sigma_t))
        # two triangles a cell, split from the lower left corner to the upper right one
        here, right, below, across = value[j, i], value[j, i + 1], value[j + 1, i], value[j + 1, i + 1]
        first = here + u[..., None] * (right - here) + v[..., None] * (below - here)
        second = across + (1 - u)[..., None] * (below - across) + (1 - v)[..., None] * (right - across)
        t_pixel = depth * stretch - before
        counts = (t_pixel < t_end) & lit(t_pixel)
        total += np.where(counts[..., None], np.where((u + v <= 1)[..., None], first, second), 0)
    return total * light.intensity * np.broadcast_to(scene.medium.sigma_s, 3)


@pytest.mark.parametrize("cell", [1, 8, 32])
@pytest.mark.parametrize(("name", "sigma_t"), [("empty", 0.1), ("empty", 0.5), ("half_plane", 0.1)])
def test_it_is_the_sum_of_its_slices(name: str, sigma_t: float, cell: int) -> None:
    """Pixel by pixel, in a picture whose sides no cell divides; thick fog ends before the far plane does."""
    scene = load(name, size=(52, 37), phase="hg", g=0.3, sigma_t=sigma_t)
    frame = drawn(scene, "slices" if cell == 8 else f"slices:{cell}", steps=12, shadow_map=2048)
    t_end = frame.depth.astype(float)
    dark = behind_polygon(scene, plate(-80, 0, 1.9), t_end) if name == "half_plane" else (np.inf, np.inf)
    expected = sum_of_slices(scene, t_end, cell, 12, lambda t: (t < dark[0]) | (t > dark[1]))
    error = np.abs(frame.scattering - expected).max(axis=-1) / expected.max()
    # measured: 4.4e-7; where a slice passes the shadow's edge within a texel, either may be: 11 of 1,924 pixels
    assert (error > 2e-6).sum() <= (0 if name == "empty" else 20)


def test_even_light_in_thin_fog_is_exact(tmp_path: Path) -> None:
    """Every slice sends as much as any other: what is left is to count them."""
    half = (2.0, 1.5, 1.2)
    scene = write_scene(
        tmp_path, SUN, box_of_fog(half), size=(45, 39), eye="0.3, 0.4, 6", inside=False,
        sigma_t="<float name='sigma_t' value='1e-7'/>",
    )  # fmt: skip
    camera, (sun,) = scene.camera, scene.lights
    steps = 10
    frame = drawn(scene, "slices:1", steps, 4)
    column, row = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    direction, stretch = rays_through(camera, column, row)
    faces = (np.multiply.outer([-1, 1], half)[:, None, None] - camera.origin) / direction
    begin, end = faces.min(axis=0).max(axis=-1), faces.max(axis=0).min(axis=-1)
    inside = end > begin
    first, last = (begin / stretch)[inside].min(), (end / stretch)[inside].max()
    depth = first + (np.arange(steps)[:, None, None] + 0.5) / steps * (last - first)
    counted = ((depth * stretch >= begin) & (depth * stretch < end)).sum(axis=0) * inside
    unit = (sun.intensity * scene.medium.sigma_s)[:3] / (4 * np.pi) * (last - first) / steps
    expected = (counted * stretch)[..., None] * unit
    assert set(np.unique(counted)) >= {0, steps - 3}
    np.testing.assert_array_equal(frame.lit_intervals, counted)
    # measured: 7.9e-5, as the length of slanted rays is interpolated over a cell too
    assert np.abs(frame.scattering - expected).max() < 3e-4 * expected.max()


def test_finer_slices_come_to_the_truth() -> None:
    """Of the whole picture: its mean squared error against the exact shadow of a sphere."""
    exact = SphereScene(load("sphere", size=(48, 48)))
    truth = exact.scattering()
    errors = []
    for steps in (16, 48, 144):
        image = drawn(exact.scene, "slices:1", steps, 1024).scattering
        errors.append(float(np.sqrt(np.mean((image - truth) ** 2)) / truth.mean()))
    # measured: 1.1e-1, 1.9e-2, 8.0e-3
    assert errors[1] < errors[0] / 3
    assert errors[2] < errors[1] / 2 < 1.5e-2


def test_finer_cells_come_to_the_truth() -> None:
    """A cell smears what is steep within it: the light's neighbourhood, and nothing else in empty fog."""
    scene = load("empty", size=(96, 96))
    truth = whole_ray_airlight(scene)
    errors = {
        name: np.abs(drawn(scene, name, 96, 8).scattering - truth) for name in ("slices:1", "slices", "slices:32")
    }
    means = [float(error.mean() / truth.mean()) for error in errors.values()]
    # measured: 3.4e-4, 9.6e-3, 1.2e-1
    assert means[0] < 1e-3 < 5e-3 < means[1] < 2e-2 < 5e-2 < means[2]
    middle = np.unravel_index(truth[..., 0].argmax(), truth.shape[:2])
    y, x = np.ogrid[:96, :96]
    near = np.hypot(y - middle[0], x - middle[1]) < 16
    # measured: 0.56 of the error, in 0.09 of the picture
    assert errors["slices"][near].sum() > 0.4 * errors["slices"].sum()


def test_slices_cut_bands_into_a_shadow() -> None:
    """Where the truth is smooth, a slice that passes the shadow's edge leaves a step: more of them, and lower ones."""
    scene = load("half_plane", size=(96, 96))
    frames = [drawn(scene, steps=steps, shadow_map=2048) for steps in (16, 64)]
    truth = shadowed_airlight(scene, frames[0].depth.astype(float))
    # second differences down the columns, of the picture's mean
    rough = [
        np.abs(np.diff(image[..., 0], 2, axis=0)) / truth.mean() for image in (truth, *(f.scattering for f in frames))
    ]
    smooth = rough[0] < 1e-3
    assert smooth.mean() > 0.6
    few, many = (int((image[smooth] > 0.01).sum()) for image in rough[1:])
    # measured: 238 and 1,017
    assert 100 < few < many / 3
    high, low = (float(np.percentile(image[smooth], 99)) for image in rough[1:])
    # measured: 0.158 and 0.060
    assert high > 2 * low > 0.06


@pytest.mark.parametrize("cell", [1, 32])
def test_a_cone_is_cut_pixel_by_pixel(cell: int, tmp_path: Path) -> None:
    """However large the cells: what the light sends in each direction is no part of what they interpolate."""
    scene = write_scene(tmp_path, spot("0.3, 3.5, 0", "0, 0, 0", 24, 24), size=(64, 64))
    image = drawn(scene, f"slices:{cell}", 12, 8).scattering
    (light,), t_max = scene.lights, scene.camera.rays()[2]
    begin, end = cone_interval(scene, light.position, light.direction, light.cutoff_angle, t_max)
    expected = sum_of_slices(scene, t_max, cell, 12, lambda t: (begin < t) & (t < end))
    np.testing.assert_array_equal(image > 0, expected > 0)
    assert 0.2 < (image > 0).mean() < 0.8
    # measured: 4.4e-7
    assert np.abs(image - expected).max() < 2e-6 * expected.max()


def test_thick_fog_in_a_box(tmp_path: Path) -> None:
    """Seen from outside: corners whose rays miss the fog, and fog before a slice that is not all of the way."""
    emitters = SUN + point(0.2, 3, 0.1)
    scene = write_scene(
        tmp_path, emitters, box_of_fog((2, 1.5, 1.2)), size=(48, 48), eye="0.3, 0.4, 6", inside=False,
        sigma_t="<rgb name='sigma_t' value='0.3, 0.6, 0.9'/>",
    )  # fmt: skip
    truth = drawn(scene, "lit_intervals:unbounded", 4, 8, airlight="quadrature").scattering
    errors = [np.abs(drawn(scene, "slices:1", n, 8).scattering - truth).mean() / truth.mean() for n in (16, 64, 256)]
    # measured: 6.8e-2, 1.8e-2, 5.8e-3
    assert errors[0] > 2 * errors[1] > 4 * errors[2]
    assert errors[2] < 1e-2


def test_slices_in_the_beam_are_worth_more(tmp_path: Path) -> None:
    light = spot("0.3, 12, 0", "0, 0, 0", 12, 12)
    scene = write_scene(tmp_path, light, size=(64, 64), eye="0, 0, 20", far=60)
    truth = spot_airlight(scene)
    whole, beam = (
        float(np.abs(drawn(scene, name, 64, 8).scattering - truth).mean() / truth.mean())
        for name in ("slices", "slices:beam")
    )
    # measured: 0.12 and 0.044
    assert beam < whole / 2


def test_lights_add_up_and_one_that_lights_nothing_adds_nothing(tmp_path: Path) -> None:
    lights = point(0.3, 2.6, 0), point(-0.8, 1.9, 0.4), spot("0, 0, 9", "0, 1, 20", 20, 20)
    scene = write_scene(tmp_path, "".join(lights), size=(40, 40))
    lone = [drawn(replace(scene, lights=(light,)), "slices:beam", 20, 8) for light in scene.lights]
    assert not lone[2].scattering.any()
    together = drawn(scene, "slices:beam", 20, 8)
    # measured: 1.5e-7
    np.testing.assert_allclose(together.scattering, sum(frame.scattering for frame in lone), rtol=1e-6)
    assert together.lit_intervals.max() == 40


def test_every_second_pixel(tmp_path: Path) -> None:
    """grid/2 counts the slices that every pixel counts, on the rays that it draws."""
    # the far plane ends all rays, and so the slices, at one depth
    scene = write_scene(tmp_path, POINT, sphere(0.2, 0.9, 0, 0.5), size=(64, 48))
    with Renderer(scene) as renderer:
        fine, coarse = (
            renderer.counts(find_technique("slices+riemann", steps=16, downsample=step))["pieces"] for step in (1, 2)
        )
        pictures = [renderer.render(find_technique("slices:1+riemann", steps=16, downsample=step)) for step in (1, 2)]
    np.testing.assert_array_equal(fine[1::2, 1::2], coarse)
    assert len(np.unique(fine)) > 2
    difference = np.abs(pictures[0].scattering - pictures[1].scattering).max(axis=-1) / pictures[0].scattering.max()
    # measured: 1.5e-4, by which the picture bends from pixel to pixel
    assert np.median(difference) < 1e-3


def test_fog_ends_with_its_thinnest_colour(tmp_path: Path) -> None:
    """Slices reach to where the last of three colours ends, whichever that is."""
    for sigma_t in ("0.9, 0.5, 0.35", "0.35, 0.5, 0.9"):
        scene = write_scene(tmp_path, sigma_t=f"<rgb name='sigma_t' value='{sigma_t}'/>", size=(32, 24))
        frame = drawn(scene, "slices:1", steps=24, shadow_map=8)
        expected = sum_of_slices(scene, frame.depth.astype(float), 1, 24, np.isfinite)
        # measured: 3.5e-7
        assert np.abs(frame.scattering - expected).max() < 2e-6 * expected.max()


def test_fog_by_depth_alone_is_lit_alike_in_all_of_a_soft_cone(tmp_path: Path) -> None:
    """As it is in whole pieces: at the corners as well the model knows nothing of the angle."""
    scene = write_scene(tmp_path, spot("0.3, 3.5, 0", "0, 0, 0", 24, 12), sphere(0.3, 1.3, 0, 0.4), size=(32, 32))
    with Renderer(scene) as renderer:
        sliced, marched = (
            renderer.render(find_technique(f"{name}+depth_fog", steps=1024)).scattering.astype(float)
            for name in ("slices:1", "uniform_march")
        )
    # measured: 3.5e-3
    assert np.abs(sliced - marched).mean() < 1e-2 * marched.mean()
    # and both end with the cone
    (light,), t_max = scene.lights, scene.camera.rays()[2]
    begin, end = cone_interval(scene, light.position, light.direction, light.cutoff_angle, t_max)
    assert not marched[end <= begin].any()
    assert 0.05 < (end <= begin).mean() < 0.95


def test_what_corners_cost_is_not_counted_as_nothing() -> None:
    with Renderer(load("empty", size=(16, 8))) as renderer:
        counts = renderer.counts(find_technique("slices+one_ei", steps=8, shadow_map=8))
    assert counts["pieces"].max() > 0
    for name in ("exponential_integrals", "exponentials"):
        assert np.isnan(counts[name]).all()
