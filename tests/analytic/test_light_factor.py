"""The light's own attenuation, whose exponent is carried to more digits than the type has."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from analytic.models.light_factor import light_factor


@pytest.mark.parametrize(("deepest", "bound"), [(1, 3e-7), (12, 3e-7), (80, 3e-7)])
def test_float32_at_any_depth(deepest, bound):
    random = np.random.default_rng(3)
    h, x = 10 ** random.uniform(-4, 1.7, 50_000), random.uniform(-50, 50, 50_000)
    sigma_t = random.uniform(0, deepest, 50_000) / np.hypot(h, x)
    h, x, sigma_t = (values.astype(np.float32) for values in (h, x, sigma_t))
    value = light_factor(h, x, sigma_t)
    assert value.dtype == np.float32
    exact = np.exp(-sigma_t.astype(float) * np.hypot(h.astype(float), x.astype(float)))
    # measured on 360,000: 2.2e-7, 2.5e-7, 2.3e-7, what the exponential and its factor are rounded by; with a plain
    # exponent 2.6e-7, 2.4e-6, 1.4e-5
    assert np.max(np.abs(value / exact - 1)) < bound


def test_float64():
    random = np.random.default_rng(4)
    with mpmath.workdps(30):
        for _ in range(100):
            h, x, sigma_t = 10 ** random.uniform(-6, 2), random.uniform(-100, 100), 10 ** random.uniform(-3, 0.5)
            exact = mpmath.exp(-mpmath.mpf(sigma_t) * mpmath.hypot(h, x))
            value = light_factor(*(np.array([argument]) for argument in (h, x, sigma_t)))
            assert abs(value[0] / exact - 1) < 1e-15  # measured: 2.4e-16; 5e-14 with a plain exponent


@pytest.mark.parametrize(("dtype", "tiny", "huge"), [(np.float32, 1e-38, 1e38), (np.float64, 1e-300, 1e300)])
def test_no_square_overflows_or_vanishes(dtype, tiny, huge):
    with np.errstate(all="raise", under="ignore"):
        for h in (tiny, 1e-20, 1.0, 1e20, huge):
            for x in (0.0, -tiny, 1e-20, -1.0, 1e20, huge):
                for sigma_t in (0.0, tiny, 1.0, huge):
                    ends = [np.array([value], dtype) for value in (h, x, sigma_t)]
                    exact = np.exp(-np.longdouble(ends[2]) * np.hypot(*(np.longdouble(end) for end in ends[:2])))
                    assert light_factor(*ends) == pytest.approx(float(exact[0]), rel=3e-7, abs=1e-37)
