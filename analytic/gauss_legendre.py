"""Gauss-Legendre rules, as every quadrature here takes them."""

from __future__ import annotations

from scipy.special import roots_legendre

__all__ = ["gauss_legendre"]


def gauss_legendre(count: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Nodes and weights on [0, 1], as Python floats, which widen no float32 array."""
    x, weights = roots_legendre(count)
    return tuple(((x + 1) / 2).tolist()), tuple((weights / 2).tolist())
