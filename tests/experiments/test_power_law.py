"""Fitted exponents against known laws, and how often their interval holds the true one."""

from __future__ import annotations

import numpy as np
import pytest

from experiments.studies.power_law import CONFIDENCE, power_law


def test_a_law_without_scatter_is_found_exactly() -> None:
    x = np.array([1.0, 2.0, 4.0, 8.0])
    fit = power_law(x, 3.0 * x**-1.75)
    # measured: 4.4e-16 and 0
    assert fit.exponent == pytest.approx(-1.75, abs=1e-14)
    assert fit.factor == pytest.approx(3.0, rel=1e-14)
    # measured: 1.5e-15; what is left is rounding
    assert fit.high - fit.low < 1e-13
    assert fit.n == 4
    np.testing.assert_allclose(fit(x), 3.0 * x**-1.75, rtol=1e-13)


def test_the_interval_is_students() -> None:
    # log2 y = 0, 1, 1 at log2 x = 0, 1, 2: slope 1/2, residuals -1/6, 1/3, -1/6, so a standard error of
    # sqrt((1/6) / (1 * 2)); t(0.975, 1) = tan(0.475 pi)
    fit = power_law([1, 2, 4], [1, 2, 2])
    reach = np.tan(0.475 * np.pi) * np.sqrt(1 / 12)
    # measured: 2e-14
    np.testing.assert_allclose([fit.exponent, fit.low, fit.high], [0.5, 0.5 - reach, 0.5 + reach], rtol=1e-12)


def test_the_interval_holds_the_exponent_as_often_as_it_says() -> None:
    generator, x = np.random.default_rng(6), np.array([16.0, 32, 64, 128, 256])
    hits = 0
    for _ in range(400):
        fit = power_law(x, 0.2 * x**-1.0 * np.exp(generator.normal(0, 0.1, x.size)))
        hits += fit.low <= -1.0 <= fit.high
    # 3 standard deviations of a binomial with 400 draws are 13
    assert abs(hits - CONFIDENCE * 400) <= 13


def test_groups_share_the_exponent_and_have_factors_of_their_own() -> None:
    x = np.array([1.0, 2, 4, 8, 1, 2, 4, 8, 3])
    groups = ["a"] * 4 + ["b"] * 4 + ["alone"]
    factors = np.array([1.0] * 4 + [50.0] * 4 + [7.0])
    fit = power_law(x, factors * x**2, groups)
    assert fit.exponent == pytest.approx(2.0, abs=1e-13)
    # without groups the second's height would be taken for growth, and widen the interval
    assert power_law(x, factors * x**2).high - fit.high > 1
    # the same as with a dummy variable a group
    scattered = factors * x**2 * np.exp([0.1, -0.1, 0.2, 0.0, 0.3, -0.2, 0.1, 0.1, 0.5])
    dummies = np.array([[group == name for name in ("a", "b", "alone")] for group in groups], float)
    design = np.column_stack([np.log(x), dummies])
    solution, squares, *_ = np.linalg.lstsq(design, np.log(scattered), rcond=None)
    error = np.sqrt(squares[0] / (9 - 4) * np.linalg.inv(design.T @ design)[0, 0])
    fit = power_law(x, scattered, groups)
    # 2.5706: Student's 97.5 % with 5 degrees of freedom, from a printed table
    np.testing.assert_allclose(
        [fit.exponent, fit.low, fit.high], solution[0] + error * np.array([0, -2.5706, 2.5706]), rtol=1e-5
    )
    with pytest.raises(ValueError, match="more than groups by 2"):
        power_law([1, 2, 1, 2], [1, 2, 3, 4], ["a", "b", "c", "d"])
    with pytest.raises(ValueError, match="within its groups"):
        power_law([1, 1, 2, 2], [1, 2, 3, 4], ["a", "a", "b", "b"])


@pytest.mark.parametrize(
    ("x", "y", "message"),
    [
        ([1, 2], [1, 2], "3 values or more"),
        ([2, 2, 2], [1, 2, 3], "must not be all the same"),
        ([1, 2, 3], [1, 0, 2], "y must be positive"),
        ([1, -2, 3], [1, 1, 2], "x must be positive"),
        ([1, 2, 3], [1, float("nan"), 2], "y must be positive"),
        ([1, 2, 3], [1, 2], "one length"),
        ([], [], "3 values or more"),
    ],
)
def test_what_no_law_can_have_is_refused(x, y, message) -> None:
    with pytest.raises(ValueError, match=message):
        power_law(x, y)
