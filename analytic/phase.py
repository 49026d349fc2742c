"""Phase functions: how scattered light spreads over directions.

cos_theta is the cosine of the angle between the directions in which light travels before and after it is scattered;
+1 is forward. Every function integrates to 1 over the sphere and is given in 1/sr.

A new one is a frozen dataclass with the members of `Phase`, in a file of its own in `phases`, and an entry in `PHASES`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.phases.cornette_shanks import CornetteShanks
from analytic.phases.henyey_greenstein import HenyeyGreenstein
from analytic.phases.isotropic import Isotropic
from analytic.phases.rayleigh import Rayleigh
from analytic.phases.schlick import Schlick
from analytic.phases.tabulated import Tabulated

__all__ = ["PHASES", "Phase", "phase"]


class Phase(Protocol):
    """What an airlight model may ask of a phase function."""

    name: ClassVar[str]

    def evaluate(self, cos_theta: ArrayLike) -> NDArray[np.float64]:
        """Value [1/sr] at cos_theta, (...), from -1 (backward) to 1 (forward)."""

    @property
    def mean_cosine(self) -> float:
        """Average of cos_theta over the sphere, weighted by the function."""

    @property
    def analytic_radius(self) -> float:
        """Radius about v = 0 in which the function of v, cos_theta = (1 - v^2) / (1 + v^2), is analytic; at most 1.

        It is the width of the forward peak in v = tan(theta / 2): quadratures choose their spacing by it. Of a function
        with kinks, it is that of the pieces.
        """

    @property
    def kinks(self) -> tuple[float, ...]:
        """Cosines, ascending, between which the function is analytic; a quadrature has to stop at each."""


PHASES: dict[str, type[Phase]] = {
    kind.name: kind for kind in (Isotropic, Rayleigh, HenyeyGreenstein, Schlick, CornetteShanks, Tabulated)
}


def phase(name: str, **parameters: float | Sequence[float]) -> Phase:
    """Phase function by its name.

    Parameters
    ----------
    name : str        "isotropic", "rayleigh", "hg", "schlick", "cornette_shanks" or "tabulated"
    **parameters      what that function takes: `g` for "hg" and "cornette_shanks", `k` for "schlick", `values` for
        "tabulated", nothing for the others

    Returns
    -------
    Phase  with `evaluate(cos_theta)` [1/sr] and `mean_cosine`

    Raises
    ------
    ValueError
        If the name is unknown, or a parameter is missing, not one of that function's, or out of its range.

    Examples
    --------
    >>> float(phase("hg", g=0.6).mean_cosine)
    0.6
    """
    if name not in PHASES:
        raise ValueError(f"name must be one of {', '.join(sorted(PHASES))}: {name!r}")
    wanted = [field.name for field in fields(PHASES[name])]  # type: ignore[arg-type]
    for parameter in parameters:
        if parameter not in wanted:
            raise ValueError(f"{parameter} is not a parameter of the phase function {name!r}")
    for parameter in wanted:
        if parameter not in parameters:
            raise ValueError(f"{parameter} is needed by the phase function {name!r}")
    return PHASES[name](**parameters)
