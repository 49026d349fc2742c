"""Media known by wavelength, the three bands that a renderer makes of them, and the error of doing so.

>>> from analytic import spectra
>>> air = spectra.rayleigh_air(metres_per_unit=1000)   # coefficients in 1/km
>>> air.medium().sigma_s.round(4).tolist()             # linear Rec.709
[0.0056, 0.0118, 0.0277]
>>> far = spectra.transmittance_error(air, air.medium(), distance=100)
>>> (100 * far.relative).round(1).tolist()             # per cent, in each channel
[3.1, 4.3, 18.7]

Spectra are held at `WAVELENGTHS`. colour-science is needed, and miepython by `mie_spheres` alone; neither is imported
before a function needs it.
"""

from __future__ import annotations

from analytic.spectra.bands import CHANNELS, WAVELENGTHS, responses, three_bands
from analytic.spectra.error import ThreeBandError, airlight_error, transmittance_error
from analytic.spectra.mie import MieOptics, mie_optics, mie_spheres
from analytic.spectra.rayleigh import rayleigh_air
from analytic.spectra.spectral_medium import SpectralMedium
from analytic.spectra.tabulated import tabulated

__all__ = [
    "CHANNELS",
    "WAVELENGTHS",
    "MieOptics",
    "SpectralMedium",
    "ThreeBandError",
    "airlight_error",
    "mie_optics",
    "mie_spheres",
    "rayleigh_air",
    "responses",
    "tabulated",
    "three_bands",
    "transmittance_error",
]
