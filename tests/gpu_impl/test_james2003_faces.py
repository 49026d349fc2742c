"""Which faces of shadow volumes are drawn, and in which order."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from obj_meshes import obj
from scene_files import point, sphere, write_scene
from signed_pieces import BODY_OF_FOG, CUBE, SUN, lit_lengths

from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique

LIGHT = point(0.3, 2.6, 0)
# half its side, turned by an angle around x, at a height before the eye
SHEET = (
    "<shape type='rectangle'><transform name='to_world'><scale x='{0}' y='{0}'/><rotate x='1' angle='{1}'/>"
    "<translate x='0.1' y='{2}' z='3'/></transform></shape>"
)
# light, shapes and near plane, of an eye at z = 5 that looks along -z
CUT_AWAY = {
    "a ball around the eye": (LIGHT, sphere(0, 0, 5, 1), 1.5),
    "a ball around the eye, a light before it": (point(0.1, 0.2, 0), sphere(0, 0, 5, 1), 1.5),
    "a ball before the eye": (LIGHT, sphere(0, 0.1, 3.5, 0.4), 2.5),
    "half a ball": (LIGHT, sphere(0.1, 0.1, 3, 0.6), 2),
    "half a cube": (LIGHT, CUBE.format(0.5, 0.1, 0.1, 3), 2),
    "a cube around eye and lamp": (point(0.1, 0.2, 4.3), CUBE.format(0.6, 0.1, 0.1, 4.5), 0.3),
    "a sheet's front": (LIGHT, SHEET.format(0.4, 40, 0), 3.5),
    "a sheet's back": (LIGHT, SHEET.format(0.4, -130, 0.2), 3.5),
    "half a sheet": (LIGHT, SHEET.format(0.6, 70, 0.1), 2),
    "a sheet from behind the eye": (LIGHT, SHEET.format(2.5, 90, 0.3), 1.5),
    "two sheets": (LIGHT, SHEET.format(0.4, 40, 0) + SHEET.format(0.5, 60, 0.4), 3.5),
    "under the sun": (SUN, BODY_OF_FOG + SHEET.format(0.4, 40, 0) + sphere(0, 0, 4.2, 0.3), 3.5),
}


def unlike_rays(light: str, shapes: str, folder: Path, near: float = 0.01, eye: str = "0, 0, 5") -> int:
    """How many of 1,280 rays are lit for another length than the reference finds."""
    ours, truth = lit_lengths(write_scene(folder, light, shapes, size=(40, 32), near=near, eye=eye))
    return int((np.abs(ours - truth) > 1e-4 * max(truth.max(), 1)).sum())


@pytest.mark.parametrize("name", CUT_AWAY)
def test_what_the_near_plane_cuts_away_casts_its_shadow(name: str, tmp_path: Path) -> None:
    """The eye's volumes are counted at the eye; what rays pass on their way to the near plane counts too."""
    light, shapes, near = CUT_AWAY[name]
    # a ray that grazes an edge is of either side; measured: 0
    assert unlike_rays(light, shapes, tmp_path, near) <= 2


@pytest.mark.parametrize("middle", ["an edge", "a corner"])
def test_an_eye_right_below_an_edge_is_in_one_volume(middle: str, tmp_path: Path) -> None:
    """The way to the light meets the edge, which is nobody's without the turn that makes it somebody's."""
    corners = [(-0.75, 2, 3.25), (0.75, 2, 3.25), (0.75, 2, 4.75), (-0.75, 2, 4.75)]
    # two triangles with the diagonal through the way, or four around it
    faces = [(0, 1, 2), (0, 2, 3)] if middle == "an edge" else [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    mesh = obj(tmp_path, "sheet", [*corners, (0, 2, 4)], faces)
    # measured: 0
    assert unlike_rays(point(0, 4, 4), mesh, tmp_path, eye="0, 0, 4") <= 2


def test_one_picture_however_often_it_is_drawn(tmp_path: Path) -> None:
    """48,000 faces are added up in one order; in that in which invocations happen to end, 5 of 8 pairs were unlike."""
    generator, count = np.random.default_rng(8), 16_000
    middles = generator.uniform((-1.5, 0.5, -1), (1.5, 1.5, 1), (count, 1, 3))
    vertices = (middles + generator.normal(0, 0.01, (count, 3, 3))).reshape(-1, 3).tolist()
    mesh = obj(tmp_path, "splinters", vertices, np.arange(3 * count).reshape(-1, 3).tolist())
    with Renderer(write_scene(tmp_path, LIGHT, mesh, size=(24, 24))) as renderer:
        frames = [renderer.render(find_technique("James2003", shadow_map=16)) for _ in range(8)]
    # measured: 179 faces behind a pixel
    assert np.median(frames[0].lit_intervals) > 100
    for frame in frames[1:]:
        np.testing.assert_array_equal(frame.scattering, frames[0].scattering)
