"""What the numbers of a medium have to be, wherever they come from."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.inputs import real_array, real_number

__all__ = ["checked_coefficients", "positive_number"]


def checked_coefficients(
    wavelengths: NDArray[np.float64], sigma_s: ArrayLike, sigma_t: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Copies of both coefficients as read-only float64 arrays, (n,), once they make sense at the wavelengths.

    Parameters
    ----------
    wavelengths : ndarray, (n,)  [nm]
    sigma_s : array_like, (n,)   scattering coefficient [1 / scene unit]
    sigma_t : array_like, (n,)   extinction coefficient [1 / scene unit]

    Raises
    ------
    ValueError
        If a coefficient is not one real number a wavelength, negative, infinite or NaN, or if sigma_s exceeds sigma_t.
    """
    scattering, extinction = real_array("sigma_s", sigma_s), real_array("sigma_t", sigma_t)
    for name, spectrum in (("sigma_s", scattering), ("sigma_t", extinction)):
        if spectrum.shape != wavelengths.shape:
            raise ValueError(
                f"{name} must be {wavelengths.size} numbers, one a wavelength, not of shape {spectrum.shape}"
            )
        if not np.all(np.isfinite(spectrum)) or np.any(spectrum < 0):
            raise ValueError(f"{name} must be finite and not negative")
        spectrum.setflags(write=False)
    if np.any(scattering > extinction):
        worst = wavelengths[np.argmax(scattering - extinction)]
        raise ValueError(f"sigma_s must not exceed sigma_t, as it does at {worst:g} nm")
    return scattering, extinction


def positive_number(name: str, value: ArrayLike) -> float:
    """One positive finite number.

    Raises
    ------
    ValueError
        If it is anything else.
    """
    number = real_number(name, value)
    if not (np.isfinite(number) and number > 0):
        raise ValueError(f"{name} must be positive and finite: {number}")
    return number
