"""The mathematics of single scattering: media, phase functions and models of the airlight, in float64.

>>> from analytic import Medium, airlight, phase
>>> fog = Medium.from_albedo(0.9, sigma_t=[0.10, 0.12, 0.15])
>>> airlight(h=0.5, x_a=-3.0, x_b=4.0, medium=fog, phase=phase("hg", g=0.6)).shape
(3,)

Positions on the ray are relative to the light's projection on it; the eye is at x_a.
"""

from __future__ import annotations

from analytic.airlight import MODELS, airlight
from analytic.medium import Medium, transmittance
from analytic.phase import phase

__all__ = ["MODELS", "Medium", "airlight", "phase", "transmittance"]
