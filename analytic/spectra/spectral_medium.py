"""A homogeneous medium that is known at every wavelength."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.medium import Medium
from analytic.phase import Phase, phase
from analytic.phases.tabulated import Tabulated
from analytic.spectra.bands import LUMINANCE, WAVELENGTHS, responses, three_bands
from analytic.spectra.coefficients import checked_coefficients

__all__ = ["SpectralMedium"]


@dataclass(frozen=True, eq=False)
class SpectralMedium:
    """Coefficients and phase functions at `WAVELENGTHS`.

    Attributes
    ----------
    sigma_s : ndarray, (81,)     scattering coefficient [1 / scene unit]
    sigma_t : ndarray, (81,)     extinction coefficient [1 / scene unit], absorption included
    phases : tuple of Phase      one for all wavelengths, or 81 tables of one length

    Raises
    ------
    ValueError
        If a coefficient is not 81 real numbers, negative, infinite or NaN, if sigma_s exceeds sigma_t, or if the phase
        functions are not made by `analytic.phase`, or neither one nor 81 tables of one length.
    """

    sigma_s: NDArray[np.float64]
    sigma_t: NDArray[np.float64]
    phases: tuple[Phase, ...]

    def __init__(self, sigma_s: ArrayLike, sigma_t: ArrayLike, phases: Phase | Sequence[Phase]) -> None:
        scattering, extinction = checked_coefficients(WAVELENGTHS, sigma_s, sigma_t)
        functions = tuple(phases) if isinstance(phases, Sequence) else (phases,)
        strangers = [type(function).__name__ for function in functions if not isinstance(function, Phase)]
        if strangers:
            raise ValueError(f"phases must be made by analytic.phase, not be a {strangers[0]}")
        if len(functions) != 1:
            lengths = {len(function.values) if isinstance(function, Tabulated) else 0 for function in functions}
            if len(functions) != WAVELENGTHS.size or len(lengths) != 1 or 0 in lengths:
                raise ValueError(f"phases must be one, or {WAVELENGTHS.size} tables of one length")
        object.__setattr__(self, "sigma_s", scattering)
        object.__setattr__(self, "sigma_t", extinction)
        object.__setattr__(self, "phases", functions)

    def medium(self, distance: float = 0.0, illuminant: str = "D65", clip: bool = False) -> Medium:
        """Linear Rec.709 coefficients; parameters and errors are those of `three_bands`."""
        return three_bands(self.sigma_s, self.sigma_t, distance, illuminant, clip)

    def phase(self, illuminant: str = "D65") -> Phase:
        """The one phase function that gives the luminance which a thin medium scatters into each direction.

        It is the mean over wavelengths, weighted by luminance and scattering coefficient. Colours that differ between
        directions, a fogbow's, are lost.
        """
        if len(self.phases) == 1:
            return self.phases[0]
        weights = (LUMINANCE @ responses(illuminant)) * self.sigma_s
        tables = np.array([function.values for function in self.phases if isinstance(function, Tabulated)])
        return phase("tabulated", values=tuple((weights @ tables).tolist()))
