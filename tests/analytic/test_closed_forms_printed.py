"""The thesis as printed, against a second reading of the print in 30 digits, and against what is right."""

from __future__ import annotations

import warnings

import mpmath
import numpy as np
import pytest
from exact_airlight import henyey_greenstein, isotropic, oracle, rayleigh

from analytic import MODELS, phase
from analytic.segments import Segments

PRINTED = MODELS["weng2010:printed"].function
HERE = [(1.0, -4.0, -1.5, 0.6), (0.5, -2.0, 3.0, 0.8), (2.0, 0.5, 3.0, 0.4)]  # h, x_a, x_b, sigma_t


def ei(z):
    return -mpmath.e1(-z) + 1j * mpmath.pi * mpmath.sign(mpmath.im(z))


def i(n, a, v):
    value = ei(a * v + 1j * a)
    s, c = mpmath.sin(a), mpmath.cos(a)
    return s * value.real - c * value.imag if n == 0 else c * value.real + s * value.imag


def j(n, a, w):
    """Eq. 31, which is right."""
    return -i(0, a, 1 / w) if n == 0 else i(1, a, 1 / w) - mpmath.ei(a / w)


def c(a, j_, n):
    return sum(
        (-1) ** ((n - k - j_) // 2) * mpmath.factorial(k + j_) / mpmath.factorial(j_) * (-1 / a) ** (k + 1)
        for k in range((n - 2 - j_) % 2, n - 1 - j_, 2)
    )


def d(a, j_, n):
    return sum(
        (-1) ** ((n - k - j_) // 2) * mpmath.factorial(j_) / mpmath.factorial(k + j_ + 1) * a**k
        for k in range((n - 2 - j_) % 2, n - 1 - j_, 2)
    )


def eq24(h, x_a, x_b, sigma_t, front):
    """Eq. 24; with the constant c_0 of the isotropic function it is Eq. 21."""
    hh, (v_a, v_b) = h * sigma_t, (x / h + mpmath.sqrt(1 + (x / h) ** 2) for x in (x_a, x_b))
    total = 0
    for n, c_n in enumerate(front):
        ends = sum(
            (mpmath.exp(-hh * v_b) * v_b**k - mpmath.exp(-hh * v_a) * v_a**k) * c(-hh, k, n) for k in range(n - 1)
        )
        sign = (-1) ** ((n % 4) // 2)
        total += c_n * (ends + sign * (i(n % 2, -hh, v_b) - i(n % 2, -hh, v_a)))
    return mpmath.exp(sigma_t * (x_a - x_b)) / h * 2 * total


def eq27(h, x_a, x_b, sigma_t):
    hh, (w_a, w_b) = h * sigma_t, (x / h - mpmath.sqrt(1 + (x / h) ** 2) for x in (x_a, x_b))
    return mpmath.exp(sigma_t * (x_a - x_b)) / h * 2 / (4 * mpmath.pi) * (j(0, -hh, w_b) - j(0, -hh, w_a))


def eq29(h, x_a, x_b, sigma_t, back, at_light=None):
    """Eq. 29; `at_light` gives j_n(H, -1) where Figure 4.11 says how to get it."""
    hh, (w_a, w_b) = h * sigma_t, (x / h - mpmath.sqrt(1 + (x / h) ** 2) for x in (x_a, x_b))
    total = 0
    for n, d_n in enumerate(back):
        lower = at_light(n % 2) if at_light else j(n % 2, hh, w_a)
        ends = sum(
            (mpmath.exp(hh / w_b * w_b ** (k + 1)) - mpmath.exp(hh / w_a * w_a ** (k + 1))) * d(hh, k, n)
            for k in range(n - 1)
        )
        real = (mpmath.ei(hh / w_b) - mpmath.ei(hh / w_a)) * hh * d(hh, 0, n)
        total += d_n * (-ends + (-1) ** (n // 2) * (j(n % 2, hh, w_b) - lower) + real)
    return mpmath.exp(sigma_t * x_a) / h * 2 * total


def second_reading(h, x_a, x_b, sigma_t, front, back):
    """Figure 4.8's choice among the equations; Eq. 27 where there is but one coefficient."""
    with mpmath.workdps(30):
        h, x_a, x_b, sigma_t = (mpmath.mpf(value) for value in (h, x_a, x_b, sigma_t))
        hh, isotropic_one = h * sigma_t, len(back) == 1
        if x_b <= 0:
            return eq24(h, x_a, x_b, sigma_t, front)
        if x_a >= 0:
            return eq27(h, x_a, x_b, sigma_t) if isotropic_one else eq29(h, x_a, x_b, sigma_t, back)

        def figure_4_11(n):
            return i(n, -hh, 1) + (mpmath.ei(-hh) if n else 0)

        # Eq. 29 with a constant and Eq. 27's prefactor is Eq. 27 with the J_0(H, w_h, w_b) of Figure 4.11
        first = eq29(h, mpmath.mpf(0), x_b, sigma_t, back, figure_4_11)
        first *= mpmath.exp(-sigma_t * x_b) if isotropic_one else 1
        return first - eq24(h, mpmath.mpf(0), x_a, sigma_t, front)


def expansions(function, terms):
    """Taylor coefficients about v = 0 and w = 0."""
    with mpmath.workdps(30):
        return (
            mpmath.taylor(lambda v: function((1 - v * v) / (1 + v * v)), 0, terms - 1),
            mpmath.taylor(lambda w: function((w * w - 1) / (w * w + 1)), 0, terms - 1),
        )


def arrays(segment):
    return Segments.between(*(np.array([x]) for x in segment))


@pytest.mark.parametrize(
    ("function", "exact"),
    [(phase("isotropic"), isotropic), (phase("rayleigh"), rayleigh), (phase("hg", g=0.4), henyey_greenstein(0.4))],
)
@pytest.mark.parametrize("segment", HERE)
def test_the_print_is_read_twice(function, exact, segment):
    for terms in (1,) if exact is isotropic else (4, 5, 7):
        value = float(PRINTED(arrays(segment), function, terms=terms)[0])
        second = float(second_reading(*segment, *expansions(exact, terms)))
        # measured: 3.2e-11 at worst, of the cancelling sums of Eq. 24
        assert value == pytest.approx(second, rel=1e-10), terms


@pytest.mark.parametrize("segment", HERE)
def test_odd_powers_are_read_twice_too(segment, monkeypatch):
    # no Taylor series about v = 0 has them, for cos theta is even in v; J_1 of Figure 4.11 stands behind them alone
    coefficients = (0.08, 0.03, -0.05, 0.02), (0.08, -0.04, 0.01, 0.03)
    monkeypatch.setattr("analytic.models.weng2010.printed.taylor", lambda phase, terms: coefficients)
    value = float(PRINTED(arrays(segment), phase("rayleigh"))[0])
    assert value == pytest.approx(float(second_reading(*segment, *coefficients)), rel=1e-10)


@pytest.mark.parametrize("function", [phase("isotropic"), phase("rayleigh")])
@pytest.mark.parametrize("segment", HERE)
def test_the_print_is_wrong_everywhere(function, segment):
    exact = isotropic if function.name == "isotropic" else rayleigh
    value = float(PRINTED(arrays(segment), function)[0])
    assert abs(value / float(oracle(*segment, exact)) - 1) > 0.3


def test_the_first_formulation_is_wrong_by_its_prefactor_alone():
    pieces = arrays(HERE[0])
    right = MODELS["quadrature"].function(pieces, phase("isotropic"))
    np.testing.assert_allclose(
        PRINTED(pieces, phase("isotropic")), right * np.exp(-pieces.sigma_t * pieces.x_b), rtol=1e-12
    )


def test_overflow_is_handed_on_without_a_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pieces = Segments.between(
            *np.float32([[1.0, 1.0, 1.0], [-60.0, 2.0, -60], [60.0, 90.0, -1.0], [3.0, 4.0, 9.0]])
        )
        for function in (phase("isotropic"), phase("hg", g=0.6)):
            assert not np.all(np.isfinite(PRINTED(pieces, function)))
