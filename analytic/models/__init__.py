"""Models of the airlight: how much light one lit piece of a ray sends to the eye.

One file each, named by author and year where published. A new one is a file with a function of (segments, phase) and
its record, an `AirlightModel` named `MODEL`, and its name in the two lists below. A paper with several variants is a
folder that lists them as `MODELS`.
"""

from __future__ import annotations

from analytic.models import (
    equiangular,
    one_ei,
    pegoraro2009,
    quadrature,
    quadrature_float32,
    riemann,
    sun2005,
    weng2010,
)
from analytic.models.model import AirlightModel, by_name

__all__ = ["MODELS", "AirlightModel"]

MODELS: dict[str, AirlightModel] = by_name(
    quadrature.MODEL,
    riemann.MODEL,
    one_ei.MODEL,
    pegoraro2009.MODEL,
    *weng2010.MODELS,
    quadrature_float32.MODEL,
    equiangular.MODEL,
    *sun2005.MODELS,
)
