"""The oracle: its bound holds where more digits are asked for, and other ways to the same number agree."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from exact_airlight import isotropic, oracle, rayleigh, tabulated
from mpmath import mp, mpf
from oracle_cases import FUNCTIONS, HARD, PHASES, TABLES, check_twenty_digits

from analytic import phase
from analytic.oracle import exact_airlight


@pytest.mark.parametrize("function", FUNCTIONS)
def test_more_digits_stay_within_the_bound(function):
    for segment in HARD:
        found, finer = exact_airlight(*segment, function), exact_airlight(*segment, function, digits=50)
        with mp.workdps(90):
            assert found.bound <= mpf(10) ** -30 * found.value
            assert finer.bound <= mpf(10) ** -50 * finer.value
            assert abs(found.value - finer.value) <= found.bound + finer.bound, segment


@pytest.mark.parametrize(("function", "exact"), PHASES)
def test_tanh_sinh_agrees(function, exact):
    for segment in (HARD[0], HARD[1], HARD[6]):
        # measured: 6e-31 at worst, with the 30 digits that the witness works in
        witness = oracle(*segment, exact)
        with mp.workdps(40):
            assert abs(exact_airlight(*segment, function).value / witness - 1) < 1e-27, segment


@pytest.mark.parametrize("function", FUNCTIONS[:2])
def test_equation_16_over_x_itself_agrees(function):
    law = {"isotropic": isotropic, "rayleigh": rayleigh}[function.name]
    h, x_a, x_b, sigma_t = HARD[0]
    with mp.workdps(40):

        def integrand(x):
            d = mp.sqrt(mpf(h) ** 2 + x**2)
            return mp.exp(-mpf(sigma_t) * (x - mpf(x_a) + d)) / d**2 * law(-x / d)

        witness = mp.quad(integrand, [x_a, -1, 0, 1, x_b])
        # measured: 1e-38
        assert abs(exact_airlight(h, x_a, x_b, sigma_t, function, digits=36).value / witness - 1) < 1e-35


def test_interval_arithmetic_encloses():
    """Upper and lower Riemann sums over s by mpmath.iv: crude, but they rest on nothing that the oracle uses."""
    h, x_a, x_b, sigma_t = HARD[0]
    iv, count = mpmath.iv, 200
    first, last = iv.log(x_a + iv.sqrt(x_a**2 + 1)), iv.log(x_b + iv.sqrt(iv.mpf(x_b) ** 2 + 1))
    width, total = (last - first) / count, iv.mpf(0)
    for k in range(count):
        s = first + width * iv.mpf([k, k + 1])
        e = iv.exp(s)
        # 1 / cosh s = 2 / (e^s + e^-s), cos theta = (1 - e^2s) / (1 + e^2s)
        cosine = (1 - e * e) / (1 + e * e)
        dimmed = iv.exp(-iv.mpf(sigma_t) * h * e + iv.mpf(sigma_t) * x_a)
        total += width * dimmed * 2 / (e + 1 / e) * 3 / (16 * iv.pi) * (1 + cosine * cosine)
    value = exact_airlight(h, x_a, x_b, sigma_t, phase("rayleigh")).value
    assert total.a <= value <= total.b
    # measured: the sums are 4 % apart
    assert total.delta < 0.05 * value


@pytest.mark.parametrize("values", TABLES)
def test_tables_that_fall_almost_to_zero(values):
    table = phase("tabulated", values=values)
    for segment in ((0.0, -9.0, -0.25, 0.3), (1e-12, -9.0, -8.0, 0.3), (0.0, 0.5, 7.0, 0.3), HARD[0]):
        check_twenty_digits(segment, table)


def test_random_tables():
    random = np.random.default_rng(6)
    for _ in range(25):
        values = 10 ** random.uniform(-25, 0, random.integers(2, 9)) * (random.random(1) < 0.8)
        values[random.integers(values.size)] = 1
        x_a = random.uniform(-5, 5)
        h, length = 10 ** random.uniform(-12, 1), 10 ** random.uniform(-3, 1)
        check_twenty_digits((h, x_a, x_a + length, 0.3), phase("tabulated", values=values))


def test_the_closed_forms_without_extinction_and_on_the_axis():
    with mp.workdps(60):
        clear = exact_airlight(0.5, -2.0, np.inf, 0.0, phase("isotropic"), digits=36)
        assert abs(clear.value - (mp.pi / 2 + mp.atan(4)) / (2 * mp.pi)) <= clear.bound
        x_a, x_b, sigma_t = mpf(0.5), mpf(7), mpf(0.3)
        behind = exact_airlight(0.0, 0.5, 7.0, 0.3, phase("isotropic"), digits=36)
        # by parts: the integral of e^{-2 sigma x} / x^2 from x on
        by_parts = [mp.exp(-2 * sigma_t * x) / x - 2 * sigma_t * mp.e1(2 * sigma_t * x) for x in (x_a, x_b)]
        exact = mp.exp(sigma_t * x_a) * (by_parts[0] - by_parts[1]) / (4 * mp.pi)
        assert abs(behind.value - exact) <= behind.bound
        before = exact_airlight(0.0, -9.0, -0.25, 0.3, phase("hg", g=0.5), digits=36)
        exact = mp.exp(-9 * sigma_t) * (4 - mpf(1) / 9) * mpf("0.75") / (4 * mp.pi * mpf("0.125"))
        assert abs(before.value - exact) <= before.bound


@pytest.mark.parametrize(("x_a", "x_b"), [(0.5, 7.0), (-9.0, -0.25)])
@pytest.mark.parametrize("function", FUNCTIONS[:-1])  # of the last, the limit is 0
def test_the_axis_is_a_limit(function, x_a, x_b):
    on, beside = exact_airlight(0.0, x_a, x_b, 0.3, function), exact_airlight(1e-9, x_a, x_b, 0.3, function)
    # measured: 3e-15, hg 0.95 on its peak
    assert abs(beside.value / on.value - 1) < 1e-12


def test_a_fine_table():
    table = phase("tabulated", values=phase("hg", g=0.9).evaluate(np.linspace(-1, 1, 61)))
    found = exact_airlight(*HARD[0], table)
    with mp.workdps(40):
        # the table's values as it keeps them, normalised and rounded; measured: 5e-31
        assert abs(found.value / oracle(*HARD[0], tabulated(table.values)) - 1) < 1e-27


def test_where_a_table_is_zero_it_is_dark():
    forward = phase("tabulated", values=(0.0, 0.0, 1.0))
    # behind the light's projection cos theta < 0
    assert exact_airlight(1.0, 0.5, 3.0, 0.2, forward).value == 0
    across = exact_airlight(1.0, -1e-30, 3.0, 0.2, forward)
    assert 0 < across.value < 1e-55
    assert across.bound <= across.value * mpf(10) ** -30
