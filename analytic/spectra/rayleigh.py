"""Molecular scattering of air."""

from __future__ import annotations

from analytic.phase import phase
from analytic.spectra.bands import WAVELENGTHS
from analytic.spectra.coefficients import positive_number
from analytic.spectra.spectral_medium import SpectralMedium

__all__ = ["rayleigh_air"]

NM_TO_CM = 1e-7
PER_CM_TO_PER_M = 100.0
STANDARD_PRESSURE = 101325.0  # [Pa], of the standard air that the cross-section's refractive index holds for


def rayleigh_air(
    metres_per_unit: float = 1.0, temperature: float = 288.15, pressure: float = STANDARD_PRESSURE
) -> SpectralMedium:
    """Dry air without dust: lambda^-4, the dispersion of air and the King factor of its gases; nothing is absorbed.

    The cross-section of a molecule does not depend on the weather, so it is taken at standard air, where colour-science
    has the refractive index; temperature and pressure only change how many molecules there are.

    The phase function is Rayleigh's. The King factor (1.049 at 555 nm) belongs to molecules that are not round, whose
    own phase function is 1.4 % lower forward and backward and 1.4 % higher at 90 degrees (Bucholtz 1995); that is
    neglected.

    Parameters
    ----------
    metres_per_unit : float  length of the scene unit [m]
    temperature : float      [K]
    pressure : float         [Pa]

    Returns
    -------
    SpectralMedium

    Raises
    ------
    ValueError
        If an argument is not one number, positive and finite.

    Source: Bodhaine, Wood, Dutton and Slusser 1999, by colour-science.
    """
    length, kelvin, pascal = (
        positive_number(name, value)
        for name, value in (("metres_per_unit", metres_per_unit), ("temperature", temperature), ("pressure", pressure))
    )
    from colour.phenomena.rayleigh import molecular_density, scattering_cross_section

    cross_section = scattering_cross_section(WAVELENGTHS * NM_TO_CM)  # [cm^2]
    molecules = molecular_density(kelvin) * pascal / STANDARD_PRESSURE  # [1/cm^3]
    sigma = cross_section * molecules * PER_CM_TO_PER_M * length
    return SpectralMedium(sigma, sigma, phase("rayleigh"))
