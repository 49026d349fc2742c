"""Clocks say what they measure and by what; moving frames move. How long anything takes is no test."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from scene_files import point, sphere, spot, write_scene

from gpu_impl.context import GLInfo
from gpu_impl.device import shared_device
from gpu_impl.geometry import bounding_box
from gpu_impl.motion import SWAY, moved
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from gpu_impl.timing import NO_CLOCK, PASSES, TIMER_QUERIES, WALL_CLOCK, PassClock
from scenes.loader import load


class Query:
    """A timer query that has measured what a test says."""

    def __init__(self, elapsed: int) -> None:
        self.elapsed = elapsed

    def __enter__(self) -> None:
        pass

    def __exit__(self, *_: object) -> None:
        pass


class Recorded:
    """An OpenGL that counts how often it was made to finish, and hands out queries of 1, 2, 3, ... ms."""

    def __init__(self, renderer: str) -> None:
        self.info = GLInfo(renderer, "4.5")
        self.context = self
        self.finished = self.queries = 0

    def finish(self) -> None:
        self.finished += 1

    def query(self, time: bool) -> Query:
        self.queries += 1
        return Query(self.queries * 1_000_000)


def test_hardware_is_asked_by_queries_and_never_waited_for() -> None:
    device = Recorded("NVIDIA H100/PCIe/SSE2")
    clock = PassClock(device)
    for name in ("shadow map", "scattering", "shadow map"):
        with clock.time_pass(name):
            pass
    assert clock.method == TIMER_QUERIES
    assert clock.milliseconds() == {"shadow map": 1.0 + 3.0, "scattering": 2.0}
    assert clock.milliseconds() == {}
    assert device.finished == 0
    # the next frame asks the same queries again
    for name in ("geometry", "surface", "scattering"):
        with clock.time_pass(name):
            pass
    assert sorted(clock.milliseconds().values()) == [1.0, 2.0, 3.0]
    assert device.queries == 3


def test_a_software_renderer_is_timed_by_the_wall_clock() -> None:
    device = Recorded("llvmpipe (LLVM 15.0.6, 256 bits)")
    clock = PassClock(device)
    for _ in range(2):
        with clock.time_pass("scattering"):
            time.sleep(0.01)
    assert clock.method == WALL_CLOCK
    (passes,) = clock.milliseconds().items()
    assert passes[0] == "scattering"
    assert passes[1] >= 2 * 10
    # before and after each
    assert (device.finished, device.queries) == (4, 0)


def test_without_a_clock_nothing_finishes() -> None:
    device = Recorded("llvmpipe")
    with NO_CLOCK.time_pass("scattering"):
        pass
    assert (device.finished, device.queries) == (0, 0)


@pytest.mark.parametrize("technique", ["lit_intervals+quadrature", "uniform_march+riemann"])
def test_the_passes_of_a_frame_add_up_within_it(technique: str, tmp_path) -> None:
    scene = write_scene(
        tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), emitters=point(0, 3, 0) + point(1, 2, 0), size=(48, 48)
    )
    chosen = find_technique(technique, steps=4, shadow_map=32)
    with Renderer(scene) as renderer:
        renderer.frame_time(chosen, 0)
        clock = PassClock(renderer.device)
        whole = renderer.frame_time(chosen, 1, clock)
        passes = clock.milliseconds()
        # a clock is told of one frame, and not of the next
        renderer.frame_time(chosen, 2)
        assert clock.milliseconds() == {}
    expected = set(PASSES) if technique.startswith("lit") else set(PASSES) - {"shadow polygons"}
    assert set(passes) == expected
    assert all(time > 0 for time in passes.values())
    assert sum(passes.values()) <= whole


def test_a_timed_frame_leaves_the_renderer_as_it_was(draw) -> None:
    scene = load("sphere", size=(16, 16))
    technique = find_technique("uniform_march+riemann", steps=4, shadow_map=16)
    with Renderer(scene) as renderer:
        before = renderer.render(technique).composite
        renderer.frame_time(technique, 3, PassClock(shared_device()))
        assert renderer.scene is scene
        # the pictures of a renderer that has drawn moving frames are those of one that has not
        other = find_technique("uniform_march+riemann", steps=4, shadow_map=17)
        np.testing.assert_array_equal(
            renderer.render(other).composite, draw(scene, other.name, steps=4, shadow_map=17).composite
        )
        np.testing.assert_array_equal(renderer.render(technique).composite, before)


def test_the_eye_and_the_lights_turn_about_the_middle(tmp_path) -> None:
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), emitters=point(0, 3, 0), size=(8, 8))
    bounds = bounding_box(scene)
    middle = bounds.mean(axis=0)
    still = moved(scene, 0, bounds)
    np.testing.assert_array_equal(still.camera.to_world, scene.camera.to_world)
    np.testing.assert_array_equal(still.lights[0].position, scene.lights[0].position)
    up = scene.camera.to_world[:3, 1]
    # the light is overhead, and its arm near the vertical
    arm = scene.lights[0].position - middle
    assert abs(arm @ up) > 0.9 * np.linalg.norm(arm)
    angles = []
    for number in range(1, 6):
        frame = moved(scene, number, bounds)
        for now, before in (
            (frame.camera.origin, scene.camera.origin),
            (frame.lights[0].position, scene.lights[0].position),
        ):
            # as far from the middle as before
            assert np.linalg.norm(now - middle) == pytest.approx(np.linalg.norm(before - middle))
        # the eye as high, and the light turned by the whole angle however it stands
        assert frame.camera.origin @ up == pytest.approx(scene.camera.origin @ up)
        now = frame.lights[0].position - middle
        angle = SWAY * np.sin(number)
        assert np.linalg.norm(now - arm) == pytest.approx(2 * np.sin(abs(angle) / 2) * np.linalg.norm(arm))
        # a rotation
        turn = frame.camera.to_world[:3, :3] @ np.linalg.inv(scene.camera.to_world[:3, :3])
        np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
        # a light's own frame turns with it
        back = frame.lights[0].to_world[:3, :3] @ np.linalg.inv(scene.lights[0].to_world[:3, :3])
        np.testing.assert_allclose(back @ arm, now, atol=1e-12)
        angles.append(float(np.arccos((np.trace(turn) - 1) / 2)))
    assert max(angles) <= SWAY * (1 + 1e-9)
    assert len(set(np.round(angles, 12))) == 5


def test_lights_turn_wherever_they_stand(tmp_path) -> None:
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), emitters=point(0, 3, 0), size=(8, 8))
    bounds = bounding_box(scene)
    middle, angle = bounds.mean(axis=0), SWAY * np.sin(2)
    for axis in scene.camera.to_world[:3, :3].T:
        arm = 3 * axis
        light = replace(scene.lights[0], position=middle + arm)
        (frame,) = moved(replace(scene, lights=(light,)), 2, bounds).lights
        assert np.linalg.norm(frame.position - light.position) == pytest.approx(2 * np.sin(angle / 2) * 3)
        # a directional light's arm is the way that it comes from
        side = np.roll(axis, 1)
        to_world = np.column_stack([side, np.cross(axis, side), axis, np.zeros(3)])
        sun = replace(light, kind="directional", to_world=np.vstack([to_world, [0, 0, 0, 1]]))
        (frame,) = moved(replace(scene, lights=(sun,)), 2, bounds).lights
        assert np.arccos(frame.direction @ sun.direction) == pytest.approx(angle)
    inside = replace(scene.lights[0], position=middle)
    (frame,) = moved(replace(scene, lights=(inside,)), 2, bounds).lights
    np.testing.assert_allclose(frame.position, middle, atol=1e-12)


def test_a_spot_turns_with_its_frame(tmp_path) -> None:
    scene = write_scene(tmp_path, emitters=spot("0.3, 3.5, 0", "0, 0, 0", 24, 20), size=(8, 8))
    bounds = bounding_box(scene)
    (before,), (light,) = scene.lights, moved(scene, 2, bounds).lights
    np.testing.assert_allclose(light.position, light.to_world[:3, 3], atol=1e-12)
    # its axis still points at the middle, which it turned about
    aim = bounds.mean(axis=0) - light.position
    np.testing.assert_allclose(np.cross(light.direction, aim), 0, atol=1e-6)
    assert np.linalg.norm(light.position - before.position) > 1e-3
