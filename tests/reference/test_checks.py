"""A light or the camera shut in is refused by its place in the file, and nothing else is; what is refused is black."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from scene_files import POINT, point, sphere, spot, write_scene

from reference.checks.shut_in import _cuts_the_view, check_scene
from reference.estimators import Equiangular
from scenes.catalogue import shipped
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Scene


def box(half: float, x: float = 0, y: float = 0, z: float = 0, turn: float = 0) -> str:
    return (
        f"<shape type='cube' id='box'><transform name='to_world'><scale value='{half}'/>"
        f"<rotate x='1' y='0' z='0' angle='{turn}'/><translate x='{x}' y='{y}' z='{z}'/></transform></shape>"
    )


TUBE = "<shape type='cylinder'><point name='p0' x='0' y='-1' z='0'/><point name='p1' x='0' y='1' z='0'/></shape>"
GROUP = (
    "<shape type='shapegroup' id='lamps'><shape type='sphere'/></shape><shape type='instance'><ref id='lamps'/>"
    "<transform name='to_world'><scale value='0.5'/><translate x='0.3' y='2.6'/></transform></shape>"
)
INSIDE, SHUT_IN = "emitter plugin '{}' is inside the closed surface", "sensor plugin 'perspective' is inside the closed"

# what is refused: settings of write_scene, and the beginning of the reason
REFUSED: dict[str, tuple[dict, str]] = {
    "a light in a ball": ({"shapes": sphere(0.3, 2.6, 0, 0.5)}, INSIDE.format("point")),
    "a spot in a box": ({"emitters": spot("0, 2, 0", "0, 0, 0", 40, 30), "shapes": box(0.5, 0, 2)}, "plugin 'spot'"),
    "a light in an instance": ({"shapes": GROUP}, INSIDE.format("point")),
    "a light just inside": ({"emitters": point(0, 0.499, 0), "shapes": box(0.5)}, INSIDE.format("point")),
    "a lantern in the room": ({"shapes": sphere(0.3, 2.6, 0, 0.5) + box(9)}, INSIDE.format("point")),
    "a camera in a ball": ({"shapes": sphere(0, 0, 5, 0.5)}, SHUT_IN),
    "a camera in a turned box": ({"shapes": box(0.5, 0, 0, 5, turn=33)}, SHUT_IN),
    "a near plane beyond the lamp": (
        {"emitters": point(0, 0, 4.5), "shapes": sphere(0, 0, 4.5, 0.3), "near": 1},
        INSIDE.format("point"),
    ),
}
# what is not, though it looks like it
TAKEN: dict[str, dict] = {
    "an open lamp shade": {"emitters": point(0, 0, 0), "shapes": TUBE},
    "a room": {"shapes": box(9)},
    "a camera and its own lamp in a box": {"emitters": POINT + point(0, 0, 4.8), "shapes": box(0.5, 0, 0, 5)},
    # the camera is outside the ball, and its rays begin inside
    "a near plane in the lamp": {"emitters": point(0, 0, 4.5), "shapes": sphere(0, 0, 4.5, 0.4), "near": 0.5},
    # the first is outside the near plane's middle, the second is smaller than the near plane
    "a near plane that cuts a lamp": {"emitters": point(0.2, 0, 4.5), "shapes": sphere(0.2, 0, 4.5, 0.1), "near": 0.5},
    "a near plane that a lamp touches": {"emitters": point(0, 0, 4.5), "shapes": sphere(0, 0, 4.5, 0.1), "near": 0.5},
    "a light outside a ball": {"emitters": point(0, 0.501, 0), "shapes": box(0.5)},
}


def airlight_of(scene: Scene) -> np.ndarray:
    return Equiangular(scene).one_pass(0)["scattering"]


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_shut_in_is_refused_and_black(case: str, tmp_path: Path) -> None:
    settings, reason = REFUSED[case]
    scene = write_scene(tmp_path, size=(16, 16), **settings)
    with pytest.raises(InputError, match=r"scene.xml \(line \d+, col \d+\): ") as error:
        check_scene(scene)
    assert reason in str(error.value)
    assert not airlight_of(scene).any()


@pytest.mark.parametrize("case", TAKEN)
def test_what_is_not_shut_in_is_taken_and_lit(case: str, tmp_path: Path) -> None:
    scene = write_scene(tmp_path, size=(16, 16), **TAKEN[case])
    check_scene(scene)
    assert airlight_of(scene).any()


def test_the_light_that_is_meant_is_named(tmp_path: Path) -> None:
    emitters = POINT + "\n" + point(-1, 0, 0) + "\n" + point(1, 0, 0)
    scene = write_scene(tmp_path, emitters=emitters, shapes="\n" + sphere(1, 0, 0, 0.2), size=(4, 4))
    lines = (tmp_path / "scene.xml").read_text().splitlines()
    line = next(number for number, text in enumerate(lines, 1) if "x='1' y='0' z='0'" in text and "emitter" in text)
    with pytest.raises(InputError, match=rf"line {line}, .*shape 'shape_0'"):
        check_scene(scene)


def test_sunlight_is_outside_everything(others: Path) -> None:
    check_scene(load(others / "sun_in_a_box.xml", size=(4, 4)))
    text = (others / "sun_in_a_box.xml").read_text()
    eye = load(others / "sun_in_a_box.xml", size=(4, 4)).camera.origin
    shut = others / "shut_in.xml"
    shut.write_text(text.replace("</scene>", f"{sphere(*eye, 0.05)}</scene>"))
    with pytest.raises(InputError, match=SHUT_IN):
        check_scene(load(shut, size=(4, 4)))


def test_fog_in_a_ball_with_a_lamp_in_it_is_taken(others: Path) -> None:
    check_scene(load(others / "ball_of_smoke.xml", size=(4, 4)))


@pytest.mark.parametrize("name", shipped())
def test_every_shipped_scene_is_taken(name: str) -> None:
    check_scene(load(name, size=(4, 4)))


def test_a_triangle_cuts_the_view_where_it_meets_the_near_plane(tmp_path: Path) -> None:
    camera = write_scene(tmp_path, size=(30, 20), near=2, eye="1, 2, 3").camera
    random = np.random.default_rng(6)
    half = 2 * np.array([camera.tan_half_x, camera.tan_half_y])
    cut = 0
    for _ in range(400):
        local = random.normal((0, 0, 2), 1.2, (3, 3))
        triangle = local @ camera.to_world[:3, :3].T + camera.origin
        body = trimesh.Trimesh(local, [[0, 1, 2]], process=False)
        segments = trimesh.intersections.mesh_plane(body, [0, 0, 1], [0, 0, 2])
        share = np.linspace(0, 1, 2001)[:, None]
        nearest = [np.abs((a + share * (b - a))[:, :2] / half).max(axis=1).min() for a, b in segments] or [np.inf]
        if abs(nearest[0] - 1) > 2e-3:  # as far apart as the places on the segment
            assert _cuts_the_view(triangle[None], camera) == (nearest[0] < 1)
            cut += nearest[0] < 1
    assert 50 < cut < 350
