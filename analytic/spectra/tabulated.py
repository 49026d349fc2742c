"""A medium measured by wavelength."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from analytic.inputs import real_array
from analytic.phase import Phase
from analytic.spectra.bands import WAVELENGTHS
from analytic.spectra.coefficients import checked_coefficients
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
        If the wavelengths are not ascending or do not reach from 380 to 780 nm, if the spectra are not as many real
        numbers, if one is negative, infinite or NaN, if sigma_s exceeds sigma_t, or if the phase function is not made
        by `analytic.phase`.
    """
    if not isinstance(phase, Phase):
        raise ValueError(f"phase must be made by analytic.phase, not be a {type(phase).__name__}")
    grid = real_array("wavelengths", wavelengths)
    if grid.ndim != 1 or not np.all(np.isfinite(grid)) or not np.all(np.diff(grid) > 0):
        raise ValueError("wavelengths must be finite numbers in ascending order")
    if grid.size == 0 or grid[0] > WAVELENGTHS[0] or grid[-1] < WAVELENGTHS[-1]:
        reach = f"not from {grid[0]:g} to {grid[-1]:g} nm" if grid.size else "and are empty"
        raise ValueError(f"wavelengths must reach from {WAVELENGTHS[0]:g} to {WAVELENGTHS[-1]:g} nm, {reach}")
    # here, for a bad value between two grid points would leave no trace in the interpolated spectrum
    scattering, extinction = checked_coefficients(grid, sigma_s, sigma_t)
    return SpectralMedium(np.interp(WAVELENGTHS, grid, scattering), np.interp(WAVELENGTHS, grid, extinction), phase)
