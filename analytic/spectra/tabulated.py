"""A medium measured by wavelength."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from analytic.phase import Phase
from analytic.spectra.bands import WAVELENGTHS
from analytic.spectra.spectral_medium import SpectralMedium

__all__ = ["tabulated"]


def tabulated(wavelengths: ArrayLike, sigma_s: ArrayLike, sigma_t: ArrayLike, phase: Phase) -> SpectralMedium:
    """Medium of given spectra, interpolated linearly between the wavelengths; structure below 5 nm is not seen.

    Parameters
    ----------
    wavelengths : array_like, (n,)  ascending, from 380 or below to 780 or above [nm]
    sigma_s : array_like, (n,)      scattering coefficient [1 / scene unit]
    sigma_t : array_like, (n,)      extinction coefficient [1 / scene unit]
    phase : Phase                   phase function, from `analytic.phase`

    Raises
    ------
    ValueError
        If the wavelengths are not ascending or do not reach from 380 to 780 nm, if the spectra are not as many numbers,
        or if one is negative, infinite or NaN, or sigma_s above sigma_t.
    """
    grid = np.asarray(wavelengths, dtype=np.float64)
    if grid.ndim != 1 or not np.all(np.isfinite(grid)) or not np.all(np.diff(grid) > 0):
        raise ValueError("wavelengths must be finite numbers in ascending order")
    if grid.size == 0 or grid[0] > WAVELENGTHS[0] or grid[-1] < WAVELENGTHS[-1]:
        reach = f"not from {grid[0]:g} to {grid[-1]:g} nm" if grid.size else "and are empty"
        raise ValueError(f"wavelengths must reach from {WAVELENGTHS[0]:g} to {WAVELENGTHS[-1]:g} nm, {reach}")
    checked = []
    for name, value in (("sigma_s", sigma_s), ("sigma_t", sigma_t)):
        spectrum = np.asarray(value, dtype=np.float64)
        if spectrum.shape != grid.shape:
            raise ValueError(f"{name} must be {grid.size} numbers, one a wavelength, not of shape {spectrum.shape}")
        # a bad value between two grid points would leave no trace in the interpolated spectrum
        if not np.all(np.isfinite(spectrum)) or np.any(spectrum < 0):
            raise ValueError(f"{name} must be finite and not negative")
        checked.append(spectrum)
    scattering, extinction = checked
    if np.any(scattering > extinction):
        worst = grid[np.argmax(scattering - extinction)]
        raise ValueError(f"sigma_s must not exceed sigma_t, as it does at {worst:g} nm")
    return SpectralMedium(np.interp(WAVELENGTHS, grid, scattering), np.interp(WAVELENGTHS, grid, extinction), phase)
