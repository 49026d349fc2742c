"""Shadows by the rectified shadow map, wherever the light is, and at the borders of its rows."""

from __future__ import annotations

import numpy as np
import pytest
from light_places import PLACES, POINTS, SUNS
from rectified_rows import rectified
from scene_files import point, sphere, write_scene

from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes.model import Array, Scene

FLOOR = (
    "<shape type='rectangle'><transform name='to_world'><scale value='20'/><rotate x='1' angle='-90'/>"
    "<translate y='-1.2'/></transform></shape>"
)
OCCLUDERS = sphere(0.5, 0.3, 1, 0.4) + sphere(-0.9, -0.4, -0.5, 0.5) + FLOOR


@pytest.mark.parametrize("name", PLACES)
def test_wherever_the_light_is_shadows_are_those_of_the_map(name: str, tmp_path) -> None:
    """Against samples of the same shadow map along the whole ray."""
    scene = write_scene(tmp_path, emitters=PLACES[name], shapes=OCCLUDERS, size=(32, 32))
    with Renderer(scene) as renderer:
        truth = renderer.render(find_technique("lit_intervals:unbounded+quadrature", steps=512)).scattering
        image = renderer.render(find_technique("min_max+quadrature")).scattering
    # absolute differences over the picture's sum: rows are half a pixel from rays, so that it is the edges of shadows
    # that differ. Measured 4.5e-3 at most (sun in the picture); with the next row in place of the nearest up to 2.5e-2
    assert np.abs(image - truth).sum() < 9e-3 * truth.sum()
    # measured 2.4e-3 (sun in the picture), 1.2e-3 elsewhere
    assert image.sum() == pytest.approx(truth.sum(), rel=5e-3)


def surfaces_end(scene: Scene, positions: Array) -> np.ndarray:
    """Where the rays through `positions` meet the floor of FLOOR or leave the box of `sun`, (h, w)."""
    origin, direction, t_max = scene.camera.rays(positions)
    direction = np.where(direction == 0, 1e-12, direction)
    on_floor = (-1.2 - origin[..., 1]) / direction[..., 1]
    under = np.abs((origin + on_floor[..., None] * direction)[..., [0, 2]]).max(-1) < 20
    end = np.where((on_floor > 0) & under, np.minimum(on_floor, t_max), t_max)
    if scene.boundary is None:
        return end
    return np.minimum(end, ((9 * np.sign(direction) - origin) / direction).min(axis=-1))


@pytest.mark.parametrize("name", POINTS | SUNS)
def test_a_floor_takes_no_light_from_rays_that_end_on_it(name: str, tmp_path) -> None:
    """But for the last column, in rays that lie in a row."""
    scene = write_scene(tmp_path, emitters=PLACES[name], shapes=FLOOR, size=(16, 16))
    lost = []
    for shadow_map in (256, 2048):
        found = rectified(scene, downsample=2, shadow_map=shadow_map)
        pieces, rays = found.pieces, found.t_max.size
        lit = np.bincount(pieces.cell, np.minimum(pieces.t0 + pieces.dt, 1e9) - pieces.t0, rays)
        # a sample's ray ends at the surface of the pixel that it lies in, which may be behind its own
        end = np.minimum(surfaces_end(scene, pieces.positions.astype(np.float64)), found.t_max).ravel()
        lost.append(np.mean(np.maximum(1 - lit / end, 0)))
    # first order, the second map eight times as fine; measured 8.8e-3 to 9.9e-4 (far), 4.8e-3 to 5.4e-4 (behind)
    assert lost[1] < 2e-3
    assert lost[1] < 0.3 * lost[0] or lost[1] < 1e-4


@pytest.mark.parametrize("name", ["spot down", "spot wide", "spot towards the eye"])
def test_columns_reach_the_rim_of_a_cone(name: str, tmp_path) -> None:
    """What stands on the rim, half in the cone, casts its whole shadow."""
    (light,) = write_scene(tmp_path, emitters=PLACES[name]).lights
    aside = np.cross(light.direction, [0, 0, 1] if abs(light.direction[2]) < 0.9 else [0, 1, 0])
    aside /= np.linalg.norm(aside)
    rim = light.position + 1.2 * (np.cos(light.cutoff_angle) * light.direction + np.sin(light.cutoff_angle) * aside)
    images = []
    for shapes in (sphere(*rim, 0.15), ""):
        with Renderer(write_scene(tmp_path, emitters=PLACES[name], shapes=shapes, size=(48, 48))) as renderer:
            images += [
                renderer.render(find_technique(f"{visibility}+quadrature", steps=512)).scattering
                for visibility in ("min_max", "lit_intervals:unbounded")
            ]
    image, truth, _, unshadowed = images
    # of the light that the shadow takes; measured 2.6e-2, 7.0e-2, 4.2e-2
    assert np.abs(image - truth).sum() < 0.1 * (unshadowed - truth).sum()


def test_beyond_the_map_of_parallel_light_all_is_lit(tmp_path) -> None:
    """The map covers what casts shadows and hardly more: in one of four texels a side, all are dark."""
    plate = "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/></transform></shape>"
    scene = write_scene(tmp_path, emitters=SUNS["sun overhead"], shapes=plate, size=(16, 16), eye="0, 3, 5")
    with Renderer(scene) as renderer:
        image, truth = (
            renderer.render(find_technique(f"{visibility}+quadrature", steps=1024, shadow_map=4)).scattering
            for visibility in ("min_max", "lit_intervals:unbounded")
        )
    # measured 4.6e-3: columns of such a map cut its texels askew; without the columns beside the map 0.14
    assert np.abs(image - truth).sum() < 1e-2 * truth.sum()


@pytest.mark.parametrize(("z", "light_is_seen"), [(1, False), (-4, True)])
def test_an_occluder_on_the_axis_hides_the_light_or_stands_behind_it(z: float, light_is_seen: bool, tmp_path) -> None:
    """Next to the axis a column is wide beside its beta; there the axis itself decides."""
    scene = write_scene(tmp_path, emitters=point(0, 0, -2), shapes=sphere(0, 0, z, 0.1), size=(65, 65))
    middle = 32
    for shadow_map in (64, 1024):
        with Renderer(scene) as renderer:
            image, truth = (
                renderer.render(
                    find_technique(f"{visibility}+quadrature", steps=1024, shadow_map=shadow_map)
                ).scattering
                for visibility in ("min_max", "lit_intervals:unbounded")
            )
        # the ray through the light; a column that is taken at its middle lets 6.4e-3 through
        assert (image[middle, middle] > 0).all() == light_is_seen
        off = np.abs(image - truth)
        # measured, around the ball's shadow: 3.9e-3, 2.1e-4; behind the light nothing is in shadow
        assert off.sum() < (1e-2 if shadow_map == 64 else 5e-4) * truth.sum()
