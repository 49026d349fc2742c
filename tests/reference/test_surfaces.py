"""Direct light on surfaces against float64: a sphere and its shadow, and a shadow next to what casts it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from oracles import SphereScene
from scene_files import point, sphere, write_scene

from reference.estimators import Equiangular
from scenes.loader import load


def test_surfaces() -> None:
    scene = load("sphere", size=(64, 64))
    truth = SphereScene(scene).surface()
    surface = Equiangular(scene).fixed()["surface"]
    # a pixel at a shadow's very edge may fall to either side; measured: none does
    assert ((surface > 0) != (truth > 0)).any(-1).sum() <= 3
    lit = (surface > 0) & (truth > 0)
    error = np.abs(surface - truth)[lit] / truth[lit]
    # Mitsuba's float32: measured 1.1e-6 at the 99th percentile and 4.2e-5 at the terminator of the sphere
    assert np.quantile(error, 0.99) < 5e-6
    assert error.max() < 2e-4


def test_a_shadow_begins_where_its_ball_touches_the_wall(tmp_path: Path) -> None:
    """What is less than a hundredth of the way to the light away from a point shades it none the less."""
    wall = "<shape type='rectangle'><transform name='to_world'><scale value='9'/></transform></shape>"
    light, centre, radius = np.array([-3, 0, 3]), np.array([0, 0, 0.01]), 0.01
    scene = write_scene(tmp_path, point(*light), wall + sphere(*centre, radius), size=(48, 48), eye="0, 0, 0.1")
    origin, direction, _ = scene.camera.rays()

    def from_centre(origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Distance of the ball's centre from lines."""
        along = ((centre - origin) * direction).sum(-1, keepdims=True)
        return np.linalg.norm(origin + along * direction - centre, axis=-1)

    on_wall = origin - (origin[..., 2:] / direction[..., 2:]) * direction
    to_light = light - on_wall
    passed = from_centre(on_wall, to_light / np.linalg.norm(to_light, axis=-1, keepdims=True)) / radius
    # 4 units away float32 knows the ball's edge to a hundredth of its radius
    judged = (from_centre(origin, direction) > radius) & (np.abs(passed - 1) > 0.02)
    assert (judged & (passed < 1)).sum() > 70
    surface = Equiangular(scene).fixed()["surface"]
    assert ((surface > 0).all(-1) == (passed > 1))[judged].all()
