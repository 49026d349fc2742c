"""Both compositions of surface and airlight against closed forms: fog on the light's way to a surface or none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scene_files import point, write_scene
from slab import COLOURED, GREY, TOP, VIEWS, slab_scene, slab_surface

from gpu_impl.techniques import find_technique
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Scene

FLOOR, REFLECTANCE, HALF = -1.0, 0.5, 2.0
FLOOR_SHAPE = (
    f"<shape type='rectangle'><transform name='to_world'><scale value='30'/><rotate x='1' angle='-90'/>"
    f"<translate y='{FLOOR}'/></transform><bsdf type='diffuse'><rgb name='reflectance' value='{REFLECTANCE}'/></bsdf>"
    "</shape>"
)
LAMP = point(0.3, 3.0, 0.4, "<rgb name='intensity' value='30, 20, 10'/>")
# relative, for no optical depth and for each of 1: measured 2.7e-6
ALLOWED = 4e-6
QUICK = {"technique": "lit_intervals+quadrature", "steps": 8, "shadow_map": 512}


def bounded_scene(folder: Path, sigma_t: str) -> Scene:
    """The same floor and lamp; the fog fills a cube, and the lamp hangs above it."""
    path = folder / "bounded.xml"
    path.write_text(
        f"""<scene version='3.0.0'>
          <medium type='homogeneous' id='fog'>{sigma_t}<float name='albedo' value='0.9'/></medium>
          <shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/>
            <transform name='to_world'><scale value='{HALF}'/></transform></shape>
          <sensor type='perspective'><float name='fov' value='45'/><float name='far_clip' value='40'/>
            <transform name='to_world'><lookat origin='0, 1.5, 6' target='0, -1, 0' up='0, 1, 0'/></transform>
            <film type='hdrfilm'/></sensor>{LAMP}{FLOOR_SHAPE}</scene>"""
    )
    return load(path, size=(32, 24))


def in_cube(begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    """How much of the ways between points, (..., 3), lies in the cube [scene unit]."""
    way = end - begin
    with np.errstate(divide="ignore"):
        one, other = (-HALF - begin) / way, (HALF - begin) / way
    enter = np.clip(np.minimum(one, other).max(-1), 0, 1)
    leave = np.clip(np.maximum(one, other).min(-1), 0, 1)
    return np.maximum(leave - enter, 0) * np.linalg.norm(way, axis=-1)


def floor_light(scene: Scene) -> tuple[np.ndarray, ...]:
    """What a floor of no fog sends to the eye, (H, W, 3), where it is seen, and the fog on the way from and to it."""
    origin, direction, t_max = scene.camera.rays()
    (light,) = scene.lights
    distance = (FLOOR - origin[..., 1]) / direction[..., 1]
    seen = (distance > 0) & (distance < t_max)
    place = origin + distance[..., None] * direction
    seen &= np.abs(place[..., [0, 2]]).max(-1) < 30
    d = np.linalg.norm(light.position - place, axis=-1)
    clear = (REFLECTANCE / np.pi * (light.position[1] - FLOOR) / d**3)[..., None] * light.intensity
    legs = (distance, d) if scene.boundary is None else (in_cube(origin, place), in_cube(place, light.position))
    return clear, seen, *legs


@pytest.mark.parametrize("sigma_t", [GREY, COLOURED], ids=["grey", "coloured"])
@pytest.mark.parametrize("bounded", [False, True], ids=["everywhere", "bounded"])
def test_a_lamp_above_a_floor(bounded: bool, sigma_t: str, draw, tmp_path: Path) -> None:
    if bounded:
        scene = bounded_scene(tmp_path, sigma_t)
    else:
        scene = write_scene(tmp_path, LAMP, FLOOR_SHAPE, size=(32, 24), sigma_t=sigma_t, eye="0, 1.5, 6", far=40)
    coefficient = np.broadcast_to(scene.medium.sigma_t, 3)
    clear, seen, eye_leg, light_leg = floor_light(scene)
    assert seen.sum() > 300
    physical, printed = (draw(scene, **QUICK, composition=name) for name in ("physical", "printed"))
    depths = [np.multiply.outer(leg[seen], coefficient) for leg in (eye_leg, light_leg)]
    to_eye, to_floor = (np.exp(-depth) for depth in depths)
    # float32 rounds an optical depth relative to itself
    allowed = ALLOWED * (1 + sum(depths))
    both, one = physical.surface[seen], printed.surface[seen]
    assert (np.abs(both / (clear[seen] * to_eye * to_floor) - 1) < allowed).all()
    assert (np.abs(one / (clear[seen] * to_eye) - 1) < allowed).all()
    # Eq. 14's print is too bright by the light's own leg
    assert (np.abs(both / one / to_floor - 1) < allowed).all()
    assert (physical.surface[~seen] == 0).all()
    assert to_floor.min() < 0.7
    # nothing but the surface's light differs
    assert (physical.scattering == printed.scattering).all()
    assert (physical.depth == printed.depth).all()


@pytest.mark.parametrize("sigma_t", [GREY, COLOURED], ids=["grey", "coloured"])
def test_a_slab_under_the_sun(sigma_t: str, draw, tmp_path: Path) -> None:
    scene = slab_scene(tmp_path, VIEWS["from above"], sigma_t)
    slant = -scene.lights[0].direction[1]
    # all of the slab lies between the sun and the floor below it
    light_leg = np.exp(-np.broadcast_to(scene.medium.sigma_t, 3) * (TOP + 0.5) / slant)
    exact = slab_surface(scene)
    physical, printed = (draw(scene, **QUICK, composition=name) for name in ("physical", "printed"))
    np.testing.assert_allclose(physical.surface, exact, rtol=1e-4, atol=1e-12)
    np.testing.assert_allclose(printed.surface, exact / light_leg, rtol=1e-4, atol=1e-12)
    assert (physical.scattering == printed.scattering).all()


@pytest.mark.parametrize("composition", ["physical", "printed"])
def test_several_lights_add_up(composition: str, draw, tmp_path: Path) -> None:
    lamps = [LAMP, point(-1, 2, 0), point(0.5, 0.2, 1)]
    scenes = [
        write_scene(tmp_path, lamp, FLOOR_SHAPE, size=(24, 16), eye="0, 1.5, 6") for lamp in ["".join(lamps), *lamps]
    ]
    together, *alone = (draw(scene, **QUICK, composition=composition) for scene in scenes)
    # measured 1.8e-7: the sum's own rounding
    np.testing.assert_allclose(together.surface, sum(frame.surface for frame in alone), rtol=1e-6)


def test_another_composition_is_refused() -> None:
    with pytest.raises(InputError, match="There is no composition 'added'"):
        find_technique("Weng2010", composition="added")
