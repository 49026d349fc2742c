"""Shadows on surfaces, hard and filtered: no surface shades itself, and edges are where and as wide as they should."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scene_files import point, spot, write_scene
from slab import GREY, VIEWS, slab_scene

from gpu_impl.passes import shadow_map
from scenes.loader import load
from scenes.model import Scene

QUICK = {"technique": "uniform_march+riemann", "steps": 1}
FLOOR, LAMP, TEXELS = -1.0, 3.0, 64


def rectangle(transform: str) -> str:
    return (
        f"<shape type='rectangle'><transform name='to_world'>{transform}</transform>"
        "<bsdf type='twosided'><bsdf type='diffuse'/></bsdf></shape>"
    )


GROUND = rectangle(f"<scale value='20'/><rotate x='1' angle='-90'/><translate y='{FLOOR}'/>")
# its edge lies straight below the lamp, and so does its shadow's
PLATE = rectangle("<scale value='20'/><rotate x='1' angle='-90'/><translate x='-20' y='1'/>")
LAMPS = {"cube map": point(0, LAMP, 0), "one tile": spot(f"0, {LAMP}, 0", "0.01, 0, 0", 55, 55)}


def shares(folder: Path, lamp: str, draw, kind: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Share of the light that reaches the floor, x and z there: where it is seen and lit without the plate."""
    scenes = [write_scene(folder, lamp, shapes, (256, 128), eye="0, 0.8, 8") for shapes in (GROUND + PLATE, GROUND)]
    shaded, clear = (draw(scene, **QUICK, shadow_map=TEXELS, surface_shadows=kind).surface[..., 1] for scene in scenes)
    origin, direction, _ = scenes[0].camera.rays()
    distance = (FLOOR - origin[..., 1]) / direction[..., 1]
    place = origin + distance[..., None] * direction
    seen = (distance > 0) & (np.abs(place[..., 2]) < 7) & (np.abs(place[..., 0]) < 2) & (clear > 0)
    return shaded[seen] / clear[seen], place[seen, 0], place[seen, 2]


@pytest.fixture
def maps_along_the_axes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Turn the maps back, so that an edge of the plate runs along a column of texels."""
    back = shadow_map.MAP_FRAME.T
    monkeypatch.setattr(shadow_map, "CUBE_FACES", [(back @ f, back @ up) for f, up in shadow_map.CUBE_FACES])
    monkeypatch.setattr(shadow_map, "MAP_FRAME", np.eye(3))


@pytest.mark.parametrize("lamp", LAMPS)
def test_an_edge_is_a_ramp_of_three_texels(lamp: str, draw, tmp_path: Path, maps_along_the_axes: None) -> None:
    share, x, z = shares(tmp_path, LAMPS[lamp], draw, "soft")
    # a face of the cube sees 90 degrees; a spot's tile a hair more than its cone
    tangent = 1.0 if lamp == "cube map" else 1.01 * np.tan(np.radians(55))
    texel = 2 * tangent * (LAMP - FLOOR) / TEXELS
    # below the lamp, clear of the cube's other faces
    below = np.abs(z) < 2
    middle = np.median((x + 3 * texel * (0.5 - share))[below & (share > 0.01) & (share < 0.99)])
    assert abs(middle) < 0.51 * texel
    ramp = np.clip(0.5 + (x - middle) / (3 * texel), 0, 1)
    # measured 7e-7 under the cube map, and 9e-5 under the spot, whose tile is turned by a hair
    assert np.abs(share - ramp)[below].max() < (5e-6 if lamp == "cube map" else 5e-4)


def test_an_edge_runs_on_across_the_faces_of_the_cube(draw, tmp_path: Path, maps_along_the_axes: None) -> None:
    share, x, z = shares(tmp_path, LAMPS["cube map"], draw, "soft")
    height = LAMP - FLOOR
    assert z.min() < -1.2 * height
    texel = 2 * np.maximum(height, np.abs(z)) / TEXELS
    # a texel of doubt where the edge lies within its texel, and a texel and a half for the filter
    assert (share[x > 2.05 * texel] > 1 - 1e-6).all()
    assert (share[x < -2.05 * texel] == 0).all()
    near = np.abs(np.abs(z) - height) < 0.5
    assert ((share > 0) & (share < 1) & near).sum() > 20
    ramp = np.clip(0.5 + x / (3 * texel), 0, 1)
    # the edge lies between two columns of texels, on the faces before and behind too: measured 8e-7
    assert np.abs(share - ramp).max() < 5e-6


def test_hard_shadows_are_lit_or_not(draw, tmp_path: Path) -> None:
    share, x, _ = shares(tmp_path, LAMPS["cube map"], draw, "hard")
    assert set(np.unique(share)) == {0.0, 1.0}
    texel = 2 * (LAMP - FLOOR) / TEXELS
    assert (share[x > texel] == 1).all()


def tilted(angle: float) -> str:
    return rectangle(f"<scale value='6'/><rotate x='1' angle='-90'/><rotate z='1' angle='{angle}'/><translate y='-1'/>")


@pytest.mark.parametrize("texels", [16, 256])
@pytest.mark.parametrize("angle", [0, 35, 70])
@pytest.mark.parametrize(
    "lamp", [point(-1.5, 0.5, 0.2), point(0, 3, 0), spot("-0.5, 3, 0", "0, 0, 0", 40, 40)], ids=["low", "high", "spot"]
)
def test_no_plane_shades_itself(lamp: str, angle: float, texels: int, draw, tmp_path: Path) -> None:
    scene = write_scene(tmp_path, lamp, tilted(angle), (48, 48))
    soft, hard = (draw(scene, **QUICK, shadow_map=texels, surface_shadows=kind).surface for kind in ("soft", "hard"))
    # a share is the sum of sixteen weights: measured 5e-7
    np.testing.assert_allclose(soft, hard, rtol=2e-6)
    assert (soft > 0).any()


def test_no_floor_shades_itself_under_the_sun(draw, tmp_path: Path) -> None:
    scene = slab_scene(tmp_path, VIEWS["from above"], GREY)
    soft, hard = (draw(scene, **QUICK, shadow_map=64, surface_shadows=kind).surface for kind in ("soft", "hard"))
    np.testing.assert_allclose(soft, hard, rtol=1e-6)


def test_a_curved_surface_keeps_its_light(draw) -> None:
    scene = load("sphere", size=(96, 96))
    soft, hard = (draw(scene, **QUICK, shadow_map=512, surface_shadows=kind).surface for kind in ("soft", "hard"))
    # what one side of the edge loses the other gains: measured -1.4e-4
    assert soft.mean() == pytest.approx(hard.mean(), rel=5e-4)


@pytest.mark.parametrize(("visibility", "shadows"), [("uniform_march", "hard"), ("lit_intervals", "soft")])
def test_a_map_in_a_buffer_gives_the_same_bits(visibility: str, shadows: str, draw, tmp_path: Path) -> None:
    for lamp in (point(0.3, 2.6, 0), spot("0.3, 2.6, 0", "0, 0, 0", 40, 30)):
        scene: Scene = write_scene(tmp_path, lamp, GROUND + tilted(20), (32, 24))
        settings = {"technique": f"{visibility}+riemann", "steps": 16, "shadow_map": 33, "surface_shadows": shadows}
        one, other = (draw(scene, **settings, shadow_storage=storage) for storage in ("texture", "buffer"))
        for name, layer in one.layers.items():
            assert (layer == other.layers[name]).all()
        assert one.surface.max() > 0
