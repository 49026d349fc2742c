"""Where a reference is zero everywhere, or not finite, the reason that is given is the one that the scene has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scene_files import POINT, point, spot, write_scene

from reference.checks.why_black import why_black
from reference.checks.why_not_finite import why_not_finite
from reference.estimators import Equiangular
from reference.integrator import mi
from scenes.loader import load
from scenes.model import Scene

FAINT = "<float name='intensity' value='1e-37'/>"
RED = "<rgb name='intensity' value='10, 0, 0'/>"
FORWARD = "<phase type='tabphase'><string name='values' value='0, 0, 1'/></phase>"
WALL = "<shape type='rectangle'><transform name='to_world'><scale value='50'/><translate z='{}'/></transform></shape>"


def fog(sigma_t: str, kind: str = "float") -> str:
    return f"<{kind} name='sigma_t' value='{sigma_t}'/>"


# settings of write_scene, and what is said
BLACK: dict[str, tuple[dict, str]] = {
    "no fog": ({"sigma_t": fog("0")}, "sigma_t = 0"),
    "another colour": ({"sigma_t": fog("0, 0.1, 0.2", "rgb"), "emitters": point(0, 1, 0, RED)}, "in none of the chan"),
    "a spot that points away": ({"emitters": spot("0, 3, 0", "0, 9, 1", 20, 20)}, "every spot points elsewhere"),
    "a spot behind the eye": ({"emitters": spot("0, 0, 6", "0, 9, 60", 40, 20)}, "every spot points elsewhere"),
    "no light backwards": ({"emitters": point(0, 0, 50), "phase": FORWARD}, "the phase function, or the picture"),
    "a wall before the lamp": ({"emitters": point(0, 0, -3), "shapes": WALL.format(-1)}, "surfaces keep every light"),
    "a lamp on a wall": ({"emitters": point(0, 0, -1), "shapes": WALL.format(-1)}, "surfaces keep every light"),
    "two lamps, each with its own reason": (
        {"emitters": point(0, 0, -3) + spot("0, 3, 0", "0, 9, 1", 20, 20), "shapes": WALL.format(-1)},
        "surfaces keep every light",
    ),
    # 5.64 is the distance from the light to the eye
    "thick fog": ({"sigma_t": fog("100")}, "optical depth of at least 563"),
    # an optical depth of 61 by the shortest way
    "a faint lamp in thick fog": (
        {"sigma_t": fog("12"), "emitters": point(0, 1, 0, FAINT)},
        "too faint for float32",
    ),
    "a faint lamp": ({"emitters": point(0, 1, 0, FAINT)}, "too faint for float32"),
}


def airlight_of(scene: Scene) -> np.ndarray:
    return Equiangular(scene).one_pass(0)["scattering"]


def bounded(folder: Path, target: str = "0, 0, 0", far: float = 20, shapes: str = "", sigma_t: float = 1) -> Scene:
    """A ball of fog seen from 5 scene units away, with a lamp at 3 from its middle."""
    path = folder / "scene.xml"
    path.write_text(
        f"""<scene version='3.0.0'>
          <medium type='homogeneous' id='fog'><float name='sigma_t' value='{sigma_t}'/></medium>
          <shape type='sphere'><bsdf type='null'/><ref id='fog' name='interior'/></shape>
          <sensor type='perspective'><float name='fov' value='20'/><float name='far_clip' value='{far}'/>
            <transform name='to_world'><lookat origin='0, 0, 5' target='{target}' up='0, 1, 0'/></transform>
            <film type='hdrfilm'/></sensor>
          {point(0, 0, -3)}{shapes}</scene>"""
    )
    return load(path, size=(16, 16))


@pytest.fixture(params=sorted({mi.variant(), "scalar_rgb"}))
def variant(request: pytest.FixtureRequest) -> str:
    """Where there are rays, and where there are none to spare."""
    mi.set_variant(request.param)
    return request.param


@pytest.mark.parametrize("case", BLACK)
def test_the_reason_is_that_of_the_scene(case: str, variant: str, tmp_path: Path) -> None:
    settings, reason = BLACK[case]
    said = why_black(write_scene(tmp_path, size=(16, 16), **settings))
    assert said.startswith(f"In {tmp_path / 'scene.xml'}, ")
    assert reason in said


@pytest.mark.parametrize("case", [case for case in BLACK if case not in ("no fog", "another colour")])
def test_these_scenes_are_black(case: str, tmp_path: Path) -> None:
    assert not airlight_of(write_scene(tmp_path, size=(16, 16), **BLACK[case][0])).any()


def test_fog_that_only_absorbs(variant: str) -> None:
    assert "albedo = 0" in why_black(load("sphere", size=(16, 16), albedo=0))


@pytest.mark.parametrize(
    ("settings", "reason", "without_rays"),
    [
        ({"target": "5, 0, 5"}, "no ray of the camera meets the shape", "no ray of the camera meets the shape"),
        ({"shapes": WALL.format(2)}, "surfaces stand before the shape", "surfaces keep every light"),
        ({"shapes": WALL.format(-2)}, "surfaces keep every light", "surfaces keep every light"),
        # 2, the way through the ball, and not 8, the way from the lamp to the eye
        ({"sigma_t": 100}, "optical depth of at least 1", "optical depth of at least 1"),
    ],
)
def test_fog_in_a_shape(settings: dict, reason: str, without_rays: str, variant: str, tmp_path: Path) -> None:
    scene = bounded(tmp_path, **settings)
    assert (without_rays if variant == "scalar_rgb" else reason) in why_black(scene)


def test_a_thin_ball_of_fog_lets_light_through(tmp_path: Path) -> None:
    # 8 scene units of it would not
    scene = bounded(tmp_path, sigma_t=12)
    assert airlight_of(scene).any()
    assert "no reason was found" in why_black(scene)


def test_a_light_beyond_float32s_squares_is_black(tmp_path: Path) -> None:
    scene = write_scene(tmp_path, size=(9, 9), emitters=point(1e20, 0, 0))
    assert not airlight_of(scene).any()
    assert "optical depth of at least 1e+19" in why_black(scene)


def test_no_reason_is_made_up_for_a_scene_that_is_lit(others: Path) -> None:
    for scene in (load("sphere", size=(16, 16)), load(others / "sun_in_a_box.xml", size=(16, 16))):
        assert "no reason was found" in why_black(scene)


def test_a_pixel_that_looks_into_the_light_is_named(tmp_path: Path) -> None:
    scene = write_scene(tmp_path, emitters=POINT + point(0, 0, 0), size=(9, 9))
    image = airlight_of(scene)
    assert np.argwhere(~np.isfinite(image).all(axis=-1)).tolist() == [[4, 4]]
    said = why_not_finite(scene, "scattering", image)
    assert "'scattering' 1 of 81 pixel is not finite, the first in column 4 of row 4" in said
    assert "straight into the light at [0.0, 0.0, 0.0]" in said


@pytest.mark.parametrize(
    ("settings", "reason"),
    [
        ({"emitters": point(0, 1, 0, "<float name='intensity' value='3e38'/>")}, "intensity is 3e+38"),
        ({"sigma_t": fog("3e38")}, "sigma_t is 3e+38"),
    ],
)
def test_numbers_that_float32_cannot_multiply_are_named(settings: dict, reason: str, tmp_path: Path) -> None:
    scene = write_scene(tmp_path, size=(9, 9), **settings)
    image = airlight_of(scene)
    assert not np.isfinite(image).all()
    assert reason in why_not_finite(scene, "scattering", image)


def test_no_reason_is_made_up_for_pixels_that_look_elsewhere(tmp_path: Path) -> None:
    scene = write_scene(tmp_path, emitters=point(0, 0, 0), size=(9, 9))
    image = np.zeros((9, 9, 3))
    # one looks into the light, the other does not
    image[4, 4], image[2, 3, 1] = np.inf, np.nan
    said = why_not_finite(scene, "surface", image)
    assert "'surface' 2 of 81 pixels are not finite, the first in column 3 of row 2: no reason was found" in said
