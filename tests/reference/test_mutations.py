"""Each mutation is noticed where it matters, and called idle where it cannot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from reference.agreement.witnesses import Witnesses, call_witnesses
from reference.integrator import mi
from reference.mitsuba_scene import instantiate
from reference.mutations import MIRROR, MUTATIONS, Mutation, is_even, moved_lights, try_mutation
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


def test_what_fails_unspoilt_is_not_noticed(scene: Scene, witnesses: Witnesses) -> None:
    ours, exact, theirs = witnesses.composite
    brighter = replace(ours, image=replace(ours.image, mean=1.01 * ours.image.mean))
    doubtful = replace(witnesses, composite=(brighter, exact, theirs))
    outcome = try_mutation(MUTATIONS[1], scene, doubtful)
    assert not outcome.comparisons[0].verdicts[2].agrees
    assert outcome.noticed_by[0] == ("pixels", "tiles")
    assert outcome.noticed
    right = Mutation("none", "nothing changed", MUTATIONS[2].integrator)
    dark = replace(exact, image=replace(exact.image, mean=0.9 * exact.image.mean))
    assert not try_mutation(right, scene, replace(witnesses, composite=(ours, dark, theirs))).noticed


def test_an_even_phase_function_is_replaced_on_both_sides(scene: Scene, witnesses: Witnesses) -> None:
    assert is_even(scene)
    assert not is_even(load("sphere", size=SIZE, phase="hg", g=0.6))
    outcome = try_mutation(MIRROR, scene, witnesses)
    assert "isotropic is even" in outcome.meaning
    # with the sign right the two agree, so it is the sign alone that is noticed
    assert outcome.controls[0].agrees
    assert outcome.noticed_by == (("pixels", "tiles", "image mean"),)


def test_what_probes_may_have_missed_is_allowed_for_under_another_phase_function_too(
    scene: Scene, witnesses: Witnesses
) -> None:
    # HG 0.6 is 1.6 / 0.4^2 times as bright as an isotropic one straight ahead
    assert witnesses.doubt.max() > 0
    assert (with_hg(scene, witnesses).pixels.variance >= 99.99 * witnesses.doubt).all()


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
