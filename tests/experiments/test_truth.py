"""The frames of a camera's path are where their angles say, and a reference is of the picture that is asked for."""

from __future__ import annotations

import numpy as np
import pytest

from experiments.run import truth
from experiments.run.truth import KEPT, Truth
from experiments.suite.schema import CameraChoice, ReferenceChoice
from scenes.loader import load
from scenes.model import Scene
from scenes.orbit import orbited

SIZE = (8, 6)
DETERMINISTIC = ReferenceChoice(deterministic=True)


@pytest.mark.parametrize("orbit", [0.0, 30.0])
@pytest.mark.parametrize("name", ["sphere", "slit"])
def test_a_path_goes_on_from_where_it_begins(name: str, orbit: float) -> None:
    own, camera = load(name, SIZE), CameraChoice(orbit=orbit, frames=3, step=-5.0)
    first = orbited(own, orbit)
    scenes = list(Truth().path(first, camera))
    assert scenes[0] is first
    for scene, angle in zip(scenes, (orbit, orbit - 5.0, orbit - 10.0), strict=True):
        expected = orbited(own, angle).camera.to_world
        # measured: 8.9e-16
        np.testing.assert_allclose(scene.camera.to_world, expected, atol=1e-12)


def test_a_path_is_kept_for_the_next_technique_and_is_of_its_own_scene() -> None:
    scene, kept, camera = load("sphere", SIZE), Truth(), CameraChoice(frames=2, step=5.0)

    def second(of: Scene, camera: CameraChoice) -> Scene:
        return list(kept.path(of, camera))[1]

    found = second(scene, camera)
    assert second(scene, camera) is found
    assert second(load("slit", SIZE), camera).name == "slit"
    assert second(load("sphere", (16, 12)), camera).camera.width == 16
    assert second(scene, CameraChoice(frames=2, step=6.0)).digest != found.digest


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[Scene]:
    """The scenes whose references were computed; they themselves stand for these, which would take seconds."""
    found: list[Scene] = []

    def compute(scene: Scene, *choice: object) -> Scene:
        found.append(scene)
        return scene

    monkeypatch.setattr(truth, "deterministic_reference", compute)
    monkeypatch.setattr(truth, "estimate_reference", compute)
    return found


def test_a_reference_is_of_the_picture_that_is_asked_for(computed: list[Scene]) -> None:
    kept, scenes = Truth(), [load("sphere", SIZE), load("sphere", (16, 12)), load("slit", SIZE)]
    for _ in range(2):
        for scene in scenes:
            assert kept.reference(scene, DETERMINISTIC) is scene
    # each once
    assert computed == scenes
    # with other demands it is another one
    kept.reference(scenes[0], ReferenceChoice(rel_error=0.01))
    kept.reference(scenes[0], ReferenceChoice(rel_error=0.02))
    assert len(computed) == 5


def test_only_the_last_references_are_kept(computed: list[Scene]) -> None:
    kept, scene = Truth(), load("sphere", SIZE)
    choices = [ReferenceChoice(rel_error=0.001 * (number + 1)) for number in range(KEPT + 1)]
    for choice in choices:
        kept.reference(scene, choice)
    kept.reference(scene, choices[-1])
    assert len(computed) == KEPT + 1
    kept.reference(scene, choices[0])
    assert len(computed) == KEPT + 2
