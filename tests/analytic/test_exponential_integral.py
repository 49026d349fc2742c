"""e^z E1(z) in both precisions, against 30 digits and against scipy."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from scipy.special import exp1

from analytic.exponential_integral import scaled_e1, scaled_e1_float32


def quadrant(points, low, high, seed):
    """Points of the first quadrant, representable in float32, half of them very close to one of the axes."""
    random = np.random.default_rng(seed)
    modulus = np.exp(random.uniform(np.log(low), np.log(high), points))
    near_axis = np.arctan(10 ** random.uniform(-8, 8, points))
    angle = np.where(random.random(points) < 0.5, near_axis, random.uniform(0, np.pi / 2, points))
    z = (modulus * np.exp(1j * angle)).astype(np.complex64).astype(complex)
    return np.maximum(z.real, 0) + 1j * z.imag


def exact(z):
    with mpmath.workdps(30):
        return np.array([complex(mpmath.exp(mpmath.mpc(w)) * mpmath.e1(mpmath.mpc(w))) for w in z])


def worst(value, truth):
    """Relative errors of the complex value and of the imaginary part alone."""
    value = value.astype(complex)
    return np.max(np.abs(value / truth - 1)), np.max(np.abs(value.imag / truth.imag - 1))


@pytest.mark.parametrize(("low", "high"), [(1e-6, 0.6), (0.6, 1.0), (1.0, 4.0), (4.0, 60.0), (60.0, 1e6)])
def test_float64_against_thirty_digits(low, high):
    z = quadrant(300, low, high, seed=1)
    # measured: 2.1e-15 / 2.4e-15 at worst, both beside |z| = 1
    both, imaginary = worst(scaled_e1(z), exact(z))
    assert both < 4e-15
    assert imaginary < 5e-15


def test_float64_against_scipy():
    z = quadrant(20_000, 1e-6, 3.0, seed=2)
    # measured: 1e-13, the cancellation of scipy's own series as |z| grows
    assert worst(scaled_e1(z), np.exp(z) * exp1(z))[0] < 1e-12


@pytest.mark.parametrize(
    ("low", "high", "both_allowed", "imaginary_allowed"),
    # measured over 256,000 points a band: see the table of the module; half as much again is allowed
    [(1e-6, 0.6, 5e-7, 1.3e-6), (0.6, 1.0, 9e-7, 2.4e-6), (1.0, 6.0, 6e-7, 7e-7), (6.0, 1e6, 4e-7, 6e-7)],
)
def test_float32_over_the_quadrant(low, high, both_allowed, imaginary_allowed):
    z = quadrant(100_000, low, high, seed=3)
    value = scaled_e1_float32(z)
    assert value.dtype == np.complex64
    both, imaginary = worst(value, scaled_e1(z))
    assert both < both_allowed
    assert imaginary < imaginary_allowed


def test_far_and_infinite_points():
    assert scaled_e1(np.inf) == 0
    assert scaled_e1(1e200 + 1e200j) == pytest.approx(1 / (1e200 + 1e200j), rel=1e-15)
    assert scaled_e1_float32(1e25 + 1e20j).real == pytest.approx(1e-25, rel=1e-6)
    assert scaled_e1(np.full((2, 3), 1.0)).shape == (2, 3)


@pytest.mark.parametrize("z", [0, -1, 1 - 1j, complex(np.nan, 1)])
@pytest.mark.parametrize("function", [scaled_e1, scaled_e1_float32])
def test_points_outside_are_refused(function, z):
    with pytest.raises(ValueError, match="z must lie in the first quadrant"):
        function(z)
