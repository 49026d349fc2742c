"""Upsampling: each shader against a twin in NumPy, and all of them where they must agree or must not."""

from __future__ import annotations

import numpy as np
import pytest

from gpu_impl.context import shared_context
from gpu_impl.device import Device
from gpu_impl.passes.combination import combine
from gpu_impl.passes.geometry import GBuffer
from gpu_impl.techniques import UPSAMPLINGS, find_technique
from scenes.loader import load
from scenes.model import Camera

SIZES = [(32, 24), (45, 31), (17, 5), (9, 2), (1, 7), (1, 1)]
STEPS = [2, 4, 8]
BACKGROUND = 1e30


def plane(camera: Camera, normal: tuple[float, float, float], through: tuple[float, float, float]) -> np.ndarray:
    """Normal and distance of a plane before the eye, (H, W, 4); 0 where a ray misses it.

    `through` is a point in camera space, `normal` too.
    """
    origin, direction, t_max = camera.rays()
    turn = camera.to_world[:3, :3]
    n, point = turn @ np.array(normal) / np.linalg.norm(normal), camera.origin + turn @ through
    with np.errstate(divide="ignore"):
        distance = (point - origin) @ n / (direction @ n)
    found = np.concatenate([np.broadcast_to(n, direction.shape), distance[..., None]], axis=-1)
    return np.where(((distance > 0) & (distance < t_max))[..., None], found, 0)


def a_view(camera: Camera) -> np.ndarray:
    """A steep floor before the background, a plate that covers part of both, and a wire, (H, W, 4)."""
    seen = plane(camera, (0, 1, 0), (0, -0.5, 0))
    plate = plane(camera, (0.3, 0, -1), (0, 0, 2))
    seen[:, camera.width // 3 : camera.width // 2] = plate[:, camera.width // 3 : camera.width // 2]
    seen[:, 4 * camera.width // 5] = plane(camera, (0, 0, -1), (0, 0, 1.5))[:, 4 * camera.width // 5]
    return seen.astype(np.float32)


def evaluated(pixels: int, step: int) -> np.ndarray:
    """Which pixels of a row or column are."""
    return np.arange(min(step // 2, (pixels - 1) % step), pixels, step)


def upsampled(name: str, camera: Camera, seen: np.ndarray, lattice: np.ndarray, step: int) -> np.ndarray:
    """What the combination pass makes of values on the lattice, (H, W, 4)."""
    device = Device(shared_context())
    size, scene = (camera.width, camera.height), load("empty", size=(camera.width, camera.height))
    found, material, surface, attenuated, result = (device.texture(size, 4) for _ in range(5))
    airlight = device.texture(lattice.shape[1::-1], 4)
    found.write(seen.tobytes())
    surface.write(np.zeros((*size, 4), np.float32).tobytes())
    airlight.write(lattice.tobytes())
    technique = find_technique("Weng2010", downsample=step, upsample=name)
    combine(device, (attenuated, result), technique, scene, GBuffer(found, material, None), surface, airlight, step)
    image = np.frombuffer(result.read(), np.float32).reshape(camera.height, camera.width, 4)
    device.give_back(found, material, surface, attenuated, result, airlight)
    device.release()
    return image


def twin(name: str, camera: Camera, seen: np.ndarray, lattice: np.ndarray, step: int) -> np.ndarray:
    """The same, a pixel at a time, in float64."""
    origin, direction, _ = camera.rays()
    depth = np.where(seen[..., 3] > 0, seen[..., 3], BACKGROUND).astype(float)
    rows, columns = evaluated(camera.height, step), evaluated(camera.width, step)
    result = np.empty((camera.height, camera.width, 4))
    for y, x in np.ndindex(result.shape[:2]):
        v, u = (y - rows[0]) / step, (x - columns[0]) / step
        below, right = v - np.floor(v), u - np.floor(u)
        near = np.array([(1 - below) * (1 - right), (1 - below) * right, below * (1 - right), below * right])
        i = np.clip(int(np.floor(v)) + np.array([0, 0, 1, 1]), 0, len(rows) - 1)
        j = np.clip(int(np.floor(u)) + np.array([0, 1, 0, 1]), 0, len(columns) - 1)
        at = rows[i], columns[j]
        there = depth[at]
        normal = seen[at][0, :3].astype(float)
        point = origin[at][0] + there[0] * direction[at][0]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            expected = (point - origin[at]) @ normal / (direction[at] @ normal)
            agree = (np.abs(expected - there) < 0.01 * there)[1:].all() or there.max() < 1.02 * there.min()
        apart = np.abs(there - depth[y, x]) / np.maximum(there, depth[y, x])
        weight = near
        if not agree and name == "bilateral":
            weight = (near + 1e-4) / (1 + (apart / 0.02) ** 2) ** 2
        if not agree and name == "nearest_depth":
            weight = np.arange(4) == np.argmin(apart)
        result[y, x] = weight @ lattice[i, j] / weight.sum()
    return result


def random_lattice(camera: Camera, step: int) -> np.ndarray:
    shape = (-(-camera.height // step), -(-camera.width // step), 4)
    return np.random.default_rng(5).uniform(0.5, 1.5, shape).astype(np.float32)


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("name", UPSAMPLINGS)
def test_every_pixel_is_its_twins(name: str, step: int, size: tuple[int, int]) -> None:
    camera = load("empty", size=size).camera
    seen, lattice = a_view(camera), random_lattice(camera, step)
    image = upsampled(name, camera, seen, lattice, step)
    # measured 9e-7: float32, and the driver's own rounding of where between two texels a pixel lies
    assert image == pytest.approx(twin(name, camera, seen, lattice, step), abs=4e-6)


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("name", UPSAMPLINGS)
def test_an_evaluated_pixel_gives_itself_back(name: str, step: int) -> None:
    camera = load("empty", size=(64, 48)).camera
    lattice = random_lattice(camera, step)
    image = upsampled(name, camera, a_view(camera), lattice, step)
    there = image[np.ix_(evaluated(48, step), evaluated(64, step))]
    # measured 0, and 9e-5 in the bilateral filter, where the other three count 1e-4 at most beside a weight of 1
    assert there == pytest.approx(lattice, abs=3e-4 if name == "bilateral" else 4e-6)


def test_a_floor_is_one_surface_by_its_normal() -> None:
    camera = load("empty", size=(64, 64)).camera
    seen, lattice = plane(camera, (0, 1, 0), (0, -0.5, 0)).astype(np.float32), random_lattice(camera, 4)
    bilinear, bilateral, nearest = (
        upsampled(name, camera, seen, lattice, 4) for name in ("bilinear", "bilateral", "nearest_depth")
    )
    # the cells below the horizon, whose corners are up to a quarter as far away again as one another
    assert seen[46, 32, 3] > 1.25 * seen[50, 32, 3]
    assert (bilateral[46:] == bilinear[46:]).all()
    assert (nearest[46:] == bilinear[46:]).all()
    # a normal that does not span it leaves the depth alone to decide, and that differs
    seen[..., :3] = camera.to_world[:3, 2]
    assert np.abs(upsampled("bilateral", camera, seen, lattice, 4) - bilinear)[46:].max() > 0.1


def test_a_wall_that_is_seen_at_one_depth_needs_no_normal() -> None:
    # in few pixels the ways there would differ by too much
    camera = load("empty", size=(128, 128)).camera
    seen, lattice = plane(camera, (0, 0, -1), (0, 0, 3)).astype(np.float32), random_lattice(camera, 4)
    seen[..., :3] = 0
    images = [upsampled(name, camera, seen, lattice, 4) for name in UPSAMPLINGS]
    assert (images[0] == images[1]).all()
    assert (images[0] == images[2]).all()


def test_nothing_leaks_across_an_edge() -> None:
    camera = load("empty", size=(64, 64)).camera
    seen = plane(camera, (0, 0, -1), (0, 0, 6)).astype(np.float32)
    seen[:, 30:] = plane(camera, (0, 0, -1), (0, 0, 2))[:, 30:]
    lattice = np.where((evaluated(64, 4) < 30)[None, :, None], 1.0, 5.0) * np.ones((16, 16, 4))
    for name, leak in (("bilinear", 1.0), ("bilateral", 5e-5), ("nearest_depth", 0.0)):
        image = upsampled(name, camera, seen, lattice.astype(np.float32), 4)
        exact = np.where((np.arange(64) < 30)[None, :, None], 1.0, 5.0)
        worst = np.abs(image - exact).max()
        # measured 3.0, 1.3e-5 and 0
        assert worst >= 1 if name == "bilinear" else worst <= leak


@pytest.mark.parametrize("scene_name", ["sphere", "slit"])
@pytest.mark.parametrize("step", [2, 4])
def test_guided_by_depth_beats_bilinear_at_edges(scene_name: str, step: int, draw) -> None:
    scene = load(scene_name, size=(128, 96))
    settings = {"technique": "lit_intervals:unbounded+quadrature", "steps": 32, "shadow_map": 256}
    full = draw(scene, **settings)
    step_in_depth = np.abs(np.diff(full.depth, axis=1)) > 0.1 * full.depth[:, 1:]
    edges = np.pad(step_in_depth, ((0, 0), (1, 0))) | np.pad(step_in_depth, ((0, 0), (0, 1)))
    error = {
        name: np.abs(draw(scene, **settings, downsample=step, upsample=name).scattering - full.scattering)[edges].mean()
        for name in UPSAMPLINGS
    }
    # measured 0.09 and 0.12 (sphere), 0.07 and 0.07 (slit) for a step of 2; 0.15 and 0.22, 0.16 and 0.19 for 4
    assert error["bilateral"] < 0.3 * error["bilinear"]
    assert error["nearest_depth"] < 0.35 * error["bilinear"]
