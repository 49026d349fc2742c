"""The angle at which a light sees places of a ray: equal steps of it meet equal shares of a point light.

It cancels the 1 / d^2 (Kulla and Fajardo 2012, section 4).
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Real = TypeVar("Real")  # arrays of NumPy or of Dr.Jit

# of its distance from the light: a ray that comes closer is not told from one through the light
NEAREST = 1e-14


def angle_between(h: Array, s_a: Array, s_b: Array) -> tuple[Array, Array]:
    """Angle at the light between two places of a ray, and the ray's distance from it raised to what float64 resolves.

    One arc tangent, for the difference of two would lose its digits where a ray points at the light or away from it.

    Parameters
    ----------
    h : ndarray, (...)           distance of the light from the ray [scene unit]
    s_a, s_b : ndarray, (...)    places, from the light's projection on the ray [scene unit]; s_a <= s_b

    Returns
    -------
    angle : ndarray, (...)       0 to pi [rad]
    h : ndarray, (...)           [scene unit]
    """
    h = np.maximum(np.maximum(h, NEAREST * np.maximum(np.abs(s_a), np.abs(s_b))), np.finfo(np.float64).tiny)
    return np.arctan2((s_b - s_a) * h, h * h + s_a * s_b), h


def place_at(tangent: Real, h: Real, s_a: Real) -> Real:
    """Where on the ray the light sees the angle of this tangent from s_a, on which it is counted [scene unit]."""
    return s_a + tangent * (h * h + s_a * s_a) / (h - s_a * tangent)  # type: ignore[operator]
