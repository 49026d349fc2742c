"""A turned camera: what it looks at stays, both renderers agree on where it is, and its reference is another one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from reference.mitsuba_scene import instantiate
from scenes.loader import load
from scenes.orbit import orbit_to_world, orbited

SIZE = (16, 12)


@pytest.mark.parametrize("name", ["sphere", "slit", "empty"])
def test_the_eye_turns_about_what_it_looks_at(name: str) -> None:
    scene = load(name, SIZE)
    turned = orbit_to_world(scene, 90.0)
    before = scene.camera.to_world
    # a rigid motion about the camera's vertical
    np.testing.assert_allclose(turned[:3, :3].T @ turned[:3, :3], np.eye(3), atol=1e-12)
    np.testing.assert_allclose(turned[:3, 1], before[:3, 1], atol=1e-12)
    # to the right, which is the camera's own -x, and then it looks to the left
    step = turned[:3, 3] - before[:3, 3]
    assert step @ -before[:3, 0] > 0
    np.testing.assert_allclose(turned[:3, 2], before[:3, 0], atol=1e-12)
    # both viewing axes meet where the turn is about, equally far from both eyes
    distance = step @ -before[:3, 0]
    np.testing.assert_allclose(
        before[:3, 3] + distance * before[:3, 2], turned[:3, 3] + distance * turned[:3, 2], atol=1e-6
    )


def test_what_lies_behind_the_eye_is_not_turned_about() -> None:
    scene = load("sphere", SIZE)
    away = scene.camera.to_world.copy()
    # its meshes are behind it now
    away[:3, 0] *= -1
    away[:3, 2] *= -1
    camera = replace(scene.camera, to_world=away, near=0.5)
    turned = orbit_to_world(replace(scene, camera=camera), 90.0)
    # about the near plane's middle
    np.testing.assert_allclose(turned[:3, 3], away[:3, 3] + 0.5 * away[:3, 2] - 0.5 * away[:3, 0], atol=1e-12)
    np.testing.assert_allclose(turned[:3, 2], away[:3, 0], atol=1e-12)


def test_nothing_but_the_camera_changes() -> None:
    scene = load("sphere", SIZE, phase="hg", g=0.6)
    turned = orbited(scene, 3.0)
    assert orbited(scene, 0.0) is scene
    assert turned.parameters == scene.parameters
    assert turned.phase.name == "hg"
    np.testing.assert_array_equal(turned.meshes[0].vertices, scene.meshes[0].vertices)
    # another picture has another name in the cache, and the same turn the same
    assert turned.digest != scene.digest
    assert turned.digest == orbited(scene, 3.0).digest
    assert turned.digest != orbited(scene, 3.001).digest


def test_mitsuba_looks_from_the_same_place() -> None:
    turned = orbited(load("donut_dragon", SIZE), -20.0)
    sensor = instantiate(turned).sensor
    to_world = np.array(sensor.world_transform().matrix).reshape(4, 4)
    np.testing.assert_allclose(to_world, turned.camera.to_world, atol=1e-5)


def test_a_renderer_that_looks_again_draws_what_a_new_one_draws() -> None:
    scene = load("sphere", SIZE)
    turned, technique = orbited(scene, 10.0), find_technique("lit_intervals+quadrature")
    with Renderer(scene) as renderer:
        first = renderer.render(technique)
        renderer.look(turned)
        second = renderer.render(technique)
        renderer.look(scene)
        third = renderer.render(technique)
    with Renderer(turned) as renderer:
        alone = renderer.render(technique)
    np.testing.assert_array_equal(second.scattering, alone.scattering)
    np.testing.assert_array_equal(second.depth, alone.depth)
    np.testing.assert_array_equal(third.scattering, first.scattering)
    assert second.scene_digest == turned.digest
    assert np.abs(second.scattering - first.scattering).max() > 0.01 * first.scattering.max()
