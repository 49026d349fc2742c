"""Equiangular Gauss-Legendre: what it converges to, and how slowly."""

from __future__ import annotations

import numpy as np
import pytest

from analytic import phase
from analytic.models.equiangular import equiangular
from analytic.models.quadrature import quadrature
from analytic.segments import Segments
from experiments.quadrature.tuning import draw_segments


@pytest.mark.parametrize("function", [phase("isotropic"), phase("hg", g=0.5), phase("rayleigh")])
def test_converges_where_the_segment_ends_before_the_boundary_layer(function):
    h = np.array([1.0, 0.5, 2.0])
    segments = Segments.between(h, np.array([-2.0, 0.3, -5.0]), np.array([3.0, 1.0, -1.0]), np.array([0.2, 1.0, 0.0]))
    # measured: 6e-15
    np.testing.assert_allclose(equiangular(segments, function, nodes=48), quadrature(segments, function), rtol=5e-14)


def test_infinite_segments():
    ones = np.ones(2)
    infinite = Segments(ones, np.array([-3.0, 2.0]), np.inf * ones, np.inf * ones, np.array([0.3, 0.0]))
    exact = quadrature(infinite, phase("rayleigh"))
    # measured: 1.3e-15
    np.testing.assert_allclose(equiangular(infinite, phase("rayleigh"), nodes=128), exact, rtol=2e-14)


def test_second_order_over_the_domain():
    drawn = draw_segments(8000, 31)
    drawn = drawn[drawn.d_a <= 12]
    isotropic = phase("isotropic")
    exact = quadrature(drawn, isotropic)
    worst = [np.max(np.abs(equiangular(drawn, isotropic, nodes=n) / exact - 1)) for n in (8, 16, 32)]
    # measured on 20,000: 3.2e-3, 8.4e-4, 2.1e-4
    np.testing.assert_array_less(worst, [4e-3, 1e-3, 2.6e-4])
    # the boundary layer near theta = pi: 4 times less for twice the nodes, and no more
    assert 3 < worst[0] / worst[1] < 5
    assert 3 < worst[1] / worst[2] < 5


def test_float32():
    drawn = draw_segments(4000, 32)
    single = drawn[drawn.d_a <= 12].astype(np.float32)
    isotropic = phase("isotropic")
    value = equiangular(single, isotropic, nodes=16)
    assert value.dtype == np.float32
    # measured on 20,000: 8.4e-4, that of the rule
    assert np.max(np.abs(value / quadrature(single.astype(np.float64), isotropic) - 1)) < 1e-3


@pytest.mark.parametrize("nodes", [0, 4097, 100_000, 16.0])
def test_numbers_of_nodes_are_refused(nodes):
    # 100,000 would be a matrix of 75 GiB to some ways of finding them
    with pytest.raises(ValueError, match=r"^nodes must be a whole number, 1 to 4096"):
        equiangular(draw_segments(2, 1), phase("isotropic"), nodes=nodes)
