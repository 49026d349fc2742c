"""Thick fog in a box, lit by a lamp outside it: the quadrature has to split what it cannot take at once."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scene_files import point

from scenes.loader import load
from scenes.model import Scene

QUADRATURE = "lit_intervals+quadrature"
LAMP = np.array([0.3, 2.5, -0.2])


def box_of_fog(folder: Path, sigma_t: str) -> Scene:
    """The box [-1, 1]^3 under a lamp, seen obliquely from outside; every way to the lamp leaves through its top."""
    path = folder / "scene.xml"
    path.write_text(
        f"""<scene version='3.0.0'>
          <medium type='homogeneous' id='fog'>{sigma_t}<float name='albedo' value='0.9'/></medium>
          <shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/></shape>
          {point(*LAMP)}
          <sensor type='perspective'><float name='fov' value='30'/><float name='far_clip' value='40'/>
            <transform name='to_world'><lookat origin='1, 2.2, 4' target='0, 0, 0' up='0, 1, 0'/></transform>
            <film type='hdrfilm'/></sensor></scene>"""
    )
    return load(path, size=(12, 9))


def by_small_steps(scene: Scene, steps: int = 1500) -> np.ndarray:
    """Airlight, (H, W, 3), in float64 by the midpoint rule, in steps that grow from where the ray enters."""
    origin, direction, _ = scene.camera.rays()
    with np.errstate(divide="ignore"):
        one, other = (-1 - origin) / direction, (1 - origin) / direction
    begin, end = np.minimum(one, other).max(-1), np.maximum(one, other).min(-1)
    length = np.maximum(end - begin, 0)
    total = np.zeros((*length.shape, 3))
    for u in (np.arange(steps) + 0.5) / steps:
        along, dt = length * u**3, length * 3 * u**2 / steps
        to_lamp = LAMP - (origin + (begin + along)[..., None] * direction)
        d = np.linalg.norm(to_lamp, axis=-1)
        # heights above the point: the top's and the lamp's
        leg = d * np.clip((to_lamp[..., 1] - (LAMP[1] - 1)) / to_lamp[..., 1], 0, 1)
        total += (dt / d**2)[..., None] * np.exp(-np.multiply.outer(along + leg, np.ones(3) * scene.medium.sigma_t))
    (light,) = scene.lights
    return total / (4 * np.pi) * light.intensity * scene.medium.sigma_s


@pytest.mark.parametrize(
    "sigma_t",
    [
        "<rgb name='sigma_t' value='0.01, 0.3, 1'/><float name='scale' value='400'/>",
        "<float name='sigma_t' value='40'/>",
    ],
    ids=["coloured", "grey"],
)
def test_thick_fog_under_a_lamp_outside_it(sigma_t: str, draw, tmp_path: Path) -> None:
    scene = box_of_fog(tmp_path, sigma_t)
    exact = by_small_steps(scene)
    frame = draw(scene, QUADRATURE)
    error = np.abs(frame.scattering - exact) / exact.max((0, 1))
    assert (exact > 0).mean() > 0.3
    # measured 2.0e-5, of the channel that takes a part for what others need fifty for; one set of nodes for all of
    # the blue is off by a third
    assert error.max() < 5e-5
