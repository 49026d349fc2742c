"""Each mutation is noticed where it matters, and called idle where it cannot."""

from __future__ import annotations

import numpy as np
import pytest

from reference.agreement.comparison import compare
from reference.agreement.measured import witness
from reference.agreement.witnesses import Witnesses, call_witnesses, estimate_equiangular
from reference.integrator import mi
from reference.mitsuba_scene import instantiate
from reference.mutations import HG, MIRROR, MUTATIONS, MirroredHG, Mutation, is_even, moved_lights, try_mutation
from reference.mutations import _with_hg as with_hg
from scenes.loader import load
from scenes.model import Scene

SIZE = (24, 24)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load("sphere", size=SIZE)


@pytest.fixture(scope="module")
def witnesses(scene: Scene) -> Witnesses:
    return call_witnesses(scene, 2.0)


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.name)
def test_each_is_noticed(mutation: Mutation, scene: Scene, witnesses: Witnesses) -> None:
    outcome = try_mutation(mutation, scene, witnesses)
    assert not outcome.idle
    assert outcome.noticed
    # the deterministic mode alone has the power: volpath has had two seconds
    truth = outcome.comparisons[0]
    assert truth.second.name == "deterministic"
    # measured: |z| of the image mean from 40 to 500, critical 3.89
    assert abs(truth.verdicts[2].largest) > 8


def test_what_is_not_spoilt_is_not_noticed(scene: Scene, witnesses: Witnesses) -> None:
    right = Mutation("none", "nothing changed", MUTATIONS[2].integrator)
    assert not try_mutation(right, scene, witnesses).noticed


def test_an_even_phase_function_is_replaced_on_both_sides(scene: Scene, witnesses: Witnesses, monkeypatch) -> None:
    assert is_even(scene)
    assert not is_even(load("sphere", size=SIZE, phase="hg", g=0.6))
    assert "isotropic is even" in try_mutation(MIRROR, scene, witnesses).meaning
    # with the sign right the two agree, so it is the sign alone that is noticed
    monkeypatch.setattr(MirroredHG, "g", HG)
    estimate, surface = estimate_equiangular(scene, "single_scattering_MirroredHG")
    assert compare(witness("right", estimate, surface=surface), with_hg(scene, witnesses)).verdicts[2].agrees


def test_a_phase_function_that_is_not_even_is_mirrored_itself() -> None:
    scene = load("sphere", size=SIZE, phase="schlick")
    outcome = try_mutation(MIRROR, scene, call_witnesses(scene, 1.0))
    assert outcome.noticed
    assert "even" not in outcome.meaning
    assert [comparison.second.name for comparison in outcome.comparisons] == ["deterministic", "volpath"]


def test_what_has_no_bearing_says_why() -> None:
    scene = load("empty", size=(16, 16))
    witnesses = call_witnesses(scene, 1.0)
    idle = {mutation.name: try_mutation(mutation, scene, witnesses).idle for mutation in MUTATIONS[-2:]}
    assert idle == {
        "visibility off by one": "nothing shades the fog that is seen",
        "no cosine": "no surface is seen",
    }


@pytest.mark.parametrize("name", ["sphere", "donut_dragon"])
def test_lights_are_put_back(name: str) -> None:
    scene = load(name, size=(8, 8))

    def places() -> np.ndarray:
        emitters = instantiate(scene).scene.emitters()
        somewhere = mi.Interaction3f()
        somewhere.p = mi.Point3f(scene.camera.origin.tolist())
        return np.array([np.array(e.sample_direction(somewhere, mi.Point2f(0.5))[0].p).ravel() for e in emitters])

    before = places()
    with moved_lights(scene):
        moved = np.linalg.norm(places() - before)
    # 1 % of the light's distance from the middle of what is seen
    assert 0.01 < moved < 0.3
    assert (places() == before).all()
