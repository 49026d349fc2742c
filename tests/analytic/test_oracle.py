"""The oracle: its bound holds, its proof's inequalities hold, and other ways to the same number agree."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from exact_airlight import cornette_shanks, henyey_greenstein, isotropic, oracle, rayleigh, schlick, tabulated
from mpmath import mp, mpf

from analytic import phase
from analytic.oracle import exact_airlight
from analytic.oracle.gauss import gauss_legendre
from analytic.oracle.integrands import BehindTheLight, BesideTheLight
from analytic.oracle.panels import LARGEST_B, _log_error, _log_exponential
from analytic.oracle.phases import exact_phase

FIVE = (0.5, 1.0, 1.5, 2.0, 5.0)
HARD = [  # h, x_a, x_b, sigma_t
    (1.0, -2.0, 3.0, 0.2),
    (0.7, 1.0, 6.0, 1.5),
    (1e-6, -5.0, 5.0, 0.1),  # almost through the light
    (1e-6, 3.0, 4.0, 50.0),  # an optical depth of 300 behind the light
    (100.0, -50.0, 80.0, 0.5),
    (0.3, -7.0 - 1e-6, -7.0, 0.4),  # 1e-6 long
    (2.0, -1.0, 1e6, 25.0),  # opaque
    (0.05, -3.0, np.inf, 0.7),
    (1.0, -2.0, np.inf, 0.0),
    (0.0, 0.5, 7.0, 0.3),  # on the light's axis, behind it and before it
    (0.0, -9.0, -0.25, 0.3),
]
PHASES = [
    pytest.param(phase("isotropic"), isotropic, id="isotropic"),
    pytest.param(phase("rayleigh"), rayleigh, id="rayleigh"),
    pytest.param(phase("hg", g=0.95), henyey_greenstein(0.95), id="hg 0.95"),
    pytest.param(phase("hg", g=-0.8), henyey_greenstein(-0.8), id="hg -0.8"),
    pytest.param(phase("schlick", k=0.9), schlick(0.9), id="schlick 0.9"),
    pytest.param(phase("cornette_shanks", g=0.9), cornette_shanks(0.9), id="cornette_shanks 0.9"),
    pytest.param(phase("tabulated", values=FIVE), tabulated(FIVE), id="tabulated 5"),
    pytest.param(phase("tabulated", values=(0.0, 1.0, 0.0)), tabulated((0.0, 1.0, 0.0)), id="tabulated 0 1 0"),
]
FUNCTIONS = [pytest.param(parameter.values[0], id=parameter.id) for parameter in PHASES]


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


def integrand_of(segment, function):
    h, x_a, x_b, sigma_t = (mpf(value) for value in segment)
    exact = exact_phase(function)
    return BesideTheLight(h, x_a, x_b, sigma_t, exact) if h else BehindTheLight(x_a, x_b, sigma_t, exact)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_the_bound_in_the_complex_plane_holds(function):
    """M against the integrand itself, at random points with |Im t| <= b: the inequalities of the proof."""
    random = np.random.default_rng(3)
    tightest = math.inf
    # the second passes ln((1 - g) / (1 + g)), next to which the base of a lobe vanishes
    for segment in (HARD[0], (1.0, -20.0, 3.0, 0.2), HARD[3], HARD[9]):
        integrand = integrand_of(segment, function)
        for _, _, piece in integrand.pieces():
            for _ in range(60):
                low, b = random.uniform(-1, 4), random.uniform(0, LARGEST_B)
                high = low + 10 ** random.uniform(-2, 0.3)
                bound = integrand.log_bound(low, high, b, piece) + _log_exponential(integrand, low, b)
                t = mp.mpc(random.choice([low, high, random.uniform(low, high)]), random.choice([b, -b, 0]))
                growth = mp.exp(t)
                value = integrand.factor(growth, piece)[0] * mp.exp(integrand.rate * (1 - growth))
                margin = bound - float(mp.log(abs(value))) if value else math.inf
                assert margin > -1e-6, (segment, low, high, b, t)
                tightest = min(tightest, margin)
    # a bound that could be e times smaller would leave more
    assert tightest < 1


def test_the_bound_of_a_panel_holds():
    """Six nodes a panel, so that there is an error to see; the bound of twelve would not hold."""
    random = np.random.default_rng(4)
    nodes, fine = gauss_legendre(6, 200), gauss_legendre(60, 200)
    too_small = 0
    with mp.workprec(200):
        for _ in range(40):
            integrand = integrand_of(HARD[random.integers(0, 2)], FUNCTIONS[random.integers(0, 6)].values[0])
            ((_, _, piece),) = integrand.pieces()
            middle, half = random.uniform(0, 2), 10 ** random.uniform(-1, 0)

            def rule(points, middle=middle, half=half, integrand=integrand, piece=piece):
                growths = [(mp.exp(middle + half * node), weight) for node, weight in points]
                return half * sum(
                    weight * integrand.factor(growth, piece)[0] * mp.exp(integrand.rate * (1 - growth))
                    for growth, weight in growths
                )

            error = mp.log(abs(rule(nodes) - rule(fine)))
            assert error < _log_error(integrand, piece, middle, half, 6)[0]
            too_small += error > _log_error(integrand, piece, middle, half, 12)[0]
    # measured: 40 of 40
    assert too_small > 30


def test_gauss_nodes():
    nodes = gauss_legendre(33, 140)
    with mp.workprec(140):
        for power in (0, 2, 30, 64, 65):
            exact = mpf(2) / (power + 1) if power % 2 == 0 else 0
            # measured: 9e-44
            assert abs(mp.fsum(weight * node**power for node, weight in nodes) - exact) < 1e-40
        # the first power that 33 nodes do not integrate
        assert abs(mp.fsum(weight * node**66 for node, weight in nodes) - mpf(2) / 67) > 1e-21


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


def test_a_planted_error_in_the_integrand_is_seen(monkeypatch):
    """As small as 1e-29 of it, beside the closed form by Ei."""
    right = exact_airlight(1.0, -2.0, 3.0, 0.2, phase("isotropic"))
    factor = BesideTheLight.factor

    def planted(self, growth, piece):
        value, size = factor(self, growth, piece)
        return value * (1 + mpf(10) ** -29), size

    monkeypatch.setattr(BesideTheLight, "factor", planted)
    wrong = exact_airlight(1.0, -2.0, 3.0, 0.2, phase("isotropic"))
    with mp.workdps(60):
        sigma_t = mpf(0.2)

        def antiderivative(x):
            z = mp.ei(mp.mpc(-sigma_t * (x + mp.sqrt(1 + mpf(x) ** 2)), -sigma_t))
            return -mp.sin(sigma_t) * z.real - mp.cos(sigma_t) * z.imag

        exact = mp.exp(-2 * sigma_t) / (2 * mp.pi) * (antiderivative(3) - antiderivative(-2))
        assert abs(right.value - exact) <= right.bound
        assert abs(wrong.value - exact) > wrong.bound


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


def test_bad_digits_and_phases_are_named():
    with pytest.raises(ValueError, match=r"^digits must"):
        exact_airlight(1.0, 0.0, 1.0, 0.1, phase("isotropic"), digits=0)
    with pytest.raises(ValueError, match=r"^phase must"):
        exact_airlight(1.0, 0.0, 1.0, 0.1, "isotropic")


def test_an_empty_segment_is_dark():
    assert exact_airlight(1.0, 2.0, 2.0, 0.1, phase("isotropic")).value == 0
