"""Weng 2010: the thesis's closed forms, as printed and repaired.

`merged` is the one to use. `printed` is the print; `isotropic` and `polynomial` repair it and leave it unmerged, on top
of `antiderivatives` (Eqs. 20 to 32), `combined` (Eqs. 24, 29 and 30) and `polynomials` (phase functions as such).

"Visible segments" in what the models say of themselves: 20,000 with H = sigma_t h from 1e-4 to 50 (its logarithm
uniform), both ends uniform within 50 optical units of the light's projection, and the light at an optical depth of 12
or less from the eye. Half of them contain the projection, 6 % lie before it, 44 % behind. Rounding to float32 precedes
the evaluation; the truth is `quadrature` of the rounded segment.
"""

from __future__ import annotations

from analytic.models.weng2010 import isotropic, merged, polynomial, printed

MODELS = (merged.MODEL, printed.MODEL, *isotropic.MODELS, *polynomial.MODELS)
