"""Phase functions: normalised, oriented, and strict about their parameters."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from analytic import phase

FIVE = (0.5, 1.0, 1.5, 2.0, 5.0)
FINE = tuple(phase("hg", g=0.8).evaluate(np.linspace(-1, 1, 181)))
EVERY = [
    pytest.param(phase("isotropic"), id="isotropic"),
    pytest.param(phase("rayleigh"), id="rayleigh"),
    *(pytest.param(phase("hg", g=g), id=f"hg {g}") for g in (-0.95, -0.5, 0.0, 0.3, 0.9, 0.95)),
    *(pytest.param(phase("schlick", k=k), id=f"schlick {k}") for k in (-0.95, -0.5, -1e-4, 0.0, 0.3, 0.51, 0.9)),
    *(pytest.param(phase("cornette_shanks", g=g), id=f"cornette_shanks {g}") for g in (-0.9, 0.0, 0.3, 0.9)),
    *(pytest.param(phase("tabulated", values=v), id=f"tabulated {len(v)}") for v in ((0, 1), FIVE, FINE)),
]


def moment(function, power):
    """2 pi int p(c) c^power dc by tanh-sinh, at twice the working precision of the functions themselves."""
    breaks = sorted({-1, -0.99, -0.9, 0, 0.9, 0.99, 1, *function.kinks})
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


@pytest.mark.parametrize("k", [0.95, -0.95])
def test_schlick_against_its_formula_at_the_peak(k):
    cosine = np.copysign(1 - 2.0**-40, k)
    with mpmath.workdps(30):
        exact = (1 - mpmath.mpf(k) ** 2) / (4 * mpmath.pi * (1 - k * mpmath.mpf(cosine)) ** 2)
    assert float(phase("schlick", k=k).evaluate(cosine)) == pytest.approx(float(exact), rel=2e-15)


@pytest.mark.parametrize("k", [1e-300, -1e-9, 1e-3, 0.3, -0.49, 0.51, 0.9, 1 - 1e-9])
def test_the_mean_cosine_of_schlick_keeps_its_digits(k):
    with mpmath.workdps(700):
        exact = 1 / mpmath.mpf(k) - (1 / mpmath.mpf(k) ** 2 - 1) * mpmath.atanh(mpmath.mpf(k))
    # measured 1.1e-15; the closed form alone has nothing left at 1e-9
    assert phase("schlick", k=k).mean_cosine == pytest.approx(float(exact), rel=2e-15)


def test_cornette_shanks_is_rayleigh_without_asymmetry_and_forward_with_it():
    cosines = np.linspace(-1, 1, 21)
    np.testing.assert_allclose(
        phase("cornette_shanks", g=0.0).evaluate(cosines), phase("rayleigh").evaluate(cosines), rtol=1e-15
    )
    g, values = 0.7, phase("cornette_shanks", g=0.7).evaluate(cosines)
    base = (1 + g**2 - 2 * g * cosines) ** 1.5
    exact = 3 / (8 * np.pi) * (1 - g**2) * (1 + cosines**2) / ((2 + g**2) * base)
    np.testing.assert_allclose(values, exact, rtol=1e-14)


def test_a_table_is_linear_between_its_values_from_backward_to_forward():
    table = phase("tabulated", values=FIVE)
    # 2 pi times the area 3.625 / 2 under the five values
    exact = np.array([0.5, 0.75, 1.0, 2.0, 3.5, 5.0]) / (2 * np.pi * 3.625)
    np.testing.assert_allclose(table.evaluate([-1, -0.75, -0.5, 0.5, 0.75, 1]), exact, rtol=1e-15)
    assert table.kinks == (0.5,)
    assert phase("tabulated", values=FINE).kinks == pytest.approx(np.linspace(-1, 1, 181)[1:-1])
    assert phase("tabulated", values=(0.0, 1.0)).mean_cosine == pytest.approx(1 / 3, rel=1e-15)


def test_a_table_is_known_by_its_shape():
    table = phase("tabulated", values=[1, 2, 4])
    assert table == phase("tabulated", values=np.array([2.0, 4.0, 8.0]))
    assert hash(table) == hash(phase("tabulated", values=(2, 4, 8)))
    assert table != phase("tabulated", values=(4, 2, 1))
    assert phase("tabulated", values=(1e308, 1e308)).evaluate(0.3) == pytest.approx(1 / (4 * np.pi))


@pytest.mark.parametrize(
    "values", [(), (1.0,), [[1.0, 2.0]], (0.0, 0.0), (1.0, -1e-9), (1.0, np.nan), (np.inf, 1.0)], ids=str
)
def test_bad_tables_are_named(values):
    with pytest.raises(ValueError, match=r"^values must"):
        phase("tabulated", values=values)


def test_evaluate_keeps_shapes():
    cosines = np.linspace(-1, 1, 12).reshape(3, 4)
    for function in (parameter.values[0] for parameter in EVERY):
        assert function.evaluate(cosines).shape == (3, 4)
        assert np.shape(function.evaluate(0.5)) == ()


@pytest.mark.parametrize("g", [1.0, -1.0, 1.5, float("nan"), float("inf")])
def test_g_out_of_range_is_named(g):
    with pytest.raises(ValueError, match=r"\bg must"):
        phase("hg", g=g)
    with pytest.raises(ValueError, match=r"\bg must"):
        phase("cornette_shanks", g=g)
    with pytest.raises(ValueError, match=r"\bk must"):
        phase("schlick", k=g)


def test_unknown_names_are_named():
    with pytest.raises(ValueError, match="name must be one of"):
        phase("henyey")
    with pytest.raises(ValueError, match="g is needed"):
        phase("hg")
    with pytest.raises(ValueError, match="k is not a parameter"):
        phase("hg", g=0.1, k=0.2)
    with pytest.raises(ValueError, match="g is not a parameter"):
        phase("rayleigh", g=0.1)
