"""The quadrature against proven digits, on segments that hypothesis draws from all that the model promises."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from analytic import Medium, airlight, kinks, phase
from analytic.oracle import exact_airlight

FLOAT64_HOLDS = 1e-290  # below it a product of float64 factors may have lost digits to underflow
PHASES = [
    phase("isotropic"),
    phase("rayleigh"),
    *(phase("hg", g=g) for g in (-0.95, -0.4, 0.3, 0.6, 0.9, 0.95)),
    *(phase("schlick", k=k) for k in (-0.95, -0.5, 0.7, 0.95)),
    *(phase("cornette_shanks", g=g) for g in (-0.95, -0.4, 0.6, 0.95)),
    phase("tabulated", values=(0.5, 1.0, 1.5, 2.0, 5.0)),
    phase("tabulated", values=(3.0, 0.2, 0.1, 0.4, 0.3, 1.0, 9.0)),
]


def powers_of_ten(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(math.log10(low), math.log10(high)).map(lambda exponent: 10.0**exponent)


@st.composite
def segments(draw):
    """Segments with h 1e-6 to 100, sigma_t h up to 50, lengths 1e-6 to 1e6, all but clear to opaque.

    The eye may be anywhere, but not where float64 holds no light: sigma_t d_a is at most 650.
    """
    h, length = draw(powers_of_ten(1e-6, 100)), draw(powers_of_ten(1e-6, 1e6))
    sigma_t = draw(powers_of_ten(1e-12, 50)) / h
    farthest = math.sqrt(max(650 / sigma_t - h, 0) * (650 / sigma_t + h))
    x_a = draw(
        st.one_of(
            st.just(0.0),
            st.floats(-5, 5).map(lambda u: u * h),
            st.floats(0, 1).map(lambda share: -share * length),
            powers_of_ten(1e-6, 1e6),
            powers_of_ten(1e-6, 1e6).map(lambda x: -x),
        )
    )
    x_a = max(-farthest, min(x_a, farthest))
    return h, x_a, max(x_a + length, math.nextafter(x_a, math.inf)), sigma_t


@settings(max_examples=1000, derandomize=True, deadline=None, database=None, suppress_health_check=list(HealthCheck))
@given(segment=segments(), function=st.sampled_from(PHASES))
def test_a_thousand_drawn_segments(segment, function):
    h, x_a, x_b, sigma_t = segment
    truth = exact_airlight(h, x_a, x_b, sigma_t, function, digits=20)
    # Medium(sigma_t, sigma_t): L / I, and L / (I sigma_s) once divided
    value = float(airlight(h, x_a, x_b, Medium(sigma_t, sigma_t), function)) / sigma_t
    if truth.value * sigma_t < FLOAT64_HOLDS:
        assert value * sigma_t < 2 * FLOAT64_HOLDS
    else:
        # measured: 1.1e-13 at worst of 4,000, where e^{-650} rounds its exponent
        assert abs(value / truth.value - 1) < 1e-12


def against_the_oracle(h, x_a, x_b, sigma_t, function):
    truth = exact_airlight(h, x_a, x_b, sigma_t, function, digits=20).value
    medium = Medium(sigma_t, sigma_t) if sigma_t else Medium(1e-300, 1e-300)
    return abs(float(airlight(h, x_a, x_b, medium, function, intensity=1 / medium.sigma_s)) / truth - 1)


@pytest.mark.parametrize("g", [0.99, 1 - 1e-6, 1 - 1e-10, -(1 - 1e-10)])
@pytest.mark.parametrize(("h", "x_a", "x_b"), [(0, -3.0, -1.0), (0, 1.0, 2.0), (2e-7, -3.0, -2.5), (1e-13, 1.0, 2.0)])
def test_rays_through_the_light_and_close_to_it_show_sharp_peaks(h, x_a, x_b, g):
    # measured: 2.6e-15; a height of 1e-12 |x| in the place of 0 would be off by 7e-5 at g = 1 - 1e-10
    assert against_the_oracle(h, x_a, x_b, 0.2, phase("hg", g=g)) < 1e-13


def test_a_table_that_is_zero_where_the_ray_looks():
    backward = phase("tabulated", values=(0.0, 1.0))
    # behind the light a ray close to it is seen by the zero's slope alone
    assert against_the_oracle(1e-12, 1.0, 2.0, 0.5, backward) < 1e-12
    # at a right angle, where cos theta = -x / d itself is small; measured: 1e-15
    for values in ((1.0, 0.0, 1.0), (0.0, 1.0, 0.0, 2.0, 5.0), (1.0, 0.0, 2.0, 0.0, 1.0, 0.0, 1.0)):
        table = phase("tabulated", values=values)
        for x_a, x_b in ((0.0, 1e-6), (-1e-7, 0.0), (-3e-8, 1e-7), (1e-9, 2e-6)):
            assert against_the_oracle(1.3, x_a, x_b, 0.4, table) < 1e-13, (values, x_a)


def test_an_endless_ray_in_a_clear_medium():
    # the backward lobe holds most of it, behind the light without end
    assert against_the_oracle(1e-3, -50.0, math.inf, 0.0, phase("hg", g=-0.99)) < 1e-13


def test_a_fine_table_in_pieces(monkeypatch):
    table = phase("tabulated", values=phase("hg", g=0.9).evaluate(np.linspace(-1, 1, 181)))
    random = np.random.default_rng(4)
    x_a = random.uniform(-9, 3, 50)
    segments = 10 ** random.uniform(-2, 1, 50), x_a, x_a + 10 ** random.uniform(-3, 2, 50), Medium(0.1, 0.3), table
    whole = airlight(*segments)
    monkeypatch.setattr(kinks, "PIECES", 400)
    # sums in another order; measured: 1.6e-15
    np.testing.assert_allclose(airlight(*segments), whole, rtol=1e-14)
    assert against_the_oracle(0.7, -3.0, 5.0, 0.3, table) < 1e-13
