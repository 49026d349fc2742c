"""Airlight in closed form with four complex Ei, after Pegoraro, Schott and Parker 2009.

Pegoraro and Parker 2009 (Eurographics) solve the isotropic air-light integral with the complex exponential integral;
Pegoraro, Schott and Parker 2009 (Graphics Interface) combine two formulations of it so that anisotropic phase functions
and lights are taken as well, with "an explicit control on the accuracy": the number of terms of the expansion. Weng
2010, section 4.3, takes the change of variable, both formulations and their antiderivatives from the latter, and
section 4.4 adds the third evaluation for the fourth; the authors had reduced it likewise in the same year ("Reduced
Dual-Formulation for Analytical Anisotropic Single Scattering", High Performance Graphics 2009, poster).

So this is Weng's form, repaired, before that reduction. Its value is that of `weng2010:taylor` to the last digit, for
i(-H, 1) and j(H, -1) are conjugates of one Ei; what differs is the cost. Only abstracts of the papers and what Weng
cites of them were at hand, so no equation of theirs is numbered here. Their light distributions are not part of it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.models.model import AirlightModel
from analytic.models.weng2010.combined import combined
from analytic.models.weng2010.polynomials import POLYNOMIAL_PHASES, taylor
from analytic.phase import Phase
from analytic.segments import Segments

__all__ = ["MODEL", "pegoraro2009"]


def pegoraro2009(segments: Segments, phase: Phase, *, terms: int = 5) -> NDArray[np.floating]:
    """Airlight of unit intensity and unit scattering coefficient.

    Parameters
    ----------
    segments : Segments, (n,)
    phase : Phase              one of `POLYNOMIAL_PHASES`
    terms : int                coefficients of the Taylor series, 1 to 100; the isotropic one needs no more than one

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Raises
    ------
    ValueError
        If terms is below 1 or above 100.

    Source: Pegoraro, Schott and Parker 2009, as given by Weng 2010, Eqs. 17 to 30, repaired.
    """
    return combined(segments, *taylor(phase, terms), reuse=False)


MODEL = AirlightModel(
    name="pegoraro2009",
    function=pegoraro2009,
    citation="Pegoraro, Schott and Parker 2009; Pegoraro and Parker 2009 (isotropic)",
    domain="as weng2010:taylor, whose value it has to the last digit; isotropic as weng2010:four-ei",
    cost="4 complex and 2 real exponential integrals where the segment contains the light's projection, 2 complex and "
    "at most 2 real ones elsewhere; otherwise as weng2010:taylor",
    phases=POLYNOMIAL_PHASES,
)
