"""Flicker of paths whose frames are known."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scene_files import sphere, write_scene

from experiments.flip import LUMINANCE
from experiments.measurements.flicker import Sight, flicker, flicker_of
from reference.convergence import Goal
from reference.estimate import deterministic_reference, estimate_reference
from scenes.errors import InputError
from scenes.orbit import orbited

RANDOM = np.random.default_rng(11)
SHAPE = 96, 128
# brighter by a tenth from frame to frame
TRUTH = [np.full(SHAPE, 2 * 1.1**k) for k in range(6)]
QUIET = np.zeros(SHAPE)


def path(tests, truths=TRUTH, standard_error: float = 0.0) -> list[Sight]:
    return [Sight(test, truth, QUIET + standard_error) for test, truth in zip(tests, truths, strict=True)]


def test_the_truth_does_not_flicker() -> None:
    still = flicker_of(path(TRUTH))
    assert (still.rms, still.high, still.noise) == (0, 0, 0)
    # (1.1 - 1) / ((1 + 1.1) / 2)
    assert still.moved == pytest.approx(0.1 / 1.05)


def test_an_error_that_stays_does_not_flicker() -> None:
    error = RANDOM.standard_normal(SHAPE)
    assert flicker_of(path([truth + error for truth in TRUTH])).rms < 1e-15


def test_an_error_that_comes_and_goes() -> None:
    """Up by a hundredth of the pair's mean in every other frame: each pair differs by as much."""
    truths = [np.full(SHAPE, 3.0)] * 4
    tests = [truth + 0.03 * (k % 2) for k, truth in enumerate(truths)]
    found = flicker_of(path(tests, truths))
    assert found.rms == pytest.approx(0.01, rel=1e-9)
    assert found.high == pytest.approx(0.01, rel=1e-9)
    assert found.moved == 0


def test_errors_that_are_new_in_each_frame() -> None:
    truths = [np.full(SHAPE, 3.0)] * 8
    found = flicker_of(path([truth + 0.03 * RANDOM.standard_normal(SHAPE) for truth in truths], truths))
    # a difference of two errors of 0.01 each; 95 % of a normal distribution lie within 1.96 standard deviations
    assert found.rms == pytest.approx(0.01 * np.sqrt(2), rel=0.02)
    assert found.high == pytest.approx(1.96 * 0.01 * np.sqrt(2), rel=0.02)


def test_noise_bounds_what_independent_references_add() -> None:
    truth = [np.full(SHAPE, 3.0)] * 8
    noisy = [one + 0.06 * RANDOM.standard_normal(SHAPE) for one in truth]
    tests = [one + 0.03 * (k % 2) for k, one in enumerate(truth)]
    found = flicker_of(path(tests, noisy, 0.06))
    assert found.noise == pytest.approx(0.02 * np.sqrt(2), rel=0.02)
    assert flicker_of(path(truth, noisy, 0.06)).rms == pytest.approx(found.noise, rel=0.02)
    # nothing is taken away
    assert found.rms == pytest.approx(np.hypot(0.01, found.noise), rel=0.02)


def test_neighbouring_references_err_alike(tmp_path) -> None:
    """Two of Mitsuba's, a quarter of a degree apart: far noisier than the flicker, which is found all the same."""
    scene = write_scene(tmp_path, shapes=sphere(0, 0, 0, 0.8), size=(24, 24))
    views = [scene, orbited(scene, 0.25)]
    truths = [deterministic_reference(view).scattering @ LUMINANCE for view in views]
    sampled = [estimate_reference(view, Goal(rel_error=0.05)) for view in views]
    assert sampled[0].estimate.passes == sampled[1].estimate.passes
    sights = [
        Sight(truth * (1 + 0.003 * k), of.scattering @ LUMINANCE, of.standard_error("scattering") @ LUMINANCE)
        for k, (truth, of) in enumerate(zip(truths, sampled, strict=True))
    ]
    found = flicker_of(sights)
    # measured: 0.0074 and 0.00304
    assert found.noise > 2 * found.rms
    assert found.rms == pytest.approx(0.003, rel=0.05)


def test_the_floor_is_that_of_all_frames() -> None:
    """The light goes out behind the first frame: the second alone would have a hundredth of its floor."""
    dim = [np.full(SHAPE, 4.0), np.full(SHAPE, 0.04), np.full(SHAPE, 0.04)]
    for truth in dim:
        truth[0, 0] = 1e-6
    tests = [dim[0], dim[1], dim[2].copy()]
    tests[2][0, 0] += 4e-4
    found = flicker_of(path(tests, dim))
    # 1 % of the median of all, which is 0.04; of the first frame it would be 0.04 itself
    assert found.rms == pytest.approx(1 / np.sqrt(2 * 96 * 128), rel=1e-3)


def test_the_dark_does_not_count() -> None:
    """Pixels that are dark in all pictures are left out; one that only the technique lights counts by the floor."""
    lit = np.zeros(SHAPE)
    lit[:48] = 4.0
    flash = lit.copy()
    flash[0, 0] += 0.4
    found = flicker_of([Sight(lit, lit, QUIET), Sight(flash, lit, QUIET)])
    assert found.rms == pytest.approx(0.1 / np.sqrt(48 * 128))
    ghost = lit.copy()
    ghost[95, 127] = 0.4
    found = flicker_of([Sight(lit, lit, QUIET), Sight(ghost, lit, QUIET)])
    # the floor is 1 % of the median
    assert found.rms == pytest.approx(0.4 / 0.04 / np.sqrt(48 * 128 + 1))
    assert flicker_of([Sight(lit, QUIET, QUIET)] * 2) is None


class Seen:
    """A view's frame or reference."""

    def __init__(self, luminance: np.ndarray) -> None:
        self.scattering = np.repeat(luminance[..., None], 3, axis=-1)

    def standard_error(self, layer: str) -> np.ndarray:
        assert layer == "scattering"
        return 0 * self.scattering


def shot(frames: int) -> SimpleNamespace:
    views = [
        SimpleNamespace(frame=Seen(truth * (1 + 0.01 * (k % 2))), reference=Seen(truth))
        for k, truth in enumerate(TRUTH[:frames])
    ]
    return SimpleNamespace(
        case=SimpleNamespace(camera=SimpleNamespace(frames=frames, step=0.5)), views=lambda: iter(views)
    )


def test_of_a_shot() -> None:
    numbers = flicker(shot(2))
    # 1.1 times a hundredth, of a mean of 1.05
    assert numbers["flicker.rms"] == pytest.approx(0.011 / 1.05)
    assert (numbers["flicker.frames"], numbers["flicker.degrees"]) == (2, 0.5)
    assert set(numbers) == {f"flicker.{name}" for name in ("rms", "high", "moved", "noise", "frames", "degrees")}
    with pytest.raises(InputError, match="two frames or more"):
        flicker(shot(1))
