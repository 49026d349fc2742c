"""The oracle's proof, inequality by inequality."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mpmath import mp, mpf
from oracle_cases import FUNCTIONS, HARD, TABLES

from analytic import phase
from analytic.oracle import exact_airlight
from analytic.oracle.airlight import _evaluate
from analytic.oracle.gauss import gauss_legendre
from analytic.oracle.integrands import BehindTheLight, BesideTheLight
from analytic.oracle.panels import LARGEST_B, _log_error, _log_exponential
from analytic.oracle.phases import exact_phase


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


class OneChebyshevPolynomial:
    """What `_log_error` asks of an integrand, of T_n alone: |T_n| <= (rho^n + rho^-n) / 2 on the ellipse of rho."""

    rate = 0.0

    def __init__(self, n, half):
        self.n, self.half = n, half

    def log_bound(self, low, high, b, piece):
        rho = ((high - low) / 2 + b) / self.half
        return math.log((rho**self.n + rho**-self.n) / 2)


def test_the_bound_of_a_panel_is_nearly_met():
    """By the polynomial of the first degree that n nodes miss; half the bound would be too little."""
    n, half = 9, 0.25
    with mp.workdps(40):
        found = mp.fsum(w * mp.cos(2 * n * mp.acos(x)) for x, w in gauss_legendre(n, mp.prec))
        error = half * abs(found - mpf(2) / (1 - 4 * n**2))
    ratio = float(error) / math.exp(_log_error(OneChebyshevPolynomial(2 * n, half), None, 0.0, half, n)[0])
    # measured: 0.71
    assert 0.6 < ratio <= 1


@pytest.mark.parametrize("kind", ["beside", "behind", "before"])
def test_the_bound_of_rounding_holds(kind):
    """At 15 digits and a depth of 2e5 to the light, where rounding is all that there is to see."""
    random = np.random.default_rng(5)
    largest = 0.0
    with mp.workdps(60):
        for _ in range(12):
            far = 1e6 * random.uniform(1, 2)
            h, x_a, x_b = {
                "beside": (1.0, -far, 3.0),
                "behind": (0.0, far, 2 * far),
                "before": (0.0, -far, -far / 2),
            }[kind]
            arguments = (mpf(h), mpf(x_a), mpf(x_b), mpf(0.2), phase("rayleigh"), 15)
            exact = _evaluate(*arguments)[0]
            with mp.workdps(15):
                value, truncation, rounding = _evaluate(*arguments)
            assert abs(value - exact) <= truncation + rounding
            assert rounding < 1e-5 * value
            largest = max(largest, abs(value - exact) / value)
    # far beyond a bound of the ends and kinks alone; measured: 4e-11, 5e-11, 3e-11
    assert largest > 1e-11


def test_a_line_rounds_within_its_size():
    """Coefficients and all, at 15 digits: also where its terms cancel, next to a kink."""
    random = np.random.default_rng(7)
    worst = beside_the_value = 0.0
    for values in [*TABLES, tuple(range(1, 62))]:
        table = phase("tabulated", values=values)
        with mp.workdps(15):
            coarse, eps = exact_phase(table), +mp.eps
        with mp.workdps(60):
            fine = exact_phase(table)
            for s in [*random.uniform(-30, 30, 20), *(float(kink) + 1e-9 for kink in fine.kinks[:9])]:
                cos2 = 1 / (1 + mp.exp(2 * mpf(s)))
                sin2 = 1 - cos2
                for rough, exact in zip(coarse.pieces, fine.pieces, strict=True):
                    with mp.workdps(15):
                        value, size = rough.value(+cos2, +sin2), rough.size(+cos2, +sin2)
                    error = abs(value - exact.value(cos2, sin2)) / eps
                    worst = max(worst, error / size if size else error)
                    beside_the_value = max(beside_the_value, error / abs(value) if value else 0.0)
    # measured: 1.2, and 1.1e8 relative to the value
    assert worst < 4
    assert beside_the_value > 1e6


@pytest.mark.parametrize(("count", "precision"), [(6, 60), (33, 140), (120, 1200)])
def test_gauss_nodes_are_the_zeros_of_the_legendre_polynomial(count, precision):
    nodes = gauss_legendre(count, precision)
    assert len(nodes) == count
    with mp.workprec(precision):
        # measured: 0.6 eps at most
        assert abs(mp.fsum(weight for _, weight in nodes) - 2) < 4 * mp.eps
        for n in (1, 2, count, 2 * count - 1):
            assert abs(mp.fsum(weight * mp.legendre(n, node) for node, weight in nodes)) < 4 * mp.eps


def test_gauss_nodes():
    nodes = gauss_legendre(33, 140)
    with mp.workprec(140):
        for power in (0, 2, 30, 64, 65):
            exact = mpf(2) / (power + 1) if power % 2 == 0 else 0
            # measured: 9e-44
            assert abs(mp.fsum(weight * node**power for node, weight in nodes) - exact) < 1e-40
        # the first power that 33 nodes do not integrate
        assert abs(mp.fsum(weight * node**66 for node, weight in nodes) - mpf(2) / 67) > 1e-21


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
