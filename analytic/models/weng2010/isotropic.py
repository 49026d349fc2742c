"""The thesis's isotropic closed form, repaired, with four, three and two complex Ei (section 4.4).

All three are the same number. They are evaluated as a shader that follows the thesis would, exponents unmerged, so
that what float32 loses shows; `weng2010` is the same form merged. The two-Ei form is what is left of Figure 4.11 when
the terms at v_h = 1, which cancel for this phase function, are not evaluated.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.models.model import AirlightModel
from analytic.models.weng2010.antiderivatives import i_pair
from analytic.models.weng2010.combined import combined
from analytic.phase import Phase
from analytic.segments import Segments

__all__ = ["MODELS"]

COEFFICIENTS = (1 / (4 * np.pi),)


def four_ei(segments: Segments, phase: Phase) -> NDArray[np.floating]:
    """Airlight of unit intensity and unit scattering coefficient, isotropic: see `combined`.

    Source: Weng 2010, Figure 4.9 and Eqs. 21, 27 and 30, repaired.
    """
    return combined(segments, COEFFICIENTS, COEFFICIENTS, reuse=False)


def three_ei(segments: Segments, phase: Phase) -> NDArray[np.floating]:
    """Airlight of unit intensity and unit scattering coefficient, isotropic: see `combined`.

    Source: Weng 2010, Figure 4.11, repaired.
    """
    return combined(segments, COEFFICIENTS, COEFFICIENTS, reuse=True)


def two_ei(segments: Segments, phase: Phase) -> NDArray[np.floating]:
    """Airlight of unit intensity and unit scattering coefficient, isotropic, (n,).

    J_0(H, w_h, w_b) - I_0(-H, v_h, v_a) = i_0(-H, v_b) - i_0(-H, v_a) by Eq. 32: Eq. 21 serves on either side.

    Source: Weng 2010, Figure 4.11 and Eqs. 21 and 32, repaired.
    """
    s = segments
    with np.errstate(all="ignore"):
        a, clear = -s.optical_h, s.optical_h == 0
        integral = np.empty_like(a)
        integral[~clear] = i_pair(a[~clear], s.v_b[~clear])[0] - i_pair(a[~clear], s.v_a[~clear])[0]
        integral[clear] = np.arctan(s.v_b[clear]) - np.arctan(s.v_a[clear])
        return np.exp(s.sigma_t * s.x_a) * integral / (2 * np.pi * s.h)


MODELS = tuple(
    AirlightModel(
        name=f"weng2010:{count}-ei",
        function=function,
        citation=f"Weng 2010, {source}, repaired",
        domain="isotropic; within eps (1 + H + sigma_t |x_a|) of its terms' moduli, which behind the light are "
        "e^{sigma_t x_a} pi / h and hide the result: off by more than 1 % on 3.8 % of visible segments in float64 and "
        "on 35 % in float32 (78 % of those behind the light, 0.3 % of those around it)",
        cost=f"{count} complex exponential integrals where the segment contains the light's projection, two elsewhere; "
        "1 exponential, 2 square roots, a sine and a cosine",
        phases=("isotropic",),
    )
    for count, function, source in (
        ("four", four_ei, "Figure 4.9 and Eqs. 21, 27 and 30"),
        ("three", three_ei, "Figure 4.11"),
        ("two", two_ei, "Eqs. 21 and 32"),
    )
)
