"""Marches with shifted samples: unbiased, by the noise that they say, the same in each frame."""

from __future__ import annotations

import numpy as np
import pytest
from oracles import SphereScene, piece_airlight
from scene_files import write_scene

import gpu_impl.visibilities.blue_noise
from gpu_impl.device import read, shared_device
from gpu_impl.renderer import Renderer
from gpu_impl.shader_source import ShaderSource, compile_program
from gpu_impl.techniques import find_technique
from scenes.loader import load

SHIFTED = ("uniform_march:jittered", "uniform_march:blue_noise")


def shifted_by(offset: float, scene, monkeypatch: pytest.MonkeyPatch, airlight: str, steps: int) -> np.ndarray:
    """Airlight of a march all of whose rays have the same offset."""
    tile = np.full((gpu_impl.visibilities.blue_noise.SIZE,) * 2, offset, np.float32)
    monkeypatch.setattr(gpu_impl.visibilities.blue_noise, "blue_noise", lambda: tile)
    with Renderer(scene) as renderer:
        frame = renderer.render(find_technique(f"uniform_march:blue_noise+{airlight}", steps=steps))
    return frame.scattering.astype(float)


def test_the_mean_over_offsets_is_the_march_with_as_many_more_steps(monkeypatch, draw) -> None:
    """Offsets (j + 1/2) / M of N steps are together the middles of N M steps, each of which counts the same."""
    scene = load("sphere", size=(40, 40))
    steps, offsets = 4, 16
    marches = [shifted_by((j + 0.5) / offsets, scene, monkeypatch, "riemann", steps) for j in range(offsets)]
    fine = draw(scene, "uniform_march+riemann", steps=steps * offsets).scattering
    # measured: 4.3e-7 of the brightest pixel
    assert np.abs(np.mean(marches, axis=0) - fine).max() < 2e-6 * fine.max()
    # and no march does it alone: measured 0.136 of the mean for the best of them
    assert min(np.abs(one - fine).mean() for one in marches) > 0.1 * fine.mean()


@pytest.mark.parametrize("offset", [0.1, 0.5, 0.75])
def test_pieces_tile_the_ray_but_for_the_one_that_is_cut(offset: float, monkeypatch) -> None:
    """With an exact model a lit ray's march is known: all whole pieces together, and the cut one at its weight."""
    scene, steps = load("empty", size=(24, 24)), 8
    found = shifted_by(offset, scene, monkeypatch, "quadrature", steps)
    # the ray ends 16 mean free paths behind the light, which is sooner than the far plane (ray_in_fog.glsl)
    origin, direction, t_max = scene.camera.rays()
    light = scene.lights[0]
    t_h = np.einsum("hwi,hwi->hw", light.position - origin, direction)
    end = np.minimum(t_max, np.maximum(t_h, 0) + 16 / np.min(scene.medium.sigma_t))
    dt, part = end / steps, min(2 * offset, 2 - 2 * offset)
    middle = (offset if offset < 0.5 else steps - 1 + offset) * dt
    whole = (np.array([0, steps - 1]) + (offset < 0.5) + offset - 0.5)[:, None, None] * dt
    cut = piece_airlight(scene, light, middle - 0.5 * part * dt, middle + 0.5 * part * dt) / part
    expected = piece_airlight(scene, light, *whole) + cut
    # measured: 9.4e-7
    assert np.abs(found / expected - 1).max() < 1e-5


@pytest.mark.parametrize("offset", [0.0, 1.0])
@pytest.mark.parametrize("airlight", ["riemann", "quadrature", "one_ei"])
def test_an_offset_at_an_end_is_finite(offset: float, airlight: str, monkeypatch) -> None:
    scene = load("empty", size=(8, 8))
    found, regular = (shifted_by(one, scene, monkeypatch, airlight, 64) for one in (offset, 0.5))
    # measured: 0.0254
    assert np.abs(found / regular - 1).max() < 0.1


@pytest.mark.parametrize("visibility", SHIFTED)
def test_noise_leaves_no_bias(visibility: str) -> None:
    scene = load("sphere", size=(128, 128))
    truth = SphereScene(scene).scattering()
    with Renderer(scene) as renderer:
        pictures = {
            name: renderer.render(find_technique(f"{name}+riemann", steps=16)).scattering
            for name in (visibility, "uniform_march")
        }
    errors = {name: picture.astype(float) - truth for name, picture in pictures.items()}
    off = {name: abs(error.mean()) / truth.mean() for name, error in errors.items()}
    # measured: 2.9e-5 jittered, 2.7e-4 with blue noise, whose tile has every value 4 times; regular 3.0e-2
    assert off[visibility] < 1e-3
    assert off["uniform_march"] > 1e-2


@pytest.mark.parametrize("visibility", SHIFTED)
def test_the_noise_stands_still(visibility: str, tmp_path) -> None:
    """The same offsets in each frame, and another for the ray beside."""
    scene = write_scene(tmp_path, '<emitter type="point"><point name="position" x="1" y="0" z="0"/></emitter>')
    technique = find_technique(f"{visibility}+riemann", steps=8)
    with Renderer(scene) as renderer:
        first, second = (renderer.render(technique).scattering for _ in range(2))
        regular = renderer.render(find_technique("uniform_march+riemann", steps=8)).scattering
    np.testing.assert_array_equal(first, second)
    signs = np.sign(first - regular)[..., 0]
    # measured: 0.48 and 0.38
    assert (signs[:, 1:] != signs[:, :-1]).mean() > 0.3


def test_interleaved_gradient_noise_is_as_published() -> None:
    """Against float64, and by what Jimenez chose it for: in any 3 x 3 pixels the values are spread over 0 to 1."""
    main = (
        '#include "visibility/uniform_march_jittered.glsl"\n'
        "layout(location = 0) out vec4 result;\nvoid lit(float t0, float dt, float w) {}\n"
        "vec3 airlight(Ray ray, Light light, float t0, float dt) { return vec3(0.0); }\n"
        "void main() { result = vec4(interleaved_gradient_noise(gl_FragCoord.xy)); }"
    )
    defines = {"STEPS": 1, "TILES": 1, "DIRECTIONAL": 0, "GREY": 1}
    device, side = shared_device(), 256
    program = compile_program(
        device.context,
        ShaderSource("fullscreen.vert.glsl", defines),
        ShaderSource("<main>", defines, generated={"<main>": main}),
    )
    target = device.texture((side, side), 4)
    device.begin_drawing()
    device.fill(program, target)
    drawn = read(target)[..., 0].astype(float)
    device.give_back(target)
    program.release()
    y, x = np.mgrid[:side, :side] + 0.5
    exact = (52.9829189 * ((0.06711056 * x + 0.00583715 * y) % 1)) % 1
    apart = np.abs(drawn - exact)
    # measured: 1.1e-4; float32 holds the inner product to 1e-6, which the factor makes more of
    assert np.minimum(apart, 1 - apart).max() < 2e-4
    squares = np.sort(np.lib.stride_tricks.sliding_window_view(drawn, (3, 3)).reshape(-1, 9))
    gaps = np.diff(np.concatenate([squares, squares[:, :1] + 1], axis=1))
    # measured: 0.1351; nine random values leave 0.31 in the mean
    assert gaps.max() < 0.14
