"""A witness without Monte Carlo: lit intervals by ray casting, and the airlight on them by float64 quadrature."""

from __future__ import annotations

from reference.deterministic.estimator import Deterministic
from reference.deterministic.lit_intervals import LitIntervals, lit_intervals

__all__ = ["Deterministic", "LitIntervals", "lit_intervals"]
