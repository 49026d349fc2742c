"""Models of the airlight: how much light one lit piece of a ray sends to the eye.

One file each, named by author and year where published. A new one is a function of (h, x_a, x_b, sigma_t, phase), flat
float64 arrays in and out, and one entry in `MODELS`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.models.quadrature import quadrature
from analytic.models.riemann import riemann
from analytic.models.weng2010 import weng2010

__all__ = ["MODELS", "AirlightModel"]


@dataclass(frozen=True)
class AirlightModel:
    """What is known of a model.

    Attributes
    ----------
    function : callable  (h, x_a, x_b, sigma_t, phase, **options) -> L / (I sigma_s), flat arrays
    citation : str       where it comes from
    domain : str         where it is valid, and how accurate it is there
    cost : str           evaluations a segment
    """

    function: Callable[..., NDArray[np.float64]]
    citation: str
    domain: str
    cost: str


MODELS: dict[str, AirlightModel] = {
    "quadrature": AirlightModel(
        function=quadrature,
        citation="Weng 2010, Eq. 18, repaired; composite Gauss-Legendre in ln(v + r)",
        domain="every phase function, h >= 0, segments of any length, clear to opaque media: 1e-12 relative (measured: "
        "7e-14; hg 0.99: 3e-12, because float64 rounds the cosine itself)",
        cost="20 nodes a panel, 1 to 33 panels; 2 exponentials a node",
    ),
    "riemann": AirlightModel(
        function=riemann,
        citation="Weng 2010, Eq. 16, midpoint rule; Nishita, Miyawaki and Nakamae 1987",
        domain="every phase function, finite segments; second order once the step is well below h and 1 / sigma_t",
        cost="`steps` (64) exponentials and square roots",
    ),
    "weng2010": AirlightModel(
        function=weng2010,
        citation="Weng 2010, Eq. 21, repaired and merged; Pegoraro and Parker 2009",
        domain="isotropic; loses the digits that both ends share (short segments, segments before the light)",
        cost="2 complex exponential integrals, 2 exponentials, 2 square roots",
    ),
}
