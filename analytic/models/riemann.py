"""Airlight by the midpoint rule: a ray march over one segment, as the techniques do it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.inputs import whole_number
from analytic.models.model import AirlightModel
from analytic.phase import Phase
from analytic.segments import Segments, half_angle

__all__ = ["MODEL", "riemann"]


def riemann(segments: Segments, phase: Phase, *, steps: int = 64) -> NDArray[np.floating]:
    """Airlight of unit intensity and unit scattering coefficient, from `steps` equal steps sampled at their middles.

    Parameters
    ----------
    segments : Segments, (n,)  finite
    phase : Phase              phase function
    steps : int                number of steps, 1 or more

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Raises
    ------
    ValueError
        If steps is no whole number of 1 or more, or x_b is infinite.

    Source: Weng 2010, Eq. 16, discretised; Nishita, Miyawaki and Nakamae 1987.
    """
    steps = whole_number("steps", steps, 1)
    if not np.all(np.isfinite(segments.x_b)):
        raise ValueError("x_b must be finite for the model riemann: equal steps do not reach infinity")
    total = np.zeros_like(segments.h)
    for step in range(steps):
        along = segments.length * ((step + 0.5) / steps)
        x = segments.x_a + along
        d2 = segments.h * segments.h + x * x
        d = np.sqrt(d2)
        scattered = phase.of_half_angle(*half_angle(segments.h, x, d))
        total += np.exp(-segments.sigma_t * (along + d)) * scattered / d2
    return total * (segments.length / steps)


MODEL = AirlightModel(
    name="riemann",
    function=riemann,
    citation="Weng 2010, Eq. 16, midpoint rule; Nishita, Miyawaki and Nakamae 1987",
    domain="every phase function, finite segments; second order once the step is well below h and 1 / sigma_t",
    cost="`steps` (64) exponentials and square roots",
)
