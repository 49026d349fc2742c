"""`airlight benchmark reference`: the arithmetic on passes of known variance, who runs, and what is written."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scene_files import sphere, write_scene
from slab import GREY, VIEWS, slab_scene

from experiments.benchmark import efficiency, measurement, page, report
from experiments.benchmark.contenders import AirlightVolpath, unshadowed, with_strata
from experiments.benchmark.efficiency import Passes
from experiments.benchmark.measurement import STRATA, Measurement, Strata, measure
from experiments.benchmark.summary import LINES, MUST, WISH, heading, method, numbers, verdict
from reference.estimators import Equiangular, Volpath
from reference.goal import FEWEST_PASSES, Goal
from scenes.errors import InputError
from scenes.loader import load

RNG = np.random.default_rng(8)
TRUTH = np.ones((4, 6, 3)) * np.linspace(1.0, 2.0, 6)[:, None]
# of 24 pixels every other one is as smooth as without shadows
EDGES = np.arange(24) % 2 == 0


def passes_of(deviation: float | np.ndarray, seconds: float, truth: np.ndarray = TRUTH) -> Passes:
    """Passes of a known relative deviation; one was held up, which a median does not notice."""
    return Passes(truth, np.broadcast_to(deviation, truth.shape) * truth, np.array([seconds] * 4 + [99.0]))


def measured(ours: float = 0.02, theirs: float = 0.4) -> Measurement:
    """What would have been found of passes of 0.5 s and 2 s, after a plan of 3 s."""
    smooth = np.where(EDGES.reshape(4, 6, 1), ours / 2.1, ours / 1.9)
    steps = np.array(list(STRATA), float)
    return Measurement(
        scene=load("sphere", size=(6, 4)),
        goal=Goal(0.005),
        ours=passes_of(ours, 0.5),
        # so far off that errors relative to it would be a third
        theirs=replace(passes_of(theirs, 2.0), mean=3 * TRUTH),
        shadowless=passes_of(smooth, 0.3),
        one_stratum=passes_of(1.0, 0.1),
        strata=tuple(Strata(int(n), 0.01 * n, np.where(EDGES, 0.5 / n, 0.2 * n**-1.5)) for n in steps),
        samples=20.0,
        volpath_samples=32,
        plan_seconds=3.0,
        compile_seconds=(0.5, 1.0),
        peak_memory=0.5,
    )


def test_the_seconds_are_those_of_a_known_variance() -> None:
    found = numbers(measured())
    # (0.02 / 0.005)^2 = 16 passes of 0.5 s against (0.4 / 0.005)^2 = 6400 of 2 s
    for part in (25, 50, 75):
        assert found[f"ours_seconds_{part}"] == pytest.approx(8.0)
        assert found[f"volpath_seconds_{part}"] == pytest.approx(12_800.0)
        assert found[f"ratio_{part}"] == pytest.approx(1600.0)
        # no error bar from fewer than 32 passes, and the plan before them
        assert found[f"ours_as_run_seconds_{part}"] == pytest.approx(3 + FEWEST_PASSES * 0.5)
        assert found[f"volpath_as_run_seconds_{part}"] == pytest.approx(12_800.0)
        assert found[f"as_run_ratio_{part}"] == pytest.approx(12_800 / 19)
    assert found["seconds_to_goal"] == pytest.approx(19.0)
    assert (found["time_of_shadow_rays"], found["time_of_any_pass"], found["time_of_fog"]) == pytest.approx(
        (0.4, 0.2, 0.4)
    )
    # more than the fewest passes: (0.0501 / 0.005)^2 = 100.4 of them are 101 whole ones
    found = numbers(measured(ours=0.0501))
    assert found["ours_seconds_50"] == pytest.approx(50.2, rel=1e-3)
    assert found["ours_as_run_seconds_50"] == found["seconds_to_goal"] == pytest.approx(3 + 101 * 0.5)


def test_ratios_are_taken_pixel_by_pixel() -> None:
    # 400 to 1,849 passes of ours, as many as the pixel needs, and 400 times as many of theirs
    deviations = 0.005 * np.arange(20, 44).reshape(4, 6, 1)
    one = replace(measured(), ours=passes_of(deviations, 0.5), theirs=passes_of(20 * deviations, 2.0), plan_seconds=0.0)
    found = numbers(one)
    for part in (25, 50, 75):
        assert found[f"ratio_{part}"] == pytest.approx(1600)
        # whole passes: a rounding of the floats is one pass of 400
        assert found[f"as_run_ratio_{part}"] == pytest.approx(1600, rel=1 / 400)
    assert found["ours_seconds_75"] > 1.8 * found["ours_seconds_25"]


def test_edges_and_exponents() -> None:
    one = measured()
    np.testing.assert_array_equal(one.edges(), EDGES)
    every, edge, smooth = one.exponents()
    assert (edge, smooth) == pytest.approx((-1.0, -1.5))
    # half of the pixels are of each kind
    assert -1.5 < every < -1.0
    none = replace(one, shadowless=one.ours)
    assert not none.edges().any()
    assert np.isnan(none.exponents()[1])
    assert np.isnan(efficiency.fitted_exponent(np.array([1.0, 4.0]), np.array([0.0, 1.0])))


def test_each_pixel_has_its_own_ratio_and_dark_ones_none() -> None:
    truth = TRUTH.copy()
    truth[0, 0] = 1e-3  # below a hundredth of the median
    truth[0, 1, 2] = 0.0  # one channel without light has no relative error; the others have
    deviation = np.zeros_like(truth)
    deviation[..., 0], deviation[..., 1] = 0.01, 0.03  # the worst channel decides
    deviation[1, 1, 1] = 0.06
    passes = passes_of(deviation, 1.0, truth)
    lit = efficiency.lit_pixels(truth)
    assert not lit[0, 0]
    assert lit.sum() == 23
    expected = np.full((4, 6), 36.0)
    expected[1, 1] = 144.0
    np.testing.assert_allclose(efficiency.seconds_by_variance(passes, truth, 0.005), expected[lit])


def test_passes_run_in_turn_and_their_spread_is_measured() -> None:
    order: list[tuple[str, int]] = []

    def noise(name: str, sigma: float):
        def one_pass(number: int) -> np.ndarray:
            order.append((name, number))
            return TRUTH * (1 + sigma * RNG.normal(size=TRUTH.shape))

        return one_pass

    found = efficiency.interleave({"a": noise("a", 0.02), "b": noise("b", 0.4)}, 400)
    assert order == [(name, number) for number in range(400) for name in "ab"]
    assert found["a"].seconds.shape == (400,)
    assert (found["b"].seconds >= 0).all()
    for name, sigma in (("a", 0.02), ("b", 0.4)):
        assert np.median(found[name].deviation / TRUTH) == pytest.approx(sigma, rel=0.02)
        np.testing.assert_allclose(found[name].mean, TRUTH, rtol=5 * sigma / 20)


def test_the_spread_of_few_passes_is_that_of_one() -> None:
    shape = (64, 64, 3)
    found = efficiency.interleave({"": lambda _: 1 + 0.1 * RNG.normal(size=shape)}, 4)[""]
    # 12,288 variances of 3 degrees of freedom are known to 0.7 % together
    assert np.mean(found.deviation**2) == pytest.approx(0.1**2, rel=0.04)


def test_the_verdict_goes_by_the_smaller_ratio() -> None:
    # 1,600 by variance x time and 674 as run; 25,600 and 10,779; 100 and 42
    assert f"the goal of {WISH:,} is not reached" in verdict(measured())
    assert f"the goal of {WISH:,} is reached" in verdict(measured(theirs=1.6))
    assert f"not the {MUST} that both must be" in verdict(measured(theirs=0.1))
    assert "error of 50% of the pixels" in verdict(measured())
    assert "shadow rays 40%" in verdict(measured())


def test_volpath_sees_the_airlight_alone() -> None:
    ours, black = (
        np.array([[estimator.one_pass(seed)[layer].mean() for seed in range(16)]])
        for estimator, layer in (
            (Equiangular(load("sphere", size=(16, 16))), "scattering"),
            (AirlightVolpath(load("sphere", size=(16, 16)), samples=64), "composite"),
        )
    )
    error = np.hypot(ours.std(ddof=1), black.std(ddof=1)) / 4
    assert abs(ours.mean() - black.mean()) < 4 * error
    # surfaces would have been noticed: they are more than half as bright as the fog
    whole = np.mean(
        [Volpath(load("sphere", size=(16, 16)), 64).one_pass(seed)["composite"].mean() for seed in range(4)]
    )
    assert whole - ours.mean() > 20 * error


def test_without_shadow_rays_nothing_else_changes(tmp_path: Path) -> None:
    for free in (write_scene(tmp_path, size=(12, 12)), slab_scene(tmp_path, VIEWS[next(iter(VIEWS))], GREY)):
        shadowed = Equiangular(free)
        shadowed.samples = np.full_like(shadowed.samples, 5)
        other = unshadowed(shadowed, free)
        np.testing.assert_array_equal(other.one_pass(3)["scattering"], shadowed.one_pass(3)["scattering"])
    ball = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), size=(12, 12))
    shadowed = Equiangular(ball)
    dark = shadowed.one_pass(3)["scattering"]
    light = unshadowed(shadowed, ball).one_pass(3)["scattering"]
    # the same samples, some of them in the shadow
    assert (light >= dark).all()
    assert (light > 1.05 * dark).any()


def test_strata_are_those_asked_for(tmp_path: Path) -> None:
    scene = write_scene(tmp_path, size=(8, 8))
    estimator = with_strata(scene, np.full((8, 8), 64, np.uint32))
    deviation = [
        np.std([one.one_pass(seed)["scattering"] for seed in range(8)], axis=0).mean()
        for one in (with_strata(scene, np.full((8, 8), 4, np.uint32)), estimator)
    ]
    # a smooth integrand: 16 times the strata, 64 times less error
    assert deviation[0] / deviation[1] == pytest.approx(64, rel=0.3)


def test_a_scene_is_measured_and_written(airlight, tmp_path: Path) -> None:
    out = tmp_path / "page"
    result = airlight("benchmark", "reference", "sphere", "--size", 12, 10, "--volpath-spp", 33, "--out", out)
    assert result.code == 0, result.err
    for name in LINES:
        assert name in result.out
    assert "sphere, 12 x 10" in result.out
    text = (out / "README.md").read_text()
    assert text.startswith(f"# {page.TITLE}\n")
    # 33 samples of volpath are 32 passes of 2
    assert f"benchmark reference sphere --size 12 10 --rel-error 0.005 --volpath-spp 64 --out {out}" in text
    assert "64 samples a pixel of volpath" in text
    assert all(f"| {name} | " in text for name in LINES)
    (row,) = csv.DictReader((out / "results.csv").open())
    assert (row["scene"], row["size"], row["passes"], row["volpath_pass_samples"]) == ("sphere", "12 10", "32", "2")
    assert int(row["lit_pixels"]) == 120
    for name in ("ratio", "as_run_ratio", "ours_seconds", "volpath_seconds", "ours_as_run_seconds"):
        low, middle, high = (float(row[f"{name}_{part}"]) for part in (25, 50, 75))
        assert 0 < low <= middle <= high
    steps = list(csv.DictReader((out / "strata.csv").open()))
    assert [int(step["strata"]) for step in steps] == list(STRATA)
    assert float(steps[-1]["deviation_50"]) < 1e-2 * float(steps[0]["deviation_50"])
    assert (out / "error_against_time.png").read_bytes().startswith(b"\x89PNG")


def test_stand_ins_are_starred(monkeypatch) -> None:
    one = measured()
    assert "*" not in heading(one)
    assert "stand-in" not in method([one])
    monkeypatch.setitem(one.scene.__dict__, "stand_ins", ("dragon.ply",))
    assert heading(one) == "sphere*, 6 x 4"
    assert "* Procedural stand-ins serve for dragon.ply." in method([one])


def test_what_cannot_be_meant_is_refused_before_the_work(airlight, tmp_path: Path, monkeypatch) -> None:
    def never(*_: object) -> None:
        raise AssertionError("measured before it was refused")

    monkeypatch.setattr(report, "measure", never)
    taken = tmp_path / "taken"
    taken.mkdir()
    (taken / "README.md").write_text("# Mine\n")
    for words, told in (
        (("--rel-error", 0), "relative error"),
        (("--volpath-spp", 31), "volpath-spp"),
        (("nowhere",), "nowhere"),
        (("--out", taken), "choose another --out"),
    ):
        result = airlight("benchmark", "reference", *words)
        assert result.code == 2, words
        assert told in result.err


def test_scalar_rgb_is_refused(monkeypatch, tmp_path: Path) -> None:
    scene = write_scene(tmp_path, size=(4, 4))
    monkeypatch.setattr(measurement.mi, "variant", lambda: "scalar_rgb")
    with pytest.raises(InputError, match="LLVM or CUDA"):
        measure(scene, 0.005, 32, print)
