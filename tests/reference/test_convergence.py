"""Passes accumulated until an error bar is small enough, with estimators whose variance is known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from reference import convergence
from reference.convergence import Estimate, converge, relative_error
from reference.goal import FEWEST_IN_LIMIT, FEWEST_PASSES, Goal
from reference.moments import tiles
from scenes.errors import InputError


class Synthetic:
    """Normal noise of known spread around a known image; `common` moves all pixels of a pass together."""

    name, version, pixel_filter = "synthetic", 1, "centre"
    layers = ("scattering",)

    def __init__(self, truth: np.ndarray, spread: float | np.ndarray, common: float = 0.0, first_seed: int = 0) -> None:
        self.truth, self.spread, self.common, self.first_seed = truth, spread, common, first_seed
        self.samples = np.ones(truth.shape[:2], np.uint32)
        self.seeds: list[int] = []
        self.passes: list[np.ndarray] = []

    def plan(self, goal: Goal) -> float:
        self.planned = goal
        return goal.rel_error

    def fixed(self) -> dict[str, np.ndarray]:
        return {"surface": 0.5 * self.truth}

    def one_pass(self, seed: int) -> dict[str, np.ndarray]:
        self.seeds.append(seed)
        rng = np.random.default_rng([self.first_seed, seed])
        noise = self.spread * rng.normal(size=self.truth.shape) + self.common * rng.normal()
        self.passes.append(self.truth * (1 + noise))
        return {"scattering": self.passes[-1]}


def an_image(height: int = 16, width: int = 24) -> np.ndarray:
    return np.random.default_rng(3).uniform(0.5, 2, (height, width, 3))


def test_mean_and_standard_error_are_those_of_numpy() -> None:
    # an offset of 1e6 with a spread of 1: a sum of squares would have lost most of its digits
    estimator = Synthetic(1e6 * np.ones((8, 8, 3)), spread=1e-6)
    estimate = converge(estimator, Goal(0.5))
    passes = np.array(estimator.passes)
    assert estimate.passes == len(passes) == FEWEST_PASSES
    assert estimate.mean["scattering"] == pytest.approx(passes.mean(0), rel=1e-14)
    error = passes.std(0, ddof=1) / np.sqrt(len(passes))
    assert estimate.standard_error["scattering"] == pytest.approx(error, rel=1e-6)
    means = passes.mean((1, 2))
    assert estimate.image_mean["scattering"] == pytest.approx(means.mean(0), rel=1e-14)
    assert estimate.image_error["scattering"] == pytest.approx(means.std(0, ddof=1) / np.sqrt(len(passes)), rel=1e-6)
    assert estimate.mean["scattering"].dtype == np.float64


def test_error_bars_of_pixels_cover_the_truth() -> None:
    """(mean - truth) / standard error follows Student's t with passes - 1 degrees of freedom."""
    truth = an_image(64, 64)
    estimate = converge(Synthetic(truth, spread=0.1), Goal(0.5))
    z = ((estimate.mean["scattering"] - truth) / estimate.standard_error["scattering"]).ravel()
    assert stats.kstest(z, stats.t(estimate.passes - 1).cdf).pvalue > 1e-3
    # the test sees a bar that is 10 % too short
    assert stats.kstest(z * 1.1, stats.t(estimate.passes - 1).cdf).pvalue < 1e-4


def test_the_image_means_error_bar_covers_what_pixels_have_in_common() -> None:
    truth = an_image(4, 4)
    z, naive = [], []
    for first_seed in range(300):
        estimate = converge(Synthetic(truth, spread=0.02, common=0.05, first_seed=first_seed), Goal(0.9))
        difference = (estimate.image_mean["scattering"] - truth.mean((0, 1)))[0]
        z.append(difference / estimate.image_error["scattering"][0])
        naive.append(difference / np.sqrt((estimate.standard_error["scattering"][..., 0] ** 2).sum()) * 16)
    distribution = stats.t(FEWEST_PASSES - 1).cdf
    assert stats.kstest(z, distribution).pvalue > 1e-3
    # pixels taken for independent would give a bar several times too short
    assert stats.kstest(naive, distribution).pvalue < 1e-6


def test_it_stops_at_the_goal() -> None:
    # standard error = spread / sqrt(passes); the 95th percentile of pixels lies a little above
    estimate = converge(Synthetic(an_image(), spread=0.2), Goal(rel_error=0.02))
    assert estimate.reached
    assert estimate.rel_error <= 0.02
    assert 100 < estimate.passes < 170
    assert estimate.rel_error == relative_error(estimate.mean["scattering"], estimate.standard_error["scattering"], 95)


def test_it_never_takes_fewer_passes_than_an_error_bar_needs() -> None:
    estimate = converge(Synthetic(an_image(), spread=1e-9), Goal(rel_error=0.9))
    assert estimate.reached
    assert estimate.passes == FEWEST_PASSES


def test_it_stops_at_the_time_limit_and_says_so() -> None:
    estimate = converge(Synthetic(an_image(), spread=1.0), Goal(rel_error=1e-6, time_limit=1e-9))
    assert not estimate.reached
    assert estimate.passes == FEWEST_IN_LIMIT
    assert estimate.rel_error > 1e-6


def test_passes_have_seeds_of_their_own() -> None:
    estimator = Synthetic(an_image(), spread=0.2)
    converge(estimator, Goal(rel_error=0.03))
    assert len(set(estimator.seeds)) == len(estimator.seeds) >= FEWEST_PASSES


def test_progress_is_reported() -> None:
    reports: list[convergence.Progress] = []
    estimate = converge(Synthetic(an_image(), spread=0.2), Goal(rel_error=0.02), reports.append)
    assert [report.passes for report in reports] == list(range(2, estimate.passes + 1))
    assert reports[-1].rel_error == estimate.rel_error
    assert all(report.seconds_left >= 0 for report in reports)
    assert reports[-1].seconds_left == 0


def test_what_needs_no_sampling_has_no_error() -> None:
    truth = an_image()
    estimate = converge(Synthetic(truth, spread=0.01), Goal(0.5))
    assert (estimate.mean["surface"] == 0.5 * truth).all()
    assert (estimate.standard_error["surface"] == 0).all()
    assert estimate.image_mean["surface"] == pytest.approx(0.5 * truth.mean((0, 1)))
    assert (estimate.image_error["surface"] == 0).all()


def test_dark_pixels_do_not_decide() -> None:
    # a tenth of the pixels nearly black, with an error as large as themselves
    mean, error = np.ones((10, 10, 3)), np.full((10, 10, 3), 0.01)
    mean[0], error[0] = 1e-9, 1e-9
    assert relative_error(mean, error, 95) == pytest.approx(0.01)
    # dim ones do
    mean[0], error[0] = 0.02, 0.02
    assert relative_error(mean, error, 95) == pytest.approx(1.0)


def test_a_black_image_is_an_error() -> None:
    with pytest.raises(InputError, match="zero everywhere"):
        converge(Synthetic(np.zeros((4, 4, 3)), spread=0.1), Goal())


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("layer", ["scattering", "surface"])
def test_a_pixel_that_is_not_finite_is_an_error(value: float, layer: str) -> None:
    estimator = Synthetic(an_image(), spread=0.1)
    spoilt = an_image()
    spoilt[3, 5, 1] = value
    if layer == "surface":
        estimator.fixed = lambda: {"surface": spoilt}  # type: ignore[method-assign]
    else:
        estimator.one_pass = lambda seed: {"scattering": spoilt}  # type: ignore[method-assign]
    with pytest.raises(InputError, match=f"'{layer}' has pixels that are not finite"):
        converge(estimator, Goal(0.5))


@pytest.mark.parametrize(
    "settings",
    [
        {"rel_error": 0},
        {"rel_error": 1},
        {"rel_error": -0.1},
        {"rel_error": np.nan},
        {"time_limit": 0},
        {"time_limit": np.nan},
        {"percentile": 0},
        {"percentile": 100.1},
        {"percentile": np.nan},
        {"sample_limit": 7},
    ],
    ids=str,
)
def test_goals_that_cannot_be_meant(settings: dict) -> None:
    with pytest.raises(InputError, match="use a"):
        Goal(**settings)


def test_it_stops_at_the_sample_limit_and_says_so() -> None:
    estimator = Synthetic(an_image(), spread=1.0)
    estimator.samples = np.where(np.arange(24) < 12, 4, 6) * np.ones((16, 1), int)
    # passes of 5 samples a pixel on average
    estimate = converge(estimator, Goal(rel_error=1e-6, sample_limit=104))
    assert estimate.stopped_by == "samples"
    assert not estimate.reached
    assert estimate.passes == 20


def test_the_percentile_decides() -> None:
    truth = an_image()
    spread = np.where(np.arange(24) < 12, 0.01, 0.1)[:, None]
    estimates = [converge(Synthetic(truth, spread), Goal(0.01, percentile=p)) for p in (40, 95)]
    assert [estimate.reached for estimate in estimates] == [True, True]
    # the less noisy half is there at once
    assert estimates[0].passes == FEWEST_PASSES
    # 0.1 / sqrt(passes) = 0.01 at the median of the other half, and the 95th percentile lies above it
    assert estimates[1].passes > 100


def test_tiles_have_error_bars_of_their_own() -> None:
    truth = an_image(20, 12)
    estimator = Synthetic(truth, spread=0.02, common=0.05)
    estimate = converge(estimator, Goal(0.9))
    means = np.array(estimator.passes)
    # the last tiles are 4 x 8 and 4 x 4 pixels
    for row, column, part in [(0, 0, np.s_[:8, :8]), (2, 0, np.s_[16:, :8]), (2, 1, np.s_[16:, 8:])]:
        tile = means[:, *part].mean((1, 2))
        assert estimate.tile_mean["scattering"][row, column] == pytest.approx(tile.mean(0), rel=1e-13)
        error = tile.std(0, ddof=1) / np.sqrt(len(means))
        assert estimate.tile_error["scattering"][row, column] == pytest.approx(error, rel=1e-10)
    assert estimate.tile_mean["surface"].shape == (3, 2, 3)
    assert (estimate.tile_error["surface"] == 0).all()


def same(one: Estimate, other: Estimate) -> bool:
    return all(
        getattr(one, kind)[layer] == pytest.approx(getattr(other, kind)[layer], rel=1e-12, abs=1e-300)
        for kind in ("mean", "standard_error", "tile_mean", "tile_error", "image_mean", "image_error")
        for layer in ("scattering", "surface")
    )


def test_a_stopped_estimate_goes_on_where_it_was() -> None:
    def estimator() -> Synthetic:
        return Synthetic(an_image(), spread=0.2, common=0.01)

    whole = converge(estimator(), Goal(rel_error=0.02))
    first = converge(estimator(), Goal(rel_error=0.02, sample_limit=40))
    assert (first.passes, first.stopped_by) == (40, "samples")
    continued = estimator()
    second = converge(continued, Goal(rel_error=0.02), start=first)
    # no pass is made twice, none is left out, and nothing is planned anew
    assert continued.seeds == list(range(40, whole.passes))
    assert not hasattr(continued, "planned")
    assert (second.passes, second.stopped_by) == (whole.passes, "goal")
    assert same(whole, second)
    assert not same(whole, first)
    assert second.seconds > first.seconds


def test_an_estimate_that_was_there_already_takes_no_pass() -> None:
    first = converge(Synthetic(an_image(), spread=0.2), Goal(rel_error=0.02))
    again = Synthetic(an_image(), spread=0.2)
    assert converge(again, Goal(rel_error=0.03), start=first).passes == first.passes
    assert again.seeds == []


def test_an_interrupt_inside_a_pass_leaves_nothing_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = 0

    def interrupted(image: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        if calls == 13:
            raise KeyboardInterrupt
        return tiles(image)

    monkeypatch.setattr(convergence, "tiles", interrupted)
    kept: list[Estimate] = []
    with pytest.raises(KeyboardInterrupt):
        converge(Synthetic(an_image(), spread=0.2), Goal(rel_error=0.02), keep=kept.append)
    monkeypatch.undo()
    # two calls for the surface, so the eleventh pass was cut
    assert kept[0].passes == 10
    whole = converge(Synthetic(an_image(), spread=0.2), Goal(rel_error=0.02))
    assert same(converge(Synthetic(an_image(), spread=0.2), Goal(rel_error=0.02), start=kept[0]), whole)


def test_a_sample_limit_below_the_fewest_passes_is_refused() -> None:
    estimator = Synthetic(an_image(), spread=0.2)
    estimator.samples = np.full((16, 24), 64, np.uint32)
    with pytest.raises(InputError, match=r"The sample limit is 100, .* use at least 512"):
        converge(estimator, Goal(sample_limit=100))


@pytest.mark.parametrize("signal", [KeyboardInterrupt, SystemExit])
def test_what_is_interrupted_is_kept(signal: type[BaseException]) -> None:
    class Interrupted(Synthetic):
        def one_pass(self, seed: int) -> dict[str, np.ndarray]:
            if seed == 10:
                raise signal
            return super().one_pass(seed)

    kept: list[Estimate] = []
    with pytest.raises(signal):
        converge(Interrupted(an_image(), spread=0.2), Goal(rel_error=0.02), keep=kept.append)
    (estimate,) = kept
    assert (estimate.passes, estimate.stopped_by, estimate.reached) == (10, "interrupt", False)
    whole = converge(Synthetic(an_image(), spread=0.2), Goal(rel_error=0.02))
    assert same(converge(Synthetic(an_image(), spread=0.2), Goal(rel_error=0.02), start=estimate), whole)


def test_it_is_kept_from_time_to_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(convergence, "KEEP_EVERY", 0.0)
    kept: list[Estimate] = []
    converge(Synthetic(an_image(), spread=0.01), Goal(0.5), keep=kept.append)
    assert [estimate.passes for estimate in kept] == list(range(2, FEWEST_PASSES + 1))
