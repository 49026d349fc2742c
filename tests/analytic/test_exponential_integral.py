"""e^z E1(z) and Ei(z) over the plane, in both precisions, against 30 digits and against scipy."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from scipy.special import exp1, expi

from analytic.exponential_integral import ei, scaled_e1
from analytic.exponential_integral.continued_fraction import _fixed_point

QUADRANTS = {"I": (1, 1), "II": (-1, 1), "III": (-1, -1), "IV": (1, -1)}
RIGHT, LEFT = ("I", "IV"), ("II", "III")


def quadrant(name, points, low, high, seed):
    """Points of a quadrant, representable in float32, half of them very close to one of its axes."""
    random = np.random.default_rng(seed)
    modulus = np.exp(random.uniform(np.log(low), np.log(high), points))
    near_axis = np.arctan(10 ** random.uniform(-8, 8, points))
    angle = np.where(random.random(points) < 0.5, near_axis, random.uniform(0, np.pi / 2, points))
    z = (modulus * np.exp(1j * angle)).astype(np.complex64).astype(complex)
    across, up = QUADRANTS[name]
    return across * np.maximum(z.real, 0) + 1j * (up * z.imag)


def exact_f(z):
    with mpmath.workdps(30):
        return np.array([complex(mpmath.exp(mpmath.mpc(w)) * mpmath.e1(mpmath.mpc(w))) for w in z])


def exact_ei(z):
    with mpmath.workdps(30):
        return np.array([complex(mpmath.ei(mpmath.mpc(w))) for w in z])


def worst(value, truth):
    """Relative error of the complex value."""
    return np.max(np.abs(value.astype(complex) / truth - 1))


def worst_imaginary(value, truth):
    """Relative error of the imaginary part alone."""
    return np.max(np.abs(value.imag.astype(float) / truth.imag - 1))


def worst_ei(value, truth):
    """Error relative to |Ei|, or to 1 where that is smaller: Ei has zeros, among terms of the size of pi."""
    return np.max(np.abs(value.astype(complex) - truth) / np.maximum(np.abs(truth), 1))


@pytest.mark.parametrize("name", RIGHT)
@pytest.mark.parametrize(("low", "high"), [(1e-6, 0.6), (0.6, 1.0), (1.0, 4.0), (4.0, 60.0), (60.0, 1e6)])
def test_float64_in_the_right_half_plane(name, low, high):
    z = quadrant(name, 300, low, high, seed=1)
    # measured: 2.0e-15 / 1.6e-15 at worst, both beside |z| = 1; 2.1e-15 / 2.4e-15 over 1,500 points a band
    value, truth = scaled_e1(z), exact_f(z)
    assert worst(value, truth) < 4e-15
    assert worst_imaginary(value, truth) < 5e-15


@pytest.mark.parametrize("name", LEFT)
@pytest.mark.parametrize(("low", "high"), [(1e-6, 1.0), (1.0, 4.0), (4.0, 20.0), (20.0, 45.0), (45.0, 1e6)])
def test_float64_in_the_left_half_plane(name, low, high):
    z = quadrant(name, 300, low, high, seed=1)
    # measured: 2.2e-15 at worst, see the table of the module
    assert worst(scaled_e1(z), exact_f(z)) < 4e-15


@pytest.mark.parametrize("name", QUADRANTS)
def test_float64_against_scipy(name):
    z = quadrant(name, 20_000, 1e-6, 3.0, seed=2)
    # measured: 7.7e-14, the cancellation of scipy's own series as |z| grows
    assert worst(scaled_e1(z), np.exp(z) * exp1(z)) < 1e-12


@pytest.mark.parametrize("name", RIGHT)
@pytest.mark.parametrize(
    ("low", "high", "both_allowed", "imaginary_allowed"),
    # measured over 256,000 points a band: 3.3e-7 / 8.4e-7, 6.1e-7 / 1.6e-6, 3.9e-7 / 4.5e-7 and 2.6e-7 / 3.9e-7
    [(1e-6, 0.6, 5e-7, 1.3e-6), (0.6, 1.0, 9e-7, 2.4e-6), (1.0, 6.0, 6e-7, 7e-7), (6.0, 1e6, 4e-7, 6e-7)],
)
def test_float32_in_the_right_half_plane(name, low, high, both_allowed, imaginary_allowed):
    z = quadrant(name, 100_000, low, high, seed=3)
    value = scaled_e1(z.astype(np.complex64))
    assert value.dtype == np.complex64
    truth = scaled_e1(z)
    assert worst(value, truth) < both_allowed
    assert worst_imaginary(value, truth) < imaginary_allowed


@pytest.mark.parametrize("name", LEFT)
@pytest.mark.parametrize(
    ("low", "high", "allowed"),
    # measured: the table of the module; half as much again is allowed
    [(1e-6, 1.0, 5.3e-7), (1.0, 6.0, 6.5e-7), (6.0, 20.0, 1.5e-6), (20.0, 24.0, 2.3e-6), (24.0, 1e6, 3.3e-7)],
)
def test_float32_in_the_left_half_plane(name, low, high, allowed):
    z = quadrant(name, 100_000, low, high, seed=3)
    assert worst(scaled_e1(z.astype(np.complex64)), scaled_e1(z)) < allowed


@pytest.mark.parametrize(("dtype", "allowed"), [(np.complex64, 1.8e-6), (np.complex128, 4e-15)])
def test_where_one_expansion_takes_over_from_another(dtype, allowed):
    # both sides of |z| = 1, of |z| + Re z = 1, of the imaginary axis and of every far limit
    angle = np.linspace(0, np.pi, 41)
    circles = [radius * np.exp(1j * angle) for radius in (1.0, 20.0, 24.0, 45.0, 300.0)]
    height = np.linspace(1.0, 9.3, 40)
    parabola = (1 - height**2) / 2 + 1j * height
    axis = 1j * np.geomspace(1e-3, 1e3, 40)
    border = np.concatenate([*circles, parabola, axis])
    z = np.concatenate([border * (1 - 1e-6), border * (1 + 1e-6), axis - 1e-7 * np.abs(axis)]).astype(dtype)
    # measured: 9.0e-7 and 2.2e-15
    assert worst(scaled_e1(z), exact_f(z.astype(complex))) < allowed


def test_the_tail_is_the_smaller_fixed_point():
    # 1 = f (b - k (k+1) f), b = z + 2k + 1, on both sides of Re b = 0; the roots' product is 1 / (k (k+1))
    random = np.random.default_rng(6)
    x, y, k = random.uniform(-45, 45, 2_000), random.uniform(0.1, 45, 2_000), random.integers(4, 30, 2_000)
    f, g = _fixed_point(x, y, k.astype(float))
    tail, b = f + 1j * g, x + 2 * k + 1 + 1j * y
    assert np.any(b.real < 0)
    # measured: 5.0e-16
    assert np.abs(tail * (b - k * (k + 1) * tail) - 1).max() < 2e-15
    assert np.all(np.abs(tail) ** 2 * k * (k + 1) < 1)


@pytest.mark.parametrize(("dtype", "allowed"), [(np.complex64, 5e-7), (np.complex128, 6e-16)])
def test_on_the_cut_the_sign_of_zero_decides(dtype, allowed):
    x = np.array([1e-5, 0.01, 0.3725, 1.0, 5.0, 18.0]).astype(np.float32).astype(float)
    above, below = np.empty(x.size, dtype), np.empty(x.size, dtype)
    above.real = below.real = -x
    above.imag, below.imag = 0.0, -0.0
    # E1(-x +- i0) = -Ei(x) -+ i pi (Abramowitz and Stegun 5.1.7); measured: 2.2e-7 and 2.2e-16
    truth = -np.exp(-x) * (expi(x) + 1j * np.pi)
    assert worst(scaled_e1(above), truth) < allowed
    assert worst(scaled_e1(below), truth.conj()) < allowed
    # a real number is taken to lie above, and a point beside the cut has the value of its side
    assert np.array_equal(scaled_e1(above.real), scaled_e1(above))
    beside = above + dtype(1e-30j)
    assert worst(scaled_e1(beside), truth) < allowed
    assert worst(scaled_e1(beside.conj()), truth.conj()) < allowed


@pytest.mark.parametrize("dtype", [np.complex64, np.complex128])
@pytest.mark.parametrize("function", [scaled_e1, ei])
def test_conjugates_have_conjugate_values(function, dtype):
    z = np.concatenate([quadrant(name, 2_000, 1e-6, 80.0, seed=4) for name in ("I", "II")]).astype(dtype)
    assert np.array_equal(function(z.conj()), function(z).conj())


@pytest.mark.parametrize("name", QUADRANTS)
@pytest.mark.parametrize(("low", "high"), [(1e-6, 1.0), (1.0, 6.0), (6.0, 80.0), (80.0, 700.0)])
def test_ei_against_thirty_digits(name, low, high):
    z = quadrant(name, 200, low, high, seed=5)
    truth = exact_ei(z)
    # measured: 1.6e-15; 3.7e-15 over 1,500 points a band
    assert worst_ei(ei(z), truth) < 8e-15
    # measured: 1.0e-6; 1.8e-6 over 250,000 points a band
    held = np.abs(truth) < 3e38
    assert worst_ei(ei(z[held].astype(np.complex64)), truth[held]) < 2.7e-6


@pytest.mark.parametrize(("dtype", "allowed"), [(np.complex64, 1e-6), (np.complex128, 3e-15)])
def test_ei_on_the_real_axis(dtype, allowed):
    # away from its zero, 0.3725
    x = np.concatenate([-np.geomspace(1e-6, 80, 200), np.geomspace(1e-6, 0.3, 50), np.geomspace(0.5, 80, 50)])
    value = ei(x.astype(dtype))
    assert value.dtype == dtype
    assert np.all(value.imag == 0)
    # relative to Ei, which decays on the negative axis; measured: 5.0e-7 and 1.6e-15
    assert worst(value, exact_ei(x.astype(dtype).real.astype(float))) < allowed


@pytest.mark.parametrize("dtype", [np.complex64, np.complex128])
def test_ei_jumps_across_the_negative_real_axis(dtype):
    x = np.array([-20, -2, -0.1]).astype(dtype)
    above, below = ei(x + dtype(1e-30j)), ei(x - dtype(1e-30j))
    assert np.all(above.imag == dtype(np.pi).real)
    assert np.all(below.imag == -dtype(np.pi).real)
    # scipy loses digits here, but not beside pi; measured: 0 and 2.2e-16
    assert np.abs((above + below) / 2 - ei(x)).max() < 5e-16
    # the positive axis is no cut
    x = np.array([0.2, 1, 10]).astype(dtype)
    # measured: 5.0e-7 and 1.1e-16
    assert np.abs(ei(x + dtype(1e-30j)) / ei(x - dtype(1e-30j)) - 1).max() < 8 * np.finfo(dtype).eps


def test_ei_near_and_past_overflow():
    # e^z overflows from 709.8 and 88.7 on
    z = np.array([712 + 0.1j, 712 - 0.1j, 715, 716 + 3j])
    # measured: 2.2e-16
    assert worst_ei(ei(z), exact_ei(z)) < 1e-15
    single = np.array([91 + 0.1j, 92 - 2j], np.complex64)
    # measured: 7.7e-8
    assert worst_ei(ei(single), exact_ei(single.astype(complex))) < 5e-7
    for dtype, x in ((np.complex64, 100), (np.complex128, 800), (np.complex128, 1e300)):
        past = ei(np.array([x, x + 3j], dtype))
        assert past[0] == np.inf
        # e^{3i} lies in the second quadrant
        assert (past[1].real, past[1].imag) == (-np.inf, np.inf)


def test_near_zero_the_logarithm_is_left():
    for dtype, smallest in ((np.complex64, 1e-30), (np.complex128, 1e-300)):
        z = (smallest * np.exp(1j * np.array([0.0, 1.0, 2.0, 3.0, -2.0]))).astype(dtype)
        logarithm = np.euler_gamma + np.log(z.astype(complex))
        # measured: 2.1e-8 and 1.1e-16
        assert np.abs(scaled_e1(z) / -logarithm - 1).max() < np.finfo(dtype).eps


def test_far_and_infinite_points():
    for z in (np.inf, -np.inf, complex(3, np.inf), complex(-np.inf, -2)):
        assert scaled_e1(z) == 0
    for z in (1e200 + 1e200j, -1e200 + 1e200j, -1e160 - 3j):
        assert scaled_e1(z) == pytest.approx(1 / z, rel=1e-15, abs=0)
    assert scaled_e1(np.complex64(1e25 + 1e20j)).real == pytest.approx(1e-25, rel=1e-6, abs=0)
    # where both parts of z are as large as they may be, |z| is not a number any more
    assert scaled_e1(np.complex64(-3e38 + 3e38j)) == 0
    # far left pi |z| e^{-|z|}, the jump across the cut, is below rounding
    assert scaled_e1(-50.0) == pytest.approx(-np.exp(-50) * expi(50), rel=1e-15, abs=0)


@pytest.mark.parametrize("function", [scaled_e1, ei])
def test_shapes_and_types(function):
    assert function(np.full((2, 3), 1.0)).shape == (2, 3)
    assert function(np.zeros((0, 3))).shape == (0, 3)
    assert function(1).shape == ()
    for dtype, result in (
        (np.float32, np.complex64),
        (np.complex64, np.complex64),
        (np.float64, np.complex128),
        (np.float16, np.complex128),
        (np.int64, np.complex128),
    ):
        assert function(np.ones(2, dtype)).dtype == result
    # a mixture of expansions gives each point the value that it has alone
    z = np.array([[0.5 + 0.1j, -0.5 + 0.1j, 3j], [-30 + 1j, -70 + 0.1j, 400]])
    assert np.array_equal(function(z), [[function(w) for w in row] for row in z])


@pytest.mark.parametrize("dtype", [np.complex64, np.complex128])
@pytest.mark.parametrize("function", [scaled_e1, ei])
@pytest.mark.parametrize("z", [0, complex(0, -0.0), complex(np.nan, 1), complex(1, np.nan), complex(np.inf, np.nan)])
def test_zero_and_nan_are_refused(function, dtype, z):
    with pytest.raises(ValueError, match="z must not be 0 or NaN"):
        function(np.array([1, z], dtype))


@pytest.mark.parametrize("z", [np.inf, -np.inf, complex(0, np.inf)])
def test_ei_refuses_infinite_points(z):
    with pytest.raises(ValueError, match="z must be finite"):
        ei(z)
