"""Fog whose source is constant along the ray, against the integral that it stands for."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from analytic.models.depth_fog import depth_fog


@pytest.mark.parametrize(
    ("sigma_t", "begin", "length"), [(0.2, 0.0, 3.0), (1.5, 2.0, 1e-6), (1e-7, 4.0, 9.0), (0.3, 5.0, 400.0)]
)
def test_it_is_the_integral(sigma_t: float, begin: float, length: float) -> None:
    with mpmath.workdps(30):
        start, step = mpmath.mpf(begin), mpmath.mpf(length)
        # in steps of a mean free path at most, or the quadrature passes over where there is light
        cuts = [start + step * mpmath.mpf(i) / 128 for i in range(129)]
        exact = mpmath.quad(lambda t: 0.7 * mpmath.exp(-sigma_t * t), cuts)
    # measured: 2.0e-16
    assert float(depth_fog(0.7, sigma_t, begin, length)) == pytest.approx(float(exact), rel=1e-15)


def test_it_has_its_limits() -> None:
    assert depth_fog(3.0, 0.0, 2.0, 5.0) == 15.0
    assert depth_fog(3.0, 0.5, 0.0, np.inf) == 6.0
    assert depth_fog(3.0, 0.5, 0.0, 0.0) == 0.0


def test_pieces_add_up() -> None:
    """What James 2003 rests on: a shadow is the airlight from where it begins less that from where it ends."""
    near, far = depth_fog(1.0, 0.4, 1.0, 8.0), depth_fog(1.0, 0.4, 3.0, 6.0)
    assert near - far == pytest.approx(float(depth_fog(1.0, 0.4, 1.0, 2.0)), rel=1e-15)


def test_channels_broadcast() -> None:
    coloured = depth_fog([1.0, 2.0, 3.0], [0.1, 0.2, 0.4], np.zeros((4, 1)), np.ones((4, 1)))
    assert coloured.shape == (4, 3)
    assert coloured[2, 1] == depth_fog(2.0, 0.2, 0.0, 1.0)


@pytest.mark.parametrize(
    "arguments",
    [
        {"sigma_t": -0.1},
        {"length": -1.0},
        {"source": np.nan},
        {"begin": np.nan},
        {"sigma_t": np.nan},
        {"length": np.nan},
    ],
)
def test_bad_values_are_named(arguments: dict[str, float]) -> None:
    (name,) = arguments
    with pytest.raises(ValueError, match=f"^{name} must"):
        depth_fog(**{"source": 1.0, "sigma_t": 0.1, "begin": 0.0, "length": 1.0, **arguments})
