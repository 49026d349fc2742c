"""Phase functions: how scattered light spreads over directions.

cos_theta is the cosine of the angle between the directions in which light travels before and after it is scattered;
+1 is forward. Every function integrates to 1 over the sphere and is given in 1/sr.

A new one is a frozen dataclass that derives from `Phase`, in a file of its own in `phases`, and an entry in `PHASES`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

from analytic.phases.base import Phase
from analytic.phases.cornette_shanks import CornetteShanks
from analytic.phases.henyey_greenstein import HenyeyGreenstein
from analytic.phases.isotropic import Isotropic
from analytic.phases.rayleigh import Rayleigh
from analytic.phases.schlick import Schlick
from analytic.phases.tabulated import Tabulated

__all__ = ["PHASES", "Phase", "phase"]

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
    if not isinstance(name, str) or name not in PHASES:
        raise ValueError(f"name must be one of {', '.join(sorted(PHASES))}: {name!r}")
    wanted = [field.name for field in fields(PHASES[name])]  # type: ignore[arg-type]
    for parameter in parameters:
        if parameter not in wanted:
            raise ValueError(f"{parameter} is not a parameter of the phase function {name!r}")
    for parameter in wanted:
        if parameter not in parameters:
            raise ValueError(f"{parameter} is needed by the phase function {name!r}")
    return PHASES[name](**parameters)
