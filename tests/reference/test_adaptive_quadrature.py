"""The rules of 7 and 15 nodes, and what halving makes of them."""

from __future__ import annotations

import numpy as np
import pytest

from reference.deterministic.adaptive_quadrature import GAUSS, KRONROD, NODES, RELATIVE, integrate


@pytest.mark.parametrize(("weights", "degree"), [(KRONROD, 23), (GAUSS, 13)], ids=["Kronrod", "Gauss"])
def test_a_rule_is_exact_up_to_its_degree_and_no_further(weights: np.ndarray, degree: int) -> None:
    powers = np.arange(degree + 2)
    off = np.array([weights @ (2 * NODES - 1) ** n for n in powers]) - np.where(powers % 2, 0, 1 / (powers + 1))
    # measured: 1.1e-16; one degree more is off by 2.9e-9 (Kronrod) and 9.3e-5 (Gauss)
    assert np.abs(off[:-1]).max() < 1e-15
    assert np.abs(off[-1]) > 1e-9


INTEGRALS = {
    "smooth": (lambda x: np.exp(-3 * x), (1 - np.exp(-3)) / 3),
    "kink": (lambda x: np.abs(x - 0.3), (0.3**2 + 0.7**2) / 2),
    "jump": (lambda x: (x > 1 / 3) * 1.0, 2 / 3),
    "root": (lambda x: np.sqrt(x), 2 / 3),
    "peak": (lambda x: 1e-4 / ((x - 0.4) ** 2 + 1e-8), np.arctan(0.6e4) + np.arctan(0.4e4)),
    "nothing": (lambda x: 0 * x, 0.0),
}


def test_integrals_one_by_one_and_by_owner() -> None:
    functions, truths = zip(*INTEGRALS.values(), strict=True)

    def values(number: np.ndarray, x: np.ndarray) -> np.ndarray:
        one = np.stack([functions[n](row) for n, row in zip(number, x, strict=True)])
        return one[..., None] * [1.0, 2.0, 0.0]

    truth = np.multiply.outer(truths, [1.0, 2.0, 0.0])
    count = len(functions)
    value, error = integrate(values, np.arange(count), count)
    # a jump costs a share of RELATIVE for each of its halvings
    np.testing.assert_allclose(value, truth, rtol=50 * RELATIVE, atol=0)
    assert (np.abs(value - truth) <= error + 1e-15).all()
    together, _ = integrate(values, np.zeros(count, int), 2)
    np.testing.assert_allclose(together, [truth.sum(0), np.zeros(3)], rtol=50 * RELATIVE)
