"""Each metric against a value worked out by hand or by code that shares nothing with ours."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace

import flip_evaluator
import numpy as np
import pytest

from experiments import flip
from experiments.compare import compare
from experiments.metrics import measure, signed_relative_error
from experiments.pictures import Picture
from experiments.sheet import display, summary, write_sheet
from reference.estimate import Reference
from reference.goal import Goal
from scenes.errors import InputError


@pytest.fixture(autouse=True)
def _cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def grey(*values: float) -> np.ndarray:
    """A picture of one row."""
    return np.repeat(np.array(values, np.float64)[None, :, None], 3, axis=2)


def test_identical_pictures_have_no_error() -> None:
    picture = np.random.default_rng(0).uniform(0.1, 3, (12, 10, 3))
    assert set(asdict(measure(picture, picture)).values()) == {0.0}


def test_each_number_by_hand() -> None:
    # mean of the reference 2, so eps = (0.01 * 2)^2 = 4e-4; errors 0.1, -0.2, 0, 0.4
    found = measure(grey(1.1, 1.8, 2.0, 3.4), grey(1.0, 2.0, 2.0, 3.0))
    assert found.rmse == pytest.approx(np.sqrt((0.01 + 0.04 + 0 + 0.16) / 4))
    assert found.bias == pytest.approx(found.rmse)
    assert found.mean_rel == pytest.approx((0.1 - 0.1 + 0 + 0.4 / 3) / 4)
    assert found.rel_mse == pytest.approx((0.01 / 1.0004 + 0.04 / 4.0004 + 0.16 / 9.0004) / 4)
    assert found.image_mean_rel == pytest.approx(8.3 / 8 - 1)
    # |relative error| of the 12 numbers, sorted: 0 x 3, 0.1 x 6, 0.1333 x 3
    assert found.rel_50 == pytest.approx(0.1)
    assert found.rel_95 == pytest.approx(0.4 / 3)
    assert found.rel_99 == pytest.approx(0.4 / 3)


def test_percentiles_over_a_hundred_and_one_numbers() -> None:
    reference = np.ones((1, 101, 3))
    test = reference + np.arange(101)[None, :, None] / 100
    found = measure(test, reference)
    assert [found.rel_50, found.rel_95, found.rel_99] == pytest.approx([0.5, 0.95, 0.99], abs=0.007)


def test_pixels_darker_than_a_hundredth_of_the_lit_median_count_as_that_bright() -> None:
    error = signed_relative_error(grey(0.5, 2.0), grey(0.0, 2.0))
    np.testing.assert_allclose(error, grey(0.5 / 0.02, 0.0))


def test_one_pixel_that_looks_into_a_light_does_not_hide_the_errors_of_the_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # its 18 exposures take two seconds
    monkeypatch.setattr("experiments.metrics.hdr_flip", lambda *_: 0.0)
    reference, test = np.full((10, 10, 3), 0.05), np.full((10, 10, 3), 0.06)
    reference[5, 5] = test[5, 5] = 1e4
    assert measure(test, reference).rel_50 == pytest.approx(0.2)


def test_brightness_scales_out_of_what_is_relative() -> None:
    rng = np.random.default_rng(1)
    reference = rng.uniform(0, 2, (6, 6, 3))
    test = reference * rng.uniform(0.9, 1.1, (6, 6, 3))
    plain = asdict(measure(test, reference))
    # the smallest are below float32's epsilon, where FLIP's own program ends the process, and close to its zero
    for scale in (1e-35, 1e-12, 1e-4, 1e4):
        scaled = asdict(measure(test * scale, reference * scale))
        for name in ("rel_mse", "mean_rel", "rel_50", "rel_95", "rel_99", "image_mean_rel"):
            assert scaled[name] == pytest.approx(plain[name], rel=1e-9)
        # FLIP computes in float32; measured: 1.4e-5
        assert scaled["flip"] == pytest.approx(plain["flip"], rel=1e-4)
        assert scaled["rmse"] == pytest.approx(scale * plain["rmse"])


def test_noise_of_the_reference_is_not_charged_to_the_technique() -> None:
    rng = np.random.default_rng(2)
    truth = np.ones((200, 200, 3))
    sigma, offset = 0.05, 0.02
    noisy = truth + rng.normal(0, sigma, truth.shape)
    error = np.full(truth.shape, sigma)
    exact, biased = measure(truth, noisy, error), measure(truth + offset, noisy, error)
    assert exact.rmse == pytest.approx(sigma, rel=0.01)
    # bias^2 is the difference of two numbers of 2.5e-3, known to sqrt(2 / 120000) = 0.4 %: three of its errors are 3e-5
    assert exact.bias < np.sqrt(3e-5)
    assert biased.bias == pytest.approx(offset, abs=2e-3)
    assert measure(truth, noisy).bias == measure(truth, noisy).rmse


def test_a_black_reference_has_no_relative_errors() -> None:
    found = asdict(measure(grey(0.3, 0.4), grey(0, 0)))
    assert found.pop("rmse") == found.pop("bias") == pytest.approx(np.sqrt(0.125))
    assert set(found.values()) == {None}


def test_a_reference_that_is_negative_on_average_has_none_either() -> None:
    assert measure(grey(0.3, 0.4), grey(-1, 0.5)).rel_95 is None


def test_sizes_must_agree() -> None:
    with pytest.raises(InputError, match=r"different sizes, 2 x 1 and 3 x 1 pixels"):
        measure(grey(1, 2), grey(1, 2, 3))


@pytest.mark.parametrize("shape", [(4, 4), (4, 4, 2), (4, 4, 4), (0, 4, 3), (4,), (1, 4, 4, 3)])
@pytest.mark.parametrize("place", range(3))
def test_what_is_no_picture_is_refused(shape: tuple[int, ...], place: int) -> None:
    pictures = [np.ones((4, 4, 3))] * 3
    pictures[place] = np.ones(shape)
    name = ("picture", "reference", "reference's standard error")[place]
    with pytest.raises(InputError, match=f"The {name} is an array of the shape"):
        measure(*pictures)
    if place < 2:
        # the same wrong shape for both
        with pytest.raises(InputError, match="is an array of the shape"):
            measure(np.ones(shape), np.ones(shape))


def test_a_standard_error_has_the_references_size() -> None:
    with pytest.raises(InputError, match="different sizes, 1 x 1 and 4 x 4 pixels"):
        measure(np.ones((4, 4, 3)), np.ones((4, 4, 3)), np.ones((1, 1, 3)))


def test_what_is_no_array_of_numbers_is_refused() -> None:
    for nothing in ("a picture", [[1, 2], [3]], None):
        with pytest.raises(InputError, match="give one of"):
            measure(nothing, grey(1, 2))


@pytest.mark.filterwarnings("error")
def test_a_sheet_of_negative_pictures_is_drawn(tmp_path: Path) -> None:
    dark = -np.ones((4, 4, 3))
    write_sheet(tmp_path / "a.png", "a", dark, 2 * dark, summary(asdict(measure(dark, 2 * dark))))
    assert (tmp_path / "a.png").is_file()
    # not a negative of itself
    assert display(dark, dark).max() == 0


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", range(3))
def test_values_that_are_not_finite_are_refused(value: float, place: int) -> None:
    pictures = [grey(1, 2), grey(1, 2), grey(0.1, 0.1)]
    pictures[place][0, 1, 2] = value
    with pytest.raises(InputError, match=("picture", "reference", "standard error")[place]):
        measure(*pictures)


def test_pixels_that_are_black_in_both_pictures_do_not_flatter() -> None:
    rng = np.random.default_rng(5)
    reference = rng.uniform(1, 2, (8, 8, 3))
    test = reference * rng.uniform(0.9, 1.1, reference.shape)
    padding = ((0, 0), (0, 24), (0, 0))
    alone, padded = measure(test, reference), measure(np.pad(test, padding), np.pad(reference, padding))
    for metric in ("mean_rel", "rel_50", "rel_95", "rel_99", "image_mean_rel"):
        assert getattr(padded, metric) == pytest.approx(getattr(alone, metric), rel=1e-12)
    # light where there should be none does count
    lit = np.pad(test, padding)
    lit[0, 8:] = 1
    assert measure(lit, np.pad(reference, padding)).rel_99 > 1


def flip_of_its_authors(test: np.ndarray, reference: np.ndarray) -> float:
    settings = {"ppd": flip_evaluator.evaluate(reference[:8, :8], test[:8, :8], "HDR")[2]["ppd"]}
    error_map = flip_evaluator.evaluate(reference, test, "HDR", True, False, False, settings)[0]
    return float(np.mean(error_map, dtype=np.float64))


# the higher the power, the darker the median beside the brightest pixel, and the more exposures
@pytest.mark.parametrize("power", [1, 6])
def test_flip_is_its_authors_own(power: int) -> None:
    rng = np.random.default_rng(3)
    reference = 4 * rng.uniform(0.1, 1, (24, 32, 3)).astype(np.float32) ** power
    test = (reference * rng.uniform(0.5, 1.5, reference.shape)).astype(np.float32)
    expected = flip_of_its_authors(test, reference)
    assert 0.01 < expected < 1
    # their mean is summed in float32
    assert measure(test, reference).flip == pytest.approx(expected, rel=1e-5)
    assert flip_evaluator.evaluate(reference, test, "HDR")[2]["ppd"] == pytest.approx(67.02, abs=0.01)


def test_black_pixels_do_not_decide_flips_exposures() -> None:
    rng = np.random.default_rng(6)
    lit = rng.uniform(0.1, 1, (16, 16, 3)).astype(np.float32) ** 3
    reference = np.pad(lit, ((0, 0), (0, 24), (0, 0)))
    test = reference * rng.uniform(0.5, 1.5, reference.shape).astype(np.float32)
    alone = flip_evaluator.evaluate(lit, lit, "HDR", True, False, True, {})[2]
    exposures = {name: alone[name] for name in ("startExposure", "stopExposure")}
    # their median of a picture that is mostly black is 0
    assert (
        alone["numExposures"]
        < flip_evaluator.evaluate(reference, test, "HDR", True, False, True, {})[2]["numExposures"]
    )
    expected = flip_evaluator.evaluate(reference, test, "HDR", True, False, True, exposures)[1]
    assert flip.hdr_flip(test, reference) == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("brightness", [0.0, 1.0, 1e30])
def test_flip_of_one_colour_is_a_number(brightness: float) -> None:
    ones = np.ones((4, 4, 3))
    assert flip.hdr_flip(ones, ones) == 0
    found = [flip.hdr_flip(ones * brightness, ones * 1e-3), flip.hdr_flip(-ones, ones)]
    assert all(0 < value <= 1 for value in found)


def test_flip_is_remembered_and_the_same(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    pair = [rng.uniform(0, 2, (16, 16, 3)).astype(np.float32) for _ in range(2)]
    calls = []
    evaluate = flip._evaluate
    monkeypatch.setattr(flip, "_evaluate", lambda *images: calls.append(1) or evaluate(*images))
    first, again, other = flip.hdr_flip(*pair), flip.hdr_flip(*pair), flip.hdr_flip(*pair[::-1])
    assert first == again
    assert first != other
    assert len(calls) == 2
    for entry in (tmp_path / "airlight" / "flip").iterdir():
        entry.write_text("nonsense")
    assert flip.hdr_flip(*pair) == first
    assert len(calls) == 3


def test_flip_works_without_a_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    picture = np.ones((16, 16, 3), np.float32)
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc/nowhere")
    assert flip.hdr_flip(picture, picture) == 0


def test_the_bound_of_a_deterministic_reference_is_no_noise() -> None:
    bound = np.full((4, 4, 3), 0.5)
    images = {"surface": np.zeros((4, 4, 3)), "scattering": np.ones((4, 4, 3))}
    errors = {"surface": np.zeros((4, 4, 3)), "scattering": bound}
    for stopped_by, bias in (("exact", 0.1), ("goal", 0.0)):
        estimate = SimpleNamespace(mean=images, standard_error=errors, stopped_by=stopped_by)
        made = Reference(estimate, {"scene": ""}, Goal())
        assert made.standard_error("scattering") is bound
        assert measure(images["scattering"] + 0.1, made.scattering, made.noise("scattering")).bias == pytest.approx(
            bias
        )
        assert compare(images["scattering"] + 0.1, made, layer="scattering").bias == pytest.approx(bias)
        read = Picture(Path("a.exr"), made.layers, {"stopped_by": stopped_by})
        assert compare(images["scattering"] + 0.1, read, layer="scattering").bias == pytest.approx(bias)
