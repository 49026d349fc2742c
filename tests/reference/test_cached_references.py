"""A reference is estimated once, and again where its entry is damaged or anything that decides it has changed."""

from __future__ import annotations

from pathlib import Path

import pytest
from cache_entries import names

from reference import cache
from reference.estimate import Reference, estimate_reference
from reference.goal import Goal
from scenes.loader import load


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


def same(one: Reference, other: Reference) -> bool:
    layers = [(getattr(one, name), getattr(other, name)) for name in ("surface", "scattering", "composite")]
    layers += [(one.standard_error(name), other.standard_error(name)) for name in ("surface", "scattering")]
    return one.recipe == other.recipe and all((ours == theirs).all() for ours, theirs in layers)


def test_a_reference_is_estimated_once() -> None:
    scene, goal = load("sphere", size=(6, 5)), Goal(0.2)
    first, again = estimate_reference(scene, goal), estimate_reference(scene, goal)
    assert (first.passes_before, again.passes_before) == (0, first.estimate.passes)
    assert same(first, again)
    (listed,) = cache.entries()
    assert (listed.scene, listed.image_size, listed.estimator) == ("sphere", (6, 5), first.recipe["estimator"])
    assert (listed.asked, listed.rel_error, listed.finished) == (0.2, first.estimate.rel_error, True)
    assert (listed.stale, listed.damaged) == ("", "")


def test_a_damaged_reference_is_estimated_again_and_the_person_is_told() -> None:
    scene, goal = load("sphere", size=(6, 5)), Goal(0.2)
    first = estimate_reference(scene, goal)
    (path,) = cache.folder().iterdir()
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    again = estimate_reference(scene, goal)
    assert again.passes_before == 0
    assert str(path.with_suffix(".damaged")) in again.notices[0]
    assert names() == {path.name, path.with_suffix(".damaged").name}
    assert estimate_reference(scene, goal).passes_before == again.estimate.passes
    assert first.recipe == again.recipe


def test_whatever_decides_a_reference_makes_another_one() -> None:
    goal = Goal(0.2)
    estimate_reference(load("empty", size=(6, 5)), goal)
    for other in (
        load("empty", size=(5, 6)),
        load("empty", size=(6, 5), sigma_t=0.11),
        load("empty", size=(6, 5), phase="hg", g=0.6),
        load("empty", size=(6, 5), phase="hg", g=-0.6),
    ):
        assert estimate_reference(other, goal).passes_before == 0
    assert estimate_reference(load("empty", size=(6, 5)), goal).passes_before > 0
