"""References from the cache: used where they are good enough, gone on with where they are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cache_entries import names

from reference import cache, convergence
from reference.estimate import Reference, deterministic_reference, estimate_reference
from reference.goal import FEWEST_IN_LIMIT, FEWEST_PASSES, Goal
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Scene

pytestmark = pytest.mark.usefixtures("own_cache")


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load("sphere", size=(12, 9))


def identical(one: Reference, other: Reference) -> bool:
    return one.layers.keys() == other.layers.keys() and all(
        np.allclose(one.layers[name], other.layers[name], rtol=1e-12, atol=0) for name in one.layers
    )


def test_a_reference_is_estimated_once(scene: Scene) -> None:
    first, again = estimate_reference(scene, Goal(0.02)), estimate_reference(scene, Goal(0.02))
    assert (first.from_cache, again.from_cache) == (False, True)
    assert identical(first, again)
    assert replace(first.estimate, seconds=0.0).__dict__.keys() == again.estimate.__dict__.keys()
    for name in ("passes", "planned_for", "rel_error", "stopped_by", "seconds"):
        assert getattr(first.estimate, name) == getattr(again.estimate, name)
    assert (first.estimate.samples == again.estimate.samples).all()
    (listed,) = cache.entries()
    assert (listed.scene, listed.image_size, listed.estimator) == ("sphere", (12, 9), first.recipe["estimator"])
    assert (listed.asked, listed.rel_error, listed.finished) == (0.02, first.estimate.rel_error, True)
    assert (listed.stale, listed.damaged) == ("", "")
    assert (first.passes_before, again.passes_before) == (0, first.estimate.passes)
    assert first.recipe == again.recipe
    # bit for bit
    assert all((first.layers[name] == again.layers[name]).all() for name in first.layers)


def test_a_looser_goal_takes_what_is_there(scene: Scene) -> None:
    first = estimate_reference(scene, Goal(0.02))
    looser = estimate_reference(scene, Goal(0.1))
    assert looser.from_cache
    assert looser.estimate.passes == first.estimate.passes
    # and says how good it is, at the percentile that is asked for
    median = estimate_reference(scene, Goal(0.1, percentile=50))
    assert median.estimate.rel_error < looser.estimate.rel_error == first.estimate.rel_error


def test_a_stricter_goal_goes_on(scene: Scene) -> None:
    first = estimate_reference(scene, Goal(0.02))
    stricter = estimate_reference(scene, Goal(0.6 * first.estimate.rel_error))
    assert stricter.passes_before == first.estimate.passes
    assert stricter.estimate.passes > first.estimate.passes
    assert (stricter.estimate.samples == first.estimate.samples).all()
    assert stricter.estimate.reached
    assert estimate_reference(scene, Goal(0.6 * first.estimate.rel_error)).from_cache


def test_a_much_stricter_goal_has_a_plan_of_its_own(scene: Scene) -> None:
    estimate_reference(scene, Goal(0.05))
    strict = estimate_reference(scene, Goal(0.002))
    assert strict.passes_before == 0
    assert strict.estimate.samples.mean() > 20
    # what replaced the other entry serves both
    assert estimate_reference(scene, Goal(0.05)).passes_before == strict.estimate.passes


def test_a_plan_that_a_limit_spoilt_is_made_anew(scene: Scene) -> None:
    stopped = estimate_reference(scene, Goal(0.005, time_limit=1e-9)).estimate
    assert (stopped.samples == 1).all()
    assert stopped.planned_for > 2 * 0.005
    whole = estimate_reference(scene, Goal(0.005))
    assert (whole.passes_before, whole.estimate.passes) == (0, FEWEST_PASSES)
    assert whole.estimate.samples.min() > 16


def test_what_is_begun_anew_and_stopped_takes_no_better_ones_place(scene: Scene) -> None:
    good = estimate_reference(scene, Goal(0.02))

    def interrupt(progress: convergence.Progress) -> None:
        if progress.passes == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        estimate_reference(scene, Goal(1e-4), interrupt)
    assert identical(estimate_reference(scene, Goal(0.02)), good)
    # as little as the sample limit lets it be
    worse = estimate_reference(scene, Goal(1e-5, sample_limit=8))
    assert not worse.estimate.reached
    assert worse.estimate.rel_error == good.estimate.rel_error
    assert identical(estimate_reference(scene, Goal(0.02)), good)


def test_a_sealed_entry_of_something_else_is_made_again(scene: Scene) -> None:
    made = estimate_reference(scene, Goal(0.1))
    cache.store(made.recipe, {"mean.scattering": made.scattering}, {"rel_error": 0.0})
    again = estimate_reference(scene, Goal(0.1))
    assert identical(made, again)
    assert "holds no reference" in again.notices[0]
    assert estimate_reference(scene, Goal(0.1)).from_cache


def test_what_a_limit_stopped_goes_on(scene: Scene) -> None:
    whole = estimate_reference(scene, Goal(0.01, percentile=90))
    (entry,) = cache.entries()
    entry.path.unlink()
    stopped = estimate_reference(scene, Goal(0.01, time_limit=1e-9, percentile=90))
    # the time limit leaves a stratum to each pixel, so the two are not of one plan
    assert (stopped.estimate.passes, stopped.estimate.stopped_by) == (FEWEST_IN_LIMIT, "time")
    on = estimate_reference(scene, Goal(0.01, sample_limit=12, percentile=90))
    assert (on.passes_before, on.estimate.passes, on.estimate.stopped_by) == (FEWEST_IN_LIMIT, 12, "samples")
    # one more pass each time, however short the time
    for passes in (13, 14):
        assert estimate_reference(scene, Goal(0.01, time_limit=1e-9, percentile=90)).estimate.passes == passes
    at_last = estimate_reference(scene, Goal(0.01, percentile=90))
    assert at_last.estimate.reached
    # with time enough for strata it is begun anew
    assert at_last.passes_before == 0
    error = np.hypot(*(made.standard_error("scattering") for made in (whole, at_last)))
    assert (np.abs(whole.scattering - at_last.scattering) < 6 * error + 1e-5).all()


def test_what_was_interrupted_goes_on_to_the_same_picture(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = estimate_reference(scene, Goal(0.01))
    (entry,) = cache.entries()
    entry.path.unlink()

    def interrupt(progress: convergence.Progress) -> None:
        if progress.passes == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        estimate_reference(scene, Goal(0.01), interrupt)
    (entry,) = cache.entries()
    assert entry.finished is False
    on = estimate_reference(scene, Goal(0.01))
    assert (on.passes_before, on.estimate.passes) == (5, whole.estimate.passes)
    assert identical(whole, on)


def test_centres_and_boxes_are_two_references(scene: Scene) -> None:
    centre = estimate_reference(scene, Goal(0.1))
    box = estimate_reference(scene, Goal(0.1), pixel_filter="box")
    assert (centre.pixel_filter, box.pixel_filter) == ("centre", "box")
    assert box.passes_before == 0
    assert centre.standard_error("surface").max() == 0 < box.standard_error("surface").max()
    for pixel_filter in ("centre", "box"):
        assert estimate_reference(scene, Goal(0.1), pixel_filter=pixel_filter).from_cache


def test_the_deterministic_reference_is_kept_beside_the_other(scene: Scene) -> None:
    sampled = estimate_reference(scene, Goal(0.01))
    first, again = deterministic_reference(scene), deterministic_reference(scene)
    assert (first.from_cache, again.from_cache) == (False, True)
    assert identical(first, again)
    assert first.estimate.reached
    assert (first.surface == sampled.surface).all()
    error = np.hypot(first.standard_error("scattering"), sampled.standard_error("scattering"))
    assert (np.abs(first.scattering - sampled.scattering) < 6 * error + 1e-5).all()
    assert {entry.estimator for entry in cache.entries()} == {"deterministic", "equiangular"}
    assert not any(entry.stale for entry in cache.entries())


def test_whatever_decides_a_reference_makes_another_one() -> None:
    estimate_reference(load("empty", size=(6, 5)), Goal(0.2))
    for other in (
        load("empty", size=(5, 6)),
        load("empty", size=(6, 5), sigma_t=0.11),
        load("empty", size=(6, 5), phase="hg", g=0.6),
        load("empty", size=(6, 5), phase="hg", g=-0.6),
    ):
        assert estimate_reference(other, Goal(0.2)).passes_before == 0
    assert estimate_reference(load("empty", size=(6, 5)), Goal(0.2)).from_cache


def test_a_damaged_entry_is_made_again_and_said(scene: Scene) -> None:
    first = estimate_reference(scene, Goal(0.1))
    (entry,) = cache.entries()
    content = bytearray(entry.path.read_bytes())
    content[len(content) // 2] ^= 1
    entry.path.write_bytes(content)
    again = estimate_reference(scene, Goal(0.1))
    assert again.passes_before == 0
    assert identical(first, again)
    (notice,) = again.notices
    assert str(entry.path.with_suffix(".damaged")) in notice
    assert names() == {entry.path.name, entry.path.with_suffix(".damaged").name}
    assert first.recipe == again.recipe
    assert estimate_reference(scene, Goal(0.1)).notices == ()


def test_a_disk_that_fills_up_meanwhile_stops_nothing(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise InputError("no room")

    monkeypatch.setattr(convergence, "KEEP_EVERY", 0.0)
    monkeypatch.setattr(cache, "store", full)
    made = estimate_reference(scene, Goal(0.1))
    assert made.estimate.passes >= FEWEST_PASSES
    assert made.notices == ("The reference is not kept for the next time: no room",)
