"""The share of the way to a light over which its light is attenuated, where the medium is bounded: in closed form.

It is how the reference imitates `volpath`, which stops short of the light (reference/agreement/volpath.py).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scene_files import point

from reference.estimators import Equiangular
from scenes.loader import load
from scenes.model import Scene

SIGMA_T, FLOOR = 0.8, -0.9


def box_of_fog(folder: Path, lamp: float) -> Scene:
    """The box [-1, 1]^3 with a floor inside, a lamp at height `lamp`, and the eye in the box, looking down."""
    path = folder / "scene.xml"
    path.write_text(
        f"""<scene version='3.0.0'>
          <medium type='homogeneous' id='fog'><float name='sigma_t' value='{SIGMA_T}'/></medium>
          <shape type='cube'><bsdf type='null'/><ref name='interior' id='fog'/></shape>
          <shape type='rectangle'><transform name='to_world'><scale value='0.9'/><rotate x='1' angle='-90'/>
            <translate y='{FLOOR}'/></transform></shape>
          {point(0.2, lamp, -0.3)}
          <sensor type='perspective'><float name='fov' value='40'/><float name='far_clip' value='20'/>
            <transform name='to_world'><lookat origin='0, 0.8, 0' target='0, -1, 0' up='0, 0, 1'/></transform>
            <film type='hdrfilm'/><ref id='fog'/></sensor></scene>"""
    )
    return load(path, size=(8, 8))


@pytest.mark.parametrize("lamp", [0.5, 3.0], ids=["inside", "outside"])
@pytest.mark.parametrize("share", [0.0, 0.2, 0.7, 1.0])
def test_light_is_attenuated_over_its_share_of_the_way(lamp: float, share: float, tmp_path: Path) -> None:
    scene = box_of_fog(tmp_path, lamp)
    (light,) = scene.lights
    origin, direction, _ = scene.camera.rays()
    t = (FLOOR - origin[..., 1]) / direction[..., 1]
    to_lamp = light.position - (origin + t[..., None] * direction)
    d = np.linalg.norm(to_lamp, axis=-1)
    # the last of the way to a lamp above the box is outside it
    leg = np.minimum(share, (1 - FLOOR) / (lamp - FLOOR)) * d
    # diffuse of 0.5 under the cosine and the square of the distance
    exact = 0.5 / np.pi * 10 * (to_lamp[..., 1] / d) / d**2 * np.exp(-SIGMA_T * (t + leg))
    surface = Equiangular(scene, light_share=share).fixed()["surface"]
    np.testing.assert_allclose(surface, np.repeat(exact[..., None], 3, axis=-1), rtol=1e-5)
