"""Fog that a shape holds, on the GPU: against closed forms where there are some, against a fine march elsewhere."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles import piece_airlight
from scene_files import point
from slab import COLOURED, GREY, THICK, VIEWS, slab_scattering, slab_scene, slab_surface

from gpu_impl.techniques import find_technique
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Scene

QUADRATURE = "lit_intervals+quadrature"
# the map's texels are 0.2 wide here, and the floor lies 0.3 below the slab
QUICK = {"steps": 64, "shadow_map": 1024}


def worst(image: np.ndarray, exact: np.ndarray) -> float:
    return float((np.abs(image - exact) / exact.max()).max())


@pytest.mark.parametrize("sigma_t", [GREY, COLOURED, THICK], ids=["grey", "coloured", "thick"])
@pytest.mark.parametrize("view", VIEWS)
def test_a_slab_under_the_sun(view: str, sigma_t: str, draw, tmp_path: Path) -> None:
    scene = slab_scene(tmp_path, VIEWS[view], sigma_t)
    frame, exact = draw(scene, QUADRATURE, **QUICK), slab_scattering(scene)
    # float32 places a boundary 100 units wide to some 1e-6: measured 6.5e-6, of thick fog 8.1e-6 of the brightest
    if sigma_t != THICK:
        assert (np.abs(frame.scattering - exact) / exact).max() < 2e-5
    assert worst(frame.scattering, exact) < 2.5e-5
    surface = slab_surface(scene)
    assert (surface.max() > 0) == (view != "from within, upward into the light")
    np.testing.assert_allclose(frame.surface, surface, rtol=1e-4, atol=1e-12)


def test_a_march_through_the_slab(draw, tmp_path: Path) -> None:
    scene = slab_scene(tmp_path, VIEWS["from above"])
    # second order: measured 1.0e-5 with 64 steps
    assert worst(draw(scene, "uniform_march+riemann", steps=64).scattering, slab_scattering(scene)) < 5e-5


def written(folder: Path, shape: str, emitter: str, inside: bool, eye: str = "0.2, 0.3, 6") -> Path:
    path = folder / "scene.xml"
    path.write_text(
        f"""<scene version='3.0.0'>
          <medium type='homogeneous' id='fog'><rgb name='sigma_t' value='0.1, 0.4, 0.9'/></medium>
          {shape}{emitter}
          <sensor type='perspective'><float name='fov' value='45'/><float name='far_clip' value='40'/>
            <transform name='to_world'><lookat origin='{eye}' target='0, 0, 0' up='0, 1, 0'/></transform>
            <film type='hdrfilm'/>{"<ref id='fog'/>" * inside}</sensor></scene>"""
    )
    return path


def holder(plugin: str, properties: str = "") -> str:
    return f"<shape type='{plugin}'>{properties}<bsdf type='null'/><ref name='interior' id='fog'/></shape>"


SCALE, ANGLE, RADIUS = np.array([1.5, 1.1, 1.8]), np.radians(25), 1.6
TURNED = holder(
    "cube", "<transform name='to_world'><scale x='1.5' y='1.1' z='1.8'/><rotate y='1' angle='25'/></transform>"
)
BALL = holder("sphere", f"<float name='radius' value='{RADIUS}'/>")


def crossing(shape: str, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where rays, (..., 3), enter and leave the body, in the body's own frame."""
    if shape == BALL:
        middle = -(origin * direction).sum(-1)
        across = ((origin + middle[..., None] * direction) ** 2).sum(-1)
        half = np.sqrt(np.maximum(RADIUS**2 - across, 0))
        return middle - half, middle + half
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    turned = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    o, d = origin @ turned / SCALE, direction @ turned / SCALE
    with np.errstate(divide="ignore"):
        low, high = (-1 - o) / d, (1 - o) / d
    return np.minimum(low, high).max(-1), np.maximum(low, high).min(-1)


def by_small_steps(scene: Scene, shape: str, steps: int = 1000) -> np.ndarray:
    """Airlight, (H, W, 3), in float64 by the midpoint rule.

    Four times the steps change it by 1.1e-6 of the brightest pixel at most in the cube, and by 1.3e-5 in the ball.
    """
    (light,) = scene.lights
    origin, direction, _ = scene.camera.rays()
    begin, end = crossing(shape, origin, direction)
    begin = np.maximum(begin, 0)
    dt = np.maximum(end - begin, 0) / steps
    total = np.zeros((*dt.shape, 3))
    for i in range(steps):
        along = (i + 0.5) * dt
        point = origin + (begin + along)[..., None] * direction
        if light.kind == "directional":
            towards, power = np.broadcast_to(-light.direction, point.shape), 1.0
        else:
            distance = np.linalg.norm(light.position - point, axis=-1)
            towards, power = (light.position - point) / distance[..., None], 1 / distance**2
        leg = crossing(shape, point, towards)[1]
        weight = dt * power * scene.phase.evaluate((towards * direction).sum(-1))
        total += weight[..., None] * np.exp(-np.multiply.outer(along + leg, scene.medium.sigma_t))
    return total * light.intensity * scene.medium.sigma_s


def lamp(x: float, y: float, z: float) -> str:
    return point(x, y, z, "<float name='intensity' value='9'/>")


@pytest.mark.parametrize("model", ["quadrature", "weng2010"])
def test_a_lamp_inside_a_ball_of_fog_is_a_closed_form(model: str, draw, tmp_path: Path) -> None:
    scene = load(written(tmp_path, BALL, lamp(0.3, 0.5, -0.2), inside=False), size=(40, 32))
    origin, direction, _ = scene.camera.rays()
    begin, end = crossing(BALL, origin, direction)
    # what is before the ball takes nothing away
    whole = piece_airlight(scene, scene.lights[0], begin, end)
    exact = whole * np.exp(np.multiply.outer(begin, scene.medium.sigma_t))
    frame = draw(scene, f"lit_intervals+{model}", **QUICK)
    # measured 4e-7 and 1.3e-5 (the closed form's own loss of digits)
    assert worst(frame.scattering, exact) < {"quadrature": 2e-6, "weng2010": 5e-5}[model]


@pytest.mark.parametrize("shape", [TURNED, BALL], ids=["cube", "ball"])
@pytest.mark.parametrize(("eye", "inside"), [("0.2, 0.3, 6", False), ("0.2, 0.3, 1", True)])
@pytest.mark.parametrize(
    "emitter",
    [
        lamp(1.5, 3, 1),
        lamp(0, -9, 0.3),
        "<emitter type='directional'><vector name='direction' value='1, -2, 0.5'/></emitter>",
    ],
    ids=["lamp", "far lamp", "sun"],
)
def test_light_from_outside(shape: str, eye: str, inside: bool, emitter: str, draw, tmp_path: Path) -> None:
    scene = load(written(tmp_path, shape, emitter, inside, eye), size=(16, 16))
    exact = by_small_steps(scene, shape)
    # measured 9.2e-6; 4.4e-5 where a ray grazes the ball, whose chord float32 has as a root of next to nothing
    assert worst(draw(scene, QUADRATURE, **QUICK).scattering, exact) < (2e-4 if shape == BALL else 2e-5)
    assert worst(draw(scene, "uniform_march+riemann", steps=512).scattering, exact) < 1e-3


@pytest.mark.parametrize(
    ("emitter", "words"),
    [(lamp(1.5, 3, 1), "has a point light outside it"), ("<emitter type='directional'/>", "has a directional light")],
)
def test_a_closed_form_refuses_light_from_outside(emitter: str, words: str, draw, tmp_path: Path) -> None:
    scene = load(written(tmp_path, TURNED, emitter, inside=False), size=(8, 8))
    with pytest.raises(InputError, match=words):
        find_technique("Weng2010").check_scene(scene)
    with pytest.raises(InputError, match="use lit_intervals\\+quadrature"):
        draw(scene, "Weng2010")
