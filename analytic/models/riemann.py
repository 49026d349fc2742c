"""Airlight by the midpoint rule: a ray march over one segment, as the techniques do it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.phase import Phase

__all__ = ["riemann"]


def riemann(
    h: NDArray[np.float64],
    x_a: NDArray[np.float64],
    x_b: NDArray[np.float64],
    sigma_t: NDArray[np.float64],
    phase: Phase,
    *,
    steps: int = 64,
) -> NDArray[np.float64]:
    """Airlight of unit intensity and unit scattering coefficient, from `steps` equal steps sampled at their middles.

    Parameters
    ----------
    h : ndarray, (n,)        distance of the light from the ray [scene unit]; 0 only beside the segment
    x_a : ndarray, (n,)      the eye, from the light's projection on the ray [scene unit]
    x_b : ndarray, (n,)      end of the segment, above x_a, finite [scene unit]
    sigma_t : ndarray, (n,)  extinction coefficient [1 / scene unit]
    phase : Phase            phase function
    steps : int              number of steps, 1 or more

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Raises
    ------
    ValueError
        If steps is below 1 or x_b is infinite.

    Source: Weng 2010, Eq. 16, discretised; Nishita, Miyawaki and Nakamae 1987.
    """
    if steps < 1:
        raise ValueError(f"steps must be 1 or more: {steps}")
    if not np.all(np.isfinite(x_b)):
        raise ValueError("x_b must be finite for the model riemann: equal steps do not reach infinity")
    total = np.zeros_like(h)
    length = x_b - x_a
    for step in range(steps):
        along = length * ((step + 0.5) / steps)
        x = x_a + along
        d = np.hypot(h, x)
        total += np.exp(-sigma_t * (along + d)) * phase.evaluate(-x / d) / (d * d)
    return total * (length / steps)
