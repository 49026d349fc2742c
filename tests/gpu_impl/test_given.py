"""Lit intervals that are handed in are drawn as they are, and sampled where a shadow map would be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles import piece_airlight
from scene_files import point, sphere, spot, write_scene

from gpu_impl.given import Found
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from reference.deterministic.ray_spans import Rays
from scenes.errors import InputError
from scenes.model import Array, Scene

# of each ray [scene unit]; a ray is 26 long
BEGIN, END = (1.0, 3.5), (2.0, 5.25)
SIZE = (10, 8)


def two_pieces(scene: Scene, number: int, positions: Array, ends: Array) -> Found:
    """Two intervals a ray, of the second light the later one alone."""
    rays = positions[..., 0].size
    begin, end = ((part[number:]) for part in (BEGIN, END))
    offsets = len(begin) * np.arange(rays + 1)
    return Found(offsets, np.tile(begin, rays).astype(float), np.tile(end, rays).astype(float))


def expected(scene: Scene) -> np.ndarray:
    """The same in float64."""
    full = np.ones((scene.camera.height, scene.camera.width))
    return sum(
        piece_airlight(scene, light, begin * full, end * full)
        for number, light in enumerate(scene.lights)
        for begin, end in zip(BEGIN[number:], END[number:], strict=True)
    )


@pytest.fixture
def scene(tmp_path) -> Scene:
    return write_scene(tmp_path, emitters=point(1, 2, 1) + point(-2, 0.5, 2), size=SIZE)


def scattering(scene: Scene, name: str, **settings: object) -> np.ndarray:
    with Renderer(scene, find_lit=two_pieces) as renderer:
        return renderer.render(find_technique(name, **settings)).scattering


def test_given_intervals_are_drawn_as_they_are(scene: Scene) -> None:
    found = scattering(scene, "given+quadrature")
    # measured: 3e-7
    np.testing.assert_allclose(found, expected(scene), rtol=2e-6)


def test_a_march_that_asks_given_intervals_converges_to_them(scene: Scene) -> None:
    errors = []
    for steps in (256, 4096):
        found = scattering(scene, "uniform_march+riemann", steps=steps, shadow_source="rays")
        errors.append(np.abs(found / expected(scene) - 1).mean())
    # the ends of pieces are off by half of a step, which is 0.1 and 0.006 long. Measured: 2.5e-2, 1.6e-3
    assert errors[1] < 5e-3
    assert errors[1] < errors[0] / 4


def whole_ray(scene: Scene, number: int, positions: Array, ends: Array) -> Found:
    """All of the ray as far as OpenGL sees, from its beginning on."""
    return Found(np.arange(ends.size + 1), np.zeros(ends.size), ends.ravel())


def test_nothing_hides_the_light_outside_a_spots_cone(tmp_path: Path) -> None:
    scene = write_scene(tmp_path, emitters=spot("1, 2, 1", "0, 0, 0", 25, 25), size=SIZE)

    def inside_the_cone(scene: Scene, number: int, positions: Array, ends: Array) -> Found:
        begin, end = Rays.of_camera(scene, ends.ravel(), positions).reached_by(scene.lights[number])
        lit = end > begin
        return Found(np.concatenate([[0], np.cumsum(lit)]), begin[lit], end[lit])

    # a step that is half outside has its middle there, and the driver cuts it at the cone by itself
    with Renderer(scene, find_lit=inside_the_cone) as renderer:
        given = renderer.render(find_technique("given+quadrature")).scattering
        march = find_technique("uniform_march+quadrature", steps=16, shadow_source="rays")
        found = renderer.render(march).scattering
    assert given.max() > 0
    # measured: 8e-7
    np.testing.assert_allclose(found, given, atol=3e-6 * given.max())


def test_given_intervals_begin_where_the_cameras_ray_does(tmp_path: Path) -> None:
    # the fog does not: the eye is outside it
    box = (
        "<shape type='cube'><transform name='to_world'><scale value='1.5'/></transform><bsdf type='null'/>"
        "<ref name='interior' id='fog'/></shape>"
    )
    scene = write_scene(tmp_path, emitters=point(0.3, 0.6, 0.2), shapes=box, size=SIZE, inside=False)

    def later_half(scene: Scene, number: int, positions: Array, ends: Array) -> Found:
        rays = Rays.of_camera(scene, ends.ravel(), positions)
        middle = 0.5 * (rays.fog_begin + rays.fog_end)
        lit = rays.fog_end > middle
        return Found(np.concatenate([[0], np.cumsum(lit)]), middle[lit], rays.fog_end[lit])

    t_max = scene.camera.rays()[2]
    rays = Rays.of_camera(scene, t_max.ravel())
    begin, end = (part.reshape(t_max.shape) for part in (rays.fog_begin, rays.fog_end))
    # the way through clear air takes nothing away
    truth = piece_airlight(scene, scene.lights[0], 0.5 * (begin + end), end)
    truth *= np.exp(begin[..., None] * scene.medium.sigma_t)
    assert (begin[truth[..., 0] > 0] > 3).all()
    with Renderer(scene, find_lit=later_half) as renderer:
        found = renderer.render(find_technique("given+quadrature")).scattering
        march = find_technique("uniform_march+quadrature", steps=64, shadow_source="rays")
        marched = renderer.render(march).scattering
    # measured: 6e-7
    np.testing.assert_allclose(found, truth, atol=3e-6 * truth.max())
    # the middle of the ray is the end of a step; measured: 3e-7
    np.testing.assert_allclose(marched, truth, atol=3e-6 * truth.max())


def test_the_finder_is_told_where_rays_end(tmp_path: Path) -> None:
    # the whole rays, each as far as the eye sees
    scene = write_scene(tmp_path, shapes=sphere(0, 0, 0, 1), size=SIZE)
    with Renderer(scene, find_lit=whole_ray) as renderer:
        given = renderer.render(find_technique("given+quadrature"))
    truth = piece_airlight(scene, scene.lights[0], 0 * given.depth, given.depth)
    # measured: 7e-7
    np.testing.assert_allclose(given.scattering, truth, rtol=3e-6)


def test_the_map_is_asked_where_rays_are_not(scene: Scene) -> None:
    # nothing stands in the light, so that the map has no shadow
    lit = scattering(scene, "lit_intervals:unbounded+quadrature", steps=64)
    assert (lit > 1.5 * expected(scene)).all()


@pytest.mark.parametrize("downsample", [2, 4])
def test_each_cell_of_the_lattice_has_its_own_intervals(scene: Scene, downsample: int) -> None:
    asked = []

    def one_lit_column(scene: Scene, number: int, positions: Array, ends: Array) -> Found:
        asked.append(positions)
        lit = (np.arange(positions.shape[1]) == 1) & np.ones(positions.shape[:2], bool)
        offsets = np.concatenate([[0], np.cumsum(lit.ravel())])
        return Found(offsets, np.full(lit.sum(), 1.0), np.full(lit.sum(), 2.0))

    technique = find_technique("given+quadrature", downsample=downsample)
    with Renderer(scene, find_lit=one_lit_column) as renderer:
        pieces = renderer.record(technique)
        # the same eye, lattice and light: they are asked for once
        renderer.render(technique)
    assert len(asked) == len(scene.lights)
    columns = -(-SIZE[0] // downsample)
    assert set(pieces[0].cell % columns) == {1}
    # every N-th pixel's centre
    np.testing.assert_array_equal(np.diff(asked[0], axis=1)[..., 0], downsample)
    np.testing.assert_array_equal(asked[0] % 1, 0.5)


def test_another_eye_has_other_intervals(scene: Scene) -> None:
    eyes = []

    def nothing_lit(scene: Scene, number: int, positions: Array, ends: Array) -> Found:
        eyes.append(scene)
        return Found(np.zeros(positions[..., 0].size + 1, int), np.zeros(0), np.zeros(0))

    other = write_scene(scene.path.parent / "..", emitters=point(1, 2, 1), size=SIZE, eye="0, 1, 6")
    technique = find_technique("given+riemann")
    with Renderer(scene, find_lit=nothing_lit) as renderer:
        assert renderer.render(technique).scattering.max() == 0
        renderer.look(other)
        renderer.render(technique)
    assert eyes == [*[scene] * len(scene.lights), other]


def test_a_renderer_that_casts_no_rays_says_who_does(scene: Scene) -> None:
    with Renderer(scene) as renderer, pytest.raises(InputError, match="airlight render"):
        renderer.render(find_technique("given+quadrature"))


def test_a_control_has_no_time(scene: Scene) -> None:
    with Renderer(scene, find_lit=two_pieces) as renderer:
        for technique, source in (("given+quadrature", "map"), ("uniform_march+riemann", "rays")):
            with pytest.raises(InputError, match="time means nothing"):
                renderer.milliseconds(find_technique(technique, shadow_source=source))
    # what knows the answer without asking about points is asked nothing
    with pytest.raises(InputError, match="does not ask about points"):
        find_technique("given+quadrature", shadow_source="rays")
