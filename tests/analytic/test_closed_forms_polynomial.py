"""Phase functions as polynomials, and the repaired closed form that is exact for them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import mpmath
import numpy as np
import pytest
from exact_airlight import cornette_shanks, henyey_greenstein, rayleigh, schlick
from scipy.special import expi

from analytic import MODELS, phase
from analytic.models.weng2010.combined import combined
from analytic.models.weng2010.polynomials import near_minimax, taylor
from analytic.phase import Phase
from analytic.segments import Segments

SMOOTH = [
    pytest.param(phase("rayleigh"), rayleigh, id="rayleigh"),
    *(pytest.param(phase("hg", g=g), henyey_greenstein(g), id=f"hg {g}") for g in (0.3, -0.6, 0.9)),
    pytest.param(phase("schlick", k=0.8), schlick(0.8), id="schlick 0.8"),
    pytest.param(phase("cornette_shanks", g=-0.7), cornette_shanks(-0.7), id="cornette_shanks -0.7"),
]


@dataclass(frozen=True)
class Polynomial(Phase):
    """Sum of c_n v^n before the light and of d_n w^n, w = -1/v, behind it: not continuous at v = 1, hence the kink."""

    front: tuple[float, ...]
    back: tuple[float, ...]
    name: ClassVar[str] = "polynomial"

    def of_half_angle(self, cos2, sin2):
        with np.errstate(divide="ignore"):
            v = np.sqrt(sin2 / cos2)
            before, behind = (np.polynomial.polynomial.polyval(x, c) for x, c in ((v, self.front), (-1 / v, self.back)))
        return np.where(v <= 1, before, behind)

    @property
    def mean_cosine(self):
        raise AssertionError("no model asks for it")

    @property
    def kinks(self):
        return (0.0,)


def segments(count, dtype, seed, smallest=0.05):
    """Segments in `dtype` and as float64 sees them: H from `smallest` to 20, a third each before, around, behind."""
    random = np.random.default_rng(seed)
    sigma_t, optical_h = (
        10 ** random.uniform(-1, 1, count),
        10 ** random.uniform(np.log10(smallest), np.log10(20), count),
    )
    start, length = random.uniform(-6, 4, count), 10 ** random.uniform(-2, 1, count)
    given = Segments.between(optical_h / sigma_t, start / sigma_t, (start + length) / sigma_t, sigma_t).astype(dtype)
    return given, given.astype(np.float64)


def terms_of(s, front, back):
    """Moduli of all terms of Eqs. 24 and 29, with the growth of the rounding of their arguments, (n,).

    int e^{-Hv} v^n / (1 + v^2) is the alternating sum of int e^{-Hv} v^m, m = n-2, n-4, ..., and of i_0 or i_1.
    """
    h, limits = (
        s.optical_h,
        (np.minimum(s.v_a, 1), np.minimum(s.v_b, 1), np.minimum(1 / s.v_a, 1), np.minimum(1 / s.v_b, 1)),
    )
    total = np.zeros_like(h)
    circle = np.abs(np.sin(h)) + np.abs(np.cos(h))
    for v in limits[:2]:
        singular = np.abs(expi(-h * v - 1j * h)) * circle
        for n, c in enumerate(front):
            total += abs(c) * singular * (s.x_a < 0)
            for m in range(n - 2, -1, -2):
                for i in range(m + 1):
                    total += abs(c) * np.exp(-h * v) * math.perm(m, i) * v ** (m - i) / h ** (i + 1) * (s.x_a < 0)
    for w in limits[2:]:
        real = np.abs(expi(-h / w))
        singular = np.abs(expi(-h / w + 1j * h)) * circle + real
        for n, d in enumerate(back):
            total += abs(d) * singular * (s.x_b > 0)
            for m in range(n - 2, -1, -2):
                total += abs(d) * real * h ** (m + 1) / math.factorial(m + 1) * (s.x_b > 0)
                for i in range(m + 1):
                    size = h**i * math.factorial(m - i) / math.factorial(m + 1)
                    total += abs(d) * np.exp(-h / w) * w ** (m - i + 1) * size * (s.x_b > 0)
    return 2 * np.exp(s.sigma_t * s.x_a) / s.h * total * (1 + h + np.abs(s.sigma_t * s.x_a))


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_any_polynomial_is_integrated_as_well_as_its_terms_allow(seed, dtype):
    random = np.random.default_rng(seed)
    front, back = (tuple(random.uniform(-1, 1, 7).astype(np.float32).tolist()) for _ in range(2))
    given, wide = segments(1500, dtype, seed)
    truth, terms = MODELS["quadrature"].function(wide, Polynomial(front, back)), terms_of(wide, front, back)
    for reuse in (False, True):
        value = combined(given, front, back, reuse=reuse)
        assert value.dtype == dtype
        # measured: 0.64 at worst over 12 x 5,000 segments
        assert np.all(np.abs(value - truth) <= 1.0 * np.finfo(dtype).eps * terms)


def test_polynomials_in_clear_media():
    random = np.random.default_rng(9)
    front, back = (tuple(random.uniform(0, 1, 7).tolist()) for _ in range(2))
    h, x_a = random.uniform(0.1, 3, 200), random.uniform(-5, 3, 200)
    clear = Segments.between(h, x_a, x_a + random.uniform(0.5, 5, 200), np.zeros(200))
    truth = MODELS["quadrature"].function(clear, Polynomial(front, back))
    np.testing.assert_allclose(combined(clear, front, back, reuse=True), truth, rtol=4e-15)  # measured: 1.3e-15


@pytest.mark.parametrize(("function", "exact"), SMOOTH)
def test_taylor_coefficients(function, exact):
    with mpmath.workdps(30):
        front = mpmath.taylor(lambda v: exact((1 - v * v) / (1 + v * v)), 0, 12)
        back = mpmath.taylor(lambda w: exact((w * w - 1) / (w * w + 1)), 0, 12)
    for value, right in zip(taylor(function, 13), (front, back), strict=True):
        right = np.array(right, dtype=float)
        # measured: 4.7e-13
        np.testing.assert_allclose(value, np.where(np.arange(13) % 2, 0, right), rtol=1e-12)


def worst_relative_error(function, coefficients):
    """Of both polynomials over both sides, evaluated with 40 digits: powers of v cancel."""
    v, worst = np.linspace(1e-3, 1, 201), 0.0
    for x, side in zip((v, -v), coefficients, strict=True):
        cosine = np.copysign(1 - v * v, x) / (1 + v * v)
        with mpmath.workdps(40):
            value = np.array([float(mpmath.polyval(side, t, asc=True)) for t in x])
        worst = max(worst, np.max(np.abs(value / function.evaluate(cosine) - 1)))
    return worst


@pytest.mark.parametrize(
    ("function", "percent", "per_mille"),
    [
        (phase("rayleigh"), 5, 7),
        (phase("hg", g=0.3), 5, 8),
        (phase("hg", g=0.6), 9, 13),
        (phase("schlick", k=0.9), 10, 14),
        (phase("cornette_shanks", g=0.8), 14, 20),
    ],
)
def test_terms_of_near_minimax_coefficients(function, percent, per_mille):
    for wanted, terms in ((1e-2, percent), (1e-3, per_mille)):
        assert worst_relative_error(function, near_minimax(function, terms)) < wanted
        assert worst_relative_error(function, near_minimax(function, terms - 1)) > wanted


def test_powers_of_v_hold_no_sharp_peak():
    # HG 0.9 needs 30 terms for 0.1 %, but the rounding of coefficients of 1e17 leaves nothing of them
    sharp = phase("hg", g=0.9)
    assert worst_relative_error(sharp, near_minimax(sharp, 21)) < 1e-2
    assert worst_relative_error(sharp, near_minimax(sharp, 30)) > 1


@pytest.mark.parametrize(("name", "terms"), [("rayleigh", 5), ("hg", 5), ("hg", 7)])
def test_minimax_airlight_is_as_good_as_its_polynomial(name, terms):
    # airlight is an average of the phase function with positive weights: its relative error is no larger
    function = phase(name) if name == "rayleigh" else phase(name, g=0.3)
    _, wide = segments(3000, np.float64, seed=4)
    front, back = near_minimax(function, terms)
    v = np.linspace(1e-6, 1, 2001)
    cosine = (1 - v * v) / (1 + v * v)
    largest = max(
        np.max(np.abs(np.polynomial.polynomial.polyval(x, c) / function.evaluate(y) - 1))
        for x, c, y in ((v, front, cosine), (-v, back, -cosine))
    )
    truth = MODELS["quadrature"].function(wide, function)
    value = MODELS["weng2010:minimax"].function(wide, function, terms=terms)
    rounding = 2 * np.finfo(float).eps * terms_of(wide, front, back)
    assert np.all(np.abs(value - truth) <= 1.001 * largest * truth + rounding)
    assert np.mean(rounding < 1e-3 * truth) > 0.9


def test_the_taylor_series_does_not_converge_around_the_light():
    # at v = 1 it is evaluated on its circle of convergence (Rayleigh) or beyond it (HG)
    optical_h = np.linspace(0.5, 3, 20)
    around = Segments.between(optical_h, -3 * optical_h, 3 * optical_h, np.ones(20))
    for function, least in ((phase("rayleigh"), 0.2), (phase("hg", g=0.3), 1.0)):
        truth = MODELS["quadrature"].function(around, function)
        for terms in (5, 7, 9, 13):
            value = MODELS["weng2010:taylor"].function(around, function, terms=terms)
            # measured: 0.20 to 0.63 (Rayleigh), 1.04 to 183 (HG 0.3), growing with the number of terms
            assert np.all(np.abs(value / truth - 1) > least)


@pytest.mark.parametrize("name", ["weng2010:taylor", "weng2010:minimax", "weng2010:printed", "pegoraro2009"])
@pytest.mark.parametrize("terms", [0, 101])
def test_numbers_of_terms_are_checked(name, terms):
    _, wide = segments(3, np.float64, seed=6)
    with pytest.raises(ValueError, match=r"^terms must"):
        MODELS[name].function(wide, phase("rayleigh"), terms=terms)


def test_three_and_four_evaluations_agree_to_the_last_digit():
    _, wide = segments(1000, np.float64, seed=7)
    for function in (phase("isotropic"), phase("hg", g=0.4)):
        np.testing.assert_array_equal(
            MODELS["pegoraro2009"].function(wide, function), MODELS["weng2010:taylor"].function(wide, function)
        )
