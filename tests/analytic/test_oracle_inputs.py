"""What the oracle takes and refuses, and the far ends of it."""

from __future__ import annotations

import numpy as np
import pytest
from mpmath import mp, mpf
from oracle_cases import FUNCTIONS, check_twenty_digits

from analytic import Medium, airlight, phase
from analytic.oracle import exact_airlight
from analytic.oracle.gauss import gauss_legendre


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((-1.0, 0.0, 1.0, 0.1), "h"),
        ((np.nan, 0.0, 1.0, 0.1), "h"),
        ((1.0, -np.inf, 1.0, 0.1), "x_a"),
        ((1.0, 2.0, 1.0, 0.1), "x_b"),
        ((1.0, 0.0, np.nan, 0.1), "x_b"),
        ((1.0, 0.0, 1.0, -0.1), "sigma_t"),
        ((1.0, 0.0, 1.0, np.inf), "sigma_t"),
        ((0.0, -1.0, 1.0, 0.1), "h"),
    ],
)
def test_bad_values_are_named(arguments, name):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        exact_airlight(*arguments, phase("isotropic"))


@pytest.mark.parametrize("bad", ["1", 1j, None, np.ones(2), [1.0, 2.0], object()])
@pytest.mark.parametrize("place", range(4))
def test_what_is_no_number_is_named(place, bad):
    arguments = [1.0, 0.0, 1.0, 0.1]
    arguments[place] = bad
    with pytest.raises(ValueError, match=rf"^{('h', 'x_a', 'x_b', 'sigma_t')[place]} must"):
        exact_airlight(*arguments, phase("isotropic"))


@pytest.mark.parametrize("digits", [0, -3, 2.5, 30.0, True, None, "30", np.nan])
def test_bad_digits_are_named(digits):
    with pytest.raises(ValueError, match=r"^digits must"):
        exact_airlight(1.0, 0.0, 1.0, 0.1, phase("isotropic"), digits=digits)


def test_bad_phases_are_named():
    with pytest.raises(ValueError, match=r"^phase must"):
        exact_airlight(1.0, 0.0, 1.0, 0.1, "isotropic")


def test_numbers_of_every_type_are_exactly_what_they_are():
    function = phase("isotropic")
    value = exact_airlight(1.0, -2.0, 3.0, 0.25, function).value
    for kind in (int, np.float32, np.float64, np.array, mpf):
        assert exact_airlight(kind(1), kind(-2), kind(3), 0.25, function, np.int64(30)).value == value
    with mp.workdps(10):  # of the caller: what is finer comes in as it is
        assert exact_airlight(1.0, -2.0, 3.0, 0.25, function).value == value
    with mp.workdps(60):
        shifted = exact_airlight(1.0, -2.0, mpf(3) + mpf(10) ** -40, 0.25, function, 45).value
        before = exact_airlight(1.0, -2.0, 3.0, 0.25, function, 45).value
        slope = mp.exp(-mpf(0.25) * (5 + mp.sqrt(10))) / 10 / (4 * mp.pi)
        # measured: 4e-6, of 45 digits
        assert abs((shifted - before) / (slope * mpf(10) ** -40) - 1) < 1e-4
    huge = 2**70 + 1
    with mp.workdps(60):
        assert exact_airlight(huge, 0, 1, 0, function).value != exact_airlight(2**70, 0, 1, 0, function).value


def test_a_segment_thinner_than_float64_tells():
    """Of an mpf length, beside the integrand at its start; next to the table's kink the bound asks for 840 digits."""
    length, function = mpf(10) ** -400, phase("tabulated", values=(1.0, 0.0, 1.0))
    with mp.workdps(60):
        found = exact_airlight(1.0, 0.0, length, 0.3, function).value
        # p = |cos theta| / (2 pi), cos theta = -x / h: e^{-sigma h} x^2 / (4 pi)
        assert abs(found / (mp.exp(-mpf(0.3)) * length**2 / (4 * mp.pi)) - 1) < 1e-29
        even = exact_airlight(1.0, 0.0, length, 0.3, phase("isotropic")).value
        assert abs(even / (mp.exp(-mpf(0.3)) * length / (4 * mp.pi)) - 1) < 1e-29


def test_what_short_segments_cost_is_nodes_for_the_digits_asked(monkeypatch):
    """A length of 1e-200 next to a kink needs 440 digits, not as many nodes."""
    counts = []

    def counted(count, precision):
        counts.append(count)
        return gauss_legendre(count, precision)

    monkeypatch.setattr("analytic.oracle.airlight.gauss_legendre", counted)
    exact_airlight(1.0, 0.0, 1e-200, 0.3, phase("tabulated", values=(1.0, 0.0, 1.0)))
    # measured: 39
    assert max(counts) < 60


@pytest.mark.parametrize("function", FUNCTIONS[:3])
@pytest.mark.parametrize(
    "segment",
    [
        (1e-300, -1.0, 1e146, 0.1),
        (1e-320, -1.0, np.inf, 0.0),
        (1e-300, -3.0, 1e308, 1e-320),
        (1e100, -1e100, 1.0, 1e100),
        (0.0, 1e-300, 1e300, 1e300),
    ],
)
def test_far_ends_of_float64(segment, function):
    check_twenty_digits(segment, function)


def test_a_depth_beyond_float64_is_refused():
    with pytest.raises(ValueError, match=r"^sigma_t must"):
        exact_airlight(1e300, -1e300, 1.0, 1e300, phase("isotropic"))


@pytest.mark.parametrize(("h", "x"), [(1.0, 2.0), (0.0, 2.0), (0.0, -2.0), (0.0, 0.0)])
def test_an_empty_segment_is_dark(h, x):
    assert exact_airlight(h, x, x, 0.1, phase("isotropic")).value == 0
    assert airlight(h, x, x, Medium(sigma_s=0.1, sigma_t=0.1), phase("isotropic")) == 0
