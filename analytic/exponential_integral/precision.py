"""How far the expansions of the exponential integral go in each floating-point type."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["FLOAT32", "FLOAT64", "Precision"]


@dataclass(frozen=True)
class Precision:
    """How far the expansions go for one floating-point type.

    A pair of terms or depths is a rule, ceil(pair[0] + pair[1] q), of the q that is named.

    Attributes
    ----------
    dtype : type                      of both parts of z
    terms : int                       powers of z in the scaled series, enough for |z| = 1
    unscaled_terms : (float, float)   powers of z in the unscaled series; q = |z|. The first one left out is below
                                      2e-8 (float32) or 3e-17 of the sum wherever the series is used
    depth : (float, float)            of the fraction with its tail; q = 1 / (|z| + min(Re z, 0))
    far_right, far_left : float       |z| from which the tail is dropped, in either half plane; from far_left on,
                                      pi |z| e^{-|z|}, what the cut adds to |F|, is below a twentieth of the roundoff
    far_right_depth, far_left_depth : int   of the fraction without its tail
    largest : float                   |z| from which F = 1/z to the last digit and |z|^2 would overflow
    """

    dtype: type[np.floating]
    terms: int
    unscaled_terms: tuple[float, float]
    depth: tuple[float, float]
    far_right: float
    far_right_depth: int
    far_left: float
    far_left_depth: int
    largest: float


FLOAT32 = Precision(
    np.float32,
    terms=11,
    unscaled_terms=(11.0, 2.0),
    depth=(2.0, 22.0),
    far_right=20.0,
    far_right_depth=4,
    far_left=24.0,
    far_left_depth=4,
    largest=1e18,
)
FLOAT64 = Precision(
    np.float64,
    terms=20,
    unscaled_terms=(27.0, 2.0),
    depth=(4.0, 120.0),
    far_right=300.0,
    far_right_depth=6,
    far_left=45.0,
    far_left_depth=9,
    largest=1e150,
)
