"""The plane of a ray and its light, against trimesh's sections, Mitsuba's ray casting and OpenGL's shadow polygons."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from experiments.figures import choices, stage
from experiments.figures.plane import RayPlane
from experiments.figures.rays import SAMPLES, RayField
from experiments.figures.shadow_region import region_of_fan
from experiments.figures.stage import Stage
from scenes.loader import load

SIDE = 64


@pytest.fixture(scope="module")
def drawn() -> Stage:
    with pytest.MonkeyPatch.context() as patch, Stage((SIDE, SIDE)) as made:
        patch.setattr(stage, "FIELD_SIDE", SIDE)
        for scene in ("donut_dragon", "light_behind_eye"):
            made.field(scene)
        yield made


def test_cuts_are_those_of_trimesh() -> None:
    scene = load("donut_dragon", size=(8, 8))
    origin, direction, _ = scene.camera.rays()
    light = scene.lights[0]
    plane = RayPlane.of_ray(scene, light, origin[5, 5], direction[5, 5])
    normal = np.cross(direction[5, 5], light.position - origin[5, 5])
    length = 0.0
    for mesh in scene.meshes:
        whole = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        pieces = trimesh.intersections.mesh_plane(whole, normal / np.linalg.norm(normal), origin[5, 5])
        length += np.linalg.norm(np.diff(pieces, axis=1), axis=-1).sum()
    # measured: 4e-16
    assert np.linalg.norm(np.diff(plane.cuts, axis=1), axis=-1).sum() == pytest.approx(length, rel=1e-12)
    # the plane keeps distances
    to_light = light.position - origin[5, 5]
    assert np.linalg.norm(plane.light) == pytest.approx(np.linalg.norm(to_light), rel=1e-12)


@pytest.mark.parametrize("scene", ["donut_dragon", "light_behind_eye"])
def test_the_plane_sees_what_ray_casting_finds_lit(drawn: Stage, scene: str) -> None:
    field = drawn.field(scene)
    rng = np.random.default_rng(4)
    counts = np.bincount(field.intervals.pixel, minlength=SIDE * SIDE)
    for pixel in rng.choice(np.flatnonzero(counts > 1), 12, replace=False):
        ray = field.ray(int(pixel))
        at = rng.uniform(0, ray.end, 200)
        # an interval's end is known to float32, so places beside one may be on either side
        at = at[np.abs(at[:, None] - ray.lit.ravel()).min(axis=1) > 1e-3]
        is_lit = ((at[:, None] > ray.lit[:, 0]) & (at[:, None] < ray.lit[:, 1])).any(axis=1)
        np.testing.assert_array_equal(ray.plane.sees(np.column_stack([at, np.zeros(len(at))])), is_lit)
        # measured: 1.3e-14
        assert ray.reached[0] <= ray.lit[0, 0] + 1e-11
        assert ray.reached[1] >= ray.lit[-1, 1] - 1e-11


def test_front_and_final_distance_are_the_ends_of_the_shadows(drawn: Stage) -> None:
    for ray in (choices.two_shadows(drawn), choices.one_shadow(drawn)):
        # measured: 1.9e-5, float32 at a distance of ten
        assert ray.front == pytest.approx(ray.dark[0, 0], abs=2e-4)
        assert ray.final == pytest.approx(ray.dark[-1, 1], abs=2e-4)
        assert ray.samples[0] - ray.front == pytest.approx(ray.final - ray.samples[-1])
        is_lit = ((ray.samples[:, None] > ray.lit[:, 0]) & (ray.samples[:, None] < ray.lit[:, 1])).any(axis=1)
        np.testing.assert_array_equal(ray.is_lit, is_lit)
        assert len(is_lit) == SAMPLES


def test_shadow_lines_cross_the_ray_where_light_ends(drawn: Stage) -> None:
    ray = choices.two_shadows(drawn)
    lines = ray.plane.shadow_lines(100.0)
    crossing = lines[lines[:, 0, 1] * lines[:, 1, 1] < 0]
    share = crossing[:, 0, 1] / (crossing[:, 0, 1] - crossing[:, 1, 1])
    at = np.sort(crossing[:, 0, 0] + share * (crossing[:, 1, 0] - crossing[:, 0, 0]))
    # measured: 1.2e-6
    np.testing.assert_allclose(at, ray.dark.ravel(), atol=1e-5)


def test_the_fan_has_the_rays_own_region(drawn: Stage) -> None:
    ray = choices.two_shadows(drawn)
    begin, end = region_of_fan(ray, 100.0)
    # of the fan's ray that is nearest to the drawn one
    nearest = np.argmin(np.abs(begin[:, 1] / begin[:, 0]))
    # measured: 1.5e-3, by the angle between the two
    assert begin[nearest, 0] == pytest.approx(ray.front, abs=5e-3)
    assert end[nearest, 0] == pytest.approx(ray.final, abs=5e-3)


def test_a_chosen_ray_is_of_the_wanted_kind(drawn: Stage) -> None:
    assert len(choices.two_shadows(drawn).lit) == 3
    passing = choices.one_shadow(drawn)
    assert len(passing.lit) == 2
    assert 0 < passing.x_h < passing.end
    clear = choices.no_shadow(drawn)
    assert len(clear.lit) == 1
    assert clear.front == np.inf
    # measured: 2.9e-6
    np.testing.assert_allclose(clear.lit[0], clear.reached, atol=3e-5)
    assert choices.projection_before_the_eye(drawn).x_h < 0


def test_no_ray_will_do(drawn: Stage) -> None:
    with pytest.raises(ValueError, match="scene must have a ray"):
        drawn.field("donut_dragon").best(lambda field, pixel: -np.inf)


def test_a_light_on_the_ray_has_no_plane() -> None:
    scene = load("sphere", size=(8, 8))
    direction = np.array([0.0, 0.0, 1.0])
    with pytest.raises(ValueError, match="light must lie beside the ray"):
        RayPlane.of_ray(scene, scene.lights[0], scene.lights[0].position - 2 * direction, direction)


def test_the_field_says_where_rays_pass_the_light(drawn: Stage) -> None:
    field: RayField = drawn.field("donut_dragon")
    for pixel in (0, 1000, SIDE * SIDE - 1):
        assert field.x_h[pixel] == pytest.approx(field.ray(pixel).x_h, rel=1e-12)
