"""What three bands get wrong: the same light, integrated over the spectrum and carried by three coefficients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.airlight import airlight
from analytic.inputs import real_array
from analytic.medium import Medium, transmittance
from analytic.spectra.bands import LUMINANCE, WAVELENGTHS, responses
from analytic.spectra.spectral_medium import SpectralMedium

__all__ = ["ThreeBandError", "airlight_error", "transmittance_error"]


@dataclass(frozen=True, eq=False)
class ThreeBandError:
    """Two results in linear Rec.709, in which the light itself is (1, 1, 1).

    Attributes
    ----------
    spectral : ndarray, (..., 3)    integrated in steps of 5 nm, then projected; a channel may be negative
    three_band : ndarray, (..., 3)  from three coefficients
    white : ndarray, (...)          luminance of the white that colours are seen against
    """

    spectral: NDArray[np.float64]
    three_band: NDArray[np.float64]
    white: NDArray[np.float64]

    @property
    def relative(self) -> NDArray[np.float64]:
        """(three_band - spectral) / |spectral|, (..., 3).

        NaN where both are 0, as at an infinite distance or where x_a = x_b; inf where the spectral result alone is 0.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            return (self.three_band - self.spectral) / np.abs(self.spectral)

    @property
    def delta_e(self) -> NDArray[np.float64]:
        """CIE Delta E 2000 between the two, (...), seen against D65 white of luminance `white`; 1 is just visible.

        NaN where the white is 0: nothing is seen there.

        Source: CIE 142:2001, by colour-science.
        """
        import colour

        space = colour.RGB_COLOURSPACES["ITU-R BT.709"]
        white = np.where(self.white == 0, np.nan, self.white)[..., None]
        exact, bands = (
            colour.XYZ_to_Lab(rgb / white @ space.matrix_RGB_to_XYZ.T, space.whitepoint)
            for rgb in (self.spectral, self.three_band)
        )
        return np.asarray(colour.delta_E(exact, bands, method="CIE 2000"), dtype=np.float64)


def transmittance_error(
    spectral: SpectralMedium, medium: Medium, distance: ArrayLike, illuminant: str = "D65"
) -> ThreeBandError:
    """Light that crosses a distance, seen against the light itself as white.

    Parameters
    ----------
    spectral : SpectralMedium      the truth
    medium : Medium                RGB; `spectral.medium()`, or anybody's coefficients
    distance : array_like, (...)   length of the path [scene unit]
    illuminant : str               spectrum of the light, as for `responses`

    Returns
    -------
    ThreeBandError  of shape (..., 3)

    Raises
    ------
    ValueError
        If distance is negative, NaN or no real number, the medium not RGB, or the illuminant unknown.
    """
    _require(spectral, medium)
    length = real_array("distance", distance)[..., None]
    exact = transmittance(spectral.sigma_t, length) @ responses(illuminant).T
    return ThreeBandError(exact, transmittance(medium.sigma_t, length), np.ones(exact.shape[:-1]))


def airlight_error(
    spectral: SpectralMedium,
    medium: Medium,
    h: ArrayLike,
    x_a: ArrayLike,
    x_b: ArrayLike,
    illuminant: str = "D65",
) -> ThreeBandError:
    """Airlight of a point light, seen in a picture exposed for it: white has the spectral result's luminance.

    Each wavelength has its own coefficients and phase function; the three bands share `spectral.phase()`.

    Parameters
    ----------
    spectral : SpectralMedium            the truth
    medium : Medium                      RGB; `spectral.medium()`, or anybody's coefficients
    h, x_a, x_b : array_like, (...)      the ray's piece, as for `analytic.airlight` [scene unit]; it has to miss the
        light
    illuminant : str                     spectrum of the light, as for `responses`

    Returns
    -------
    ThreeBandError  of shape (..., 3), for a light of intensity 1 in each channel

    Raises
    ------
    ValueError
        If h, x_a or x_b is one that `analytic.airlight` refuses, if the ray meets the light, the medium is not RGB, or
        the illuminant is unknown.
    """
    _require(spectral, medium)
    height, start, end = (real_array(name, value) for name, value in (("h", h), ("x_a", x_a), ("x_b", x_b)))
    phases = spectral.phases * (WAVELENGTHS.size // len(spectral.phases))
    coefficients = zip(spectral.sigma_s, spectral.sigma_t, phases, strict=True)
    by_wavelength = np.stack(
        [airlight(height, start, end, Medium(s, t), phase) for s, t, phase in coefficients], axis=-1
    )
    if not np.all(np.isfinite(by_wavelength)):
        raise ValueError("h must not be 0 where the ray meets the light: it is infinitely bright there")
    exact = by_wavelength @ responses(illuminant).T
    return ThreeBandError(exact, airlight(height, start, end, medium, spectral.phase(illuminant)), exact @ LUMINANCE)


def _require(spectral: SpectralMedium, medium: Medium) -> None:
    if not isinstance(spectral, SpectralMedium):
        raise ValueError(f"spectral must be a SpectralMedium, not a {type(spectral).__name__}")
    if not isinstance(medium, Medium) or medium.sigma_t.shape != (3,):
        raise ValueError("medium must be an RGB analytic.Medium")
