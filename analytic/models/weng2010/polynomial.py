"""The thesis's anisotropic closed form, repaired, with three complex Ei: Taylor and near-minimax coefficients.

The form is exact for a phase function that is a polynomial in v before the light and in w behind it (`combined`). What
separates the two models is which polynomial stands for the real phase function (`polynomials`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.models.model import AirlightModel
from analytic.models.weng2010.combined import combined
from analytic.models.weng2010.polynomials import POLYNOMIAL_PHASES, near_minimax, taylor
from analytic.phase import Phase
from analytic.segments import Segments

__all__ = ["MODELS", "weng2010_minimax", "weng2010_taylor"]

COST = (
    "3 complex and 2 real exponential integrals where the segment contains the light's projection, 2 complex and at "
    "most 2 real ones elsewhere; up to 5 exponentials, a sine and a cosine; sums of the third order in `terms`"
)


def weng2010_taylor(segments: Segments, phase: Phase, *, terms: int = 5) -> NDArray[np.floating]:
    """Airlight of unit intensity and unit scattering coefficient, the phase function a Taylor series.

    Parameters
    ----------
    segments : Segments, (n,)
    phase : Phase              one of `POLYNOMIAL_PHASES`
    terms : int                N of Eqs. 22 and 29, 1 to 100; every other coefficient is 0

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Raises
    ------
    ValueError
        If terms is below 1 or above 100.

    Source: Weng 2010, Eqs. 24, 29 and 30 and Figure 4.11, repaired.
    """
    return combined(segments, *taylor(phase, terms), reuse=True)


def weng2010_minimax(segments: Segments, phase: Phase, *, terms: int = 5) -> NDArray[np.floating]:
    """Airlight of unit intensity and unit scattering coefficient, the phase function nearly the best polynomial.

    Parameters
    ----------
    segments : Segments, (n,)
    phase : Phase              one of `POLYNOMIAL_PHASES`
    terms : int                coefficients of each polynomial, 1 to 100

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Raises
    ------
    ValueError
        If terms is below 1 or above 100.

    Source: Weng 2010, Eqs. 24, 29 and 30 and Figure 4.11, repaired; the coefficients are this project's.
    """
    return combined(segments, *near_minimax(phase, terms), reuse=True)


MODELS = (
    AirlightModel(
        name="weng2010:taylor",
        function=weng2010_taylor,
        citation="Weng 2010, Eqs. 24, 29 and 30 and Figure 4.11, repaired",
        domain="does not converge where the segment contains the light's projection: with 5 terms every such visible "
        "segment is off by more than 1 %; of the others 23 % (Rayleigh), in float32 87 %",
        cost=COST,
        phases=POLYNOMIAL_PHASES,
    ),
    AirlightModel(
        name="weng2010:minimax",
        function=weng2010_minimax,
        citation="Weng 2010, Eqs. 24, 29 and 30 and Figure 4.11, repaired; near-minimax coefficients",
        domain="its terms grow like (n-2)! / H^(n-1) and e^H: where the segment contains the light's projection, "
        "Rayleigh and HG 0.3 by 5 terms are within 1 % for H from 0.001 to 20 (float32: 0.1 to 5), 7 terms of Rayleigh "
        "from 0.01 to 20 (0.3 to 3), 9 of HG 0.6 from 0.1 to 10 (never), 21 of HG 0.9 never. Visible segments off by "
        "more than 1 %: 6 % (Rayleigh, 5 terms), in float32 64 %",
        cost=COST,
        phases=POLYNOMIAL_PHASES,
    ),
)
