"""Phase functions: normalised, oriented, and strict about their parameters."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from analytic import phase

EVERY = [
    pytest.param(phase("isotropic"), id="isotropic"),
    pytest.param(phase("rayleigh"), id="rayleigh"),
    *(pytest.param(phase("hg", g=g), id=f"hg {g}") for g in (-0.95, -0.5, 0.0, 0.3, 0.9, 0.95)),
]


def moment(function, power):
    """2 pi int p(c) c^power dc by tanh-sinh, at twice the working precision of the functions themselves."""
    breaks = [-1, -0.99, -0.9, 0, 0.9, 0.99, 1]
    return 2 * np.pi * float(mpmath.quad(lambda c: float(function.evaluate(float(c))) * c**power, breaks))


@pytest.mark.parametrize("function", EVERY)
def test_normalisation_and_mean_cosine(function):
    # measured: 1.6e-15 and 1.5e-15 at worst (hg 0.95)
    assert moment(function, 0) == pytest.approx(1, abs=1e-13)
    assert moment(function, 1) == pytest.approx(function.mean_cosine, abs=1e-13)


def test_printed_rayleigh_is_not_normalised():
    # chapter 5 of the thesis prints 3/4 (1 + cos^2), 4 pi too much
    printed = 2 * np.pi * float(mpmath.quad(lambda c: 0.75 * (1 + c * c), [-1, 1]))
    assert printed == pytest.approx(4 * np.pi, rel=1e-12)


def test_positive_g_is_forward():
    forward = phase("hg", g=0.6)
    # (1 + g)^2 / (1 - g)^2 (1 + g) / (1 - g) = 64 at g = 0.6
    assert forward.evaluate(1.0) / forward.evaluate(-1.0) == pytest.approx(64, rel=1e-14)
    assert moment(phase("hg", g=-0.6), 1) == pytest.approx(-0.6, abs=1e-13)


@pytest.mark.parametrize("g", [0.95, -0.95])
def test_henyey_greenstein_keeps_its_digits_at_the_peak(g):
    cosine = np.copysign(1 - 2.0**-40, g)
    with mpmath.workdps(30):
        exact = (1 - mpmath.mpf(g) ** 2) / (
            4 * mpmath.pi * (1 + mpmath.mpf(g) ** 2 - 2 * g * mpmath.mpf(cosine)) ** 1.5
        )
    # measured: 5e-16; evaluated as 1 + g^2 - 2 g cos theta it would be 2e-14
    assert float(phase("hg", g=g).evaluate(cosine)) == pytest.approx(float(exact), rel=2e-15)


def test_evaluate_keeps_shapes():
    cosines = np.linspace(-1, 1, 12).reshape(3, 4)
    for function in (phase("isotropic"), phase("rayleigh"), phase("hg", g=0.2)):
        assert function.evaluate(cosines).shape == (3, 4)
        assert np.shape(function.evaluate(0.5)) == ()


@pytest.mark.parametrize("g", [1.0, -1.0, 1.5, float("nan"), float("inf")])
def test_g_out_of_range_is_named(g):
    with pytest.raises(ValueError, match=r"\bg must"):
        phase("hg", g=g)


def test_unknown_names_are_named():
    with pytest.raises(ValueError, match="name must be one of"):
        phase("henyey")
    with pytest.raises(ValueError, match="g is needed"):
        phase("hg")
    with pytest.raises(ValueError, match="k is not a parameter"):
        phase("hg", g=0.1, k=0.2)
    with pytest.raises(ValueError, match="g is not a parameter"):
        phase("rayleigh", g=0.1)
