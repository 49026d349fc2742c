"""Lengths on a ray beside a point light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["h_times_v", "negligible_h"]


def h_times_v(h: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Length h v = x + sqrt(h^2 + x^2) without cancellation before the projection, where it is
    h^2 / (sqrt(h^2 + x^2) - x).

    Parameters
    ----------
    h : ndarray, (...)  distance of the light from the ray, above 0 [scene unit]
    x : ndarray, (...)  position from the light's projection, may be inf [scene unit]

    Returns
    -------
    ndarray, (...)  h tan(theta / 2), theta the scattering angle [scene unit]

    Source: Weng 2010, section 4.3, v = u + sqrt(1 + u^2) with u = x / h.
    """
    d = np.hypot(h, x)
    return np.where(x > 0, x + d, h * (h / (d - np.minimum(x, 0))))


def negligible_h(x_a: NDArray[np.float64], x_b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Height below which the limit h -> 0 is exact to float64: h enters as (h / x)^2, and this is 1e-12 of |x|.

    Parameters
    ----------
    x_a, x_b : ndarray, (...)  ends of the segment, x_a <= x_b [scene unit]

    Returns
    -------
    ndarray, (...)  0 where the segment contains the light's projection, for there is no finite limit [scene unit]
    """
    return 1e-12 * np.maximum(0.0, np.maximum(x_a, -x_b))
