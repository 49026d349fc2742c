"""Spheres of any size: fog, haze, dust, by Mie's solution.

A cloud of spheres has radii r of median r_g and geometric standard deviation s: ln r is normally distributed with
standard deviation ln s, and s = 1 is one size for all. Sums over sizes run in ln x, x = 2 pi r / lambda, on one grid
for all wavelengths of the same refractive index, for Mie's solution depends on x and the index alone. The sizes that
count reach far above the median when s is large, by e^{2 ln^2 s} and 5.7 deviations, and cost grows with them.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.inputs import real_array, real_number, whole_number
from analytic.phase import phase
from analytic.spectra.bands import WAVELENGTHS
from analytic.spectra.coefficients import positive_number
from analytic.spectra.mie_phase import intensity_moments, table
from analytic.spectra.spectral_medium import SpectralMedium

__all__ = ["MieOptics", "mie_optics", "mie_spheres"]

# Step in ln x, where a distribution is not narrower still. Spheres that do not absorb resonate in peaks too sharp for
# any step: droplets (x = 78, s = 1.35, n = 1.333) come within 4e-4 of a step of 2e-4, absorbing haze (x = 1.7, s = 1.5,
# 1.45 - 0.005i) within 1e-9. Broad distributions need it as well: x = 1.3, s = 2, 1.45 - 0.005i comes within 2e-7 of a
# step of 0.00125 with it, and within 7e-5 with four times the step.
STEP = 0.005
STEPS_PER_DEVIATION = 4.0
DEVIATIONS = 6.0
# sizes that carry less than this share of the largest contribution are left out
NEGLIGIBLE = 1e-7
# a distribution with a smaller ln s is one size: cross-sections differ in the second order of ln s, the grid's rounding
# in the first of 1 / ln s
NARROWEST = 1e-6
# Mie's coefficients lose digits as 1 / |m - 1|: cross-sections are within 4e-10 at 1e-6, and at 1 nothing scatters
LEAST_CONTRAST = 1e-6
SMALLEST = 1e-30  # median x; scattering goes as its sixth power, and underflows not far below
LARGEST = 4000.0  # of max(1, |m|) x: what limits the time that a call can take
TOO_LARGE = (
    f"radius or spread must be smaller: spheres count whose size parameter 2 pi r / wavelength, times max(1, |index|), "
    f"exceeds {LARGEST:g}, where the sum over sizes ends"
)
PER_CM3_TO_PER_M3 = 1e6
UM2_TO_M2 = 1e-12
NM_TO_UM = 1e-3


@dataclass(frozen=True, eq=False)
class MieOptics:
    """One sphere's share in a cloud, averaged over the sizes.

    Attributes
    ----------
    scattering : ndarray, (n,)        cross-section [um^2]
    extinction : ndarray, (n,)        cross-section [um^2]
    mean_cosine : ndarray, (n,)       of the phase function
    tables : ndarray, (n, angles)     phase functions [1/sr] at equally spaced cos theta, the last one forward; means
        over hats, see `mie_phase`
    """

    scattering: NDArray[np.float64]
    extinction: NDArray[np.float64]
    mean_cosine: NDArray[np.float64]
    tables: NDArray[np.float64]


def mie_optics(
    wavelengths: ArrayLike, radius: float, index: ArrayLike, spread: float = 1.0, angles: int = 1001
) -> MieOptics:
    """Cross-sections and phase functions of spheres in air.

    Parameters
    ----------
    wavelengths : array_like, () or (n,)  [nm]
    radius : float                        median radius by number [um]
    index : array_like, () or (n,)        complex refractive index n - ik or n + ik: either sign of the imaginary part
        absorbs
    spread : float                        geometric standard deviation of the radii, 1 or more
    angles : int                          cosines in a table, 2 or more

    Raises
    ------
    ValueError
        If wavelengths are not one or more positive finite numbers in a row; if radius is not one positive finite
        number, or spread one finite number from 1; if the index is not finite, its real part not positive, or it is
        within 1e-6 of 1, where nothing scatters; if angles is not a whole number from 2; or if the sizes leave the
        range that is summed: a median size parameter 2 pi r / lambda below 1e-30, or the largest that counts, times
        max(1, |index|), above 4000.
    ModuleNotFoundError
        If miepython is missing.

    Notes
    -----
    The time goes with the square of the largest size parameter that counts, or worse; wavelengths of one index share
    it. On one core at 500 nm and index 1.45 - 0.005i, radius 0.1 and spread 2 take 0.4 s (sizes to 167), 0.1 and 2.5
    take 2.2 s (to 1224), 0.5 and 2.2 take 4.0 s (to 1910), and 7 s at all of `WAVELENGTHS`. The slowest found took
    10 s and 390 MB: radius 1, spread 2.2, index 1.02 (to 3828). Each further index costs as much again.

    Source: Bohren and Huffman 1983, Eqs. 4.53, 4.61, 4.62 and 4.74, by miepython.
    """
    nm = np.atleast_1d(real_array("wavelengths", wavelengths))
    if nm.ndim != 1 or not nm.size or not (np.all(np.isfinite(nm)) and np.all(nm > 0)):
        raise ValueError("wavelengths must be positive and finite, one or more in a row")
    middle, breadth = positive_number("radius", radius), real_number("spread", spread)
    if not (np.isfinite(breadth) and breadth >= 1):
        raise ValueError(f"spread must be finite and at least 1: {breadth}")
    cosines = whole_number("angles", angles, 2)
    indices = _indices(index, nm)
    um = nm * NM_TO_UM
    with np.errstate(over="ignore", divide="ignore"):
        medians = 2 * np.pi * middle / um
    if medians.min() < SMALLEST:
        raise ValueError(f"radius must be larger: what it scatters underflows where 2 pi r / wavelength < {SMALLEST:g}")
    kinds = [(value, indices == value) for value in np.unique(indices)]
    # all grids before the first sum, which may take long
    grids = [_sizes(medians[here], breadth, LARGEST / max(1.0, abs(value))) for value, here in kinds]

    miepython = _miepython()
    scattering, extinction, mean_cosine = (np.empty(nm.shape) for _ in range(3))
    tables = np.empty((nm.size, cosines))
    for (value, here), (sizes, number) in zip(kinds, grids, strict=True):
        coefficients = [miepython.coefficients(value, size) for size in sizes]
        moments = intensity_moments(coefficients, number)
        share = um[here] ** 2 / (2 * np.pi)  # 2 pi / k^2
        scattering[here] = share / 2 * moments[:, 0]
        sums = [np.sum((2 * np.arange(1, len(a) + 1) + 1) * (a + b).real) for a, b in coefficients]
        # with hardly any absorption the two are nearly equal, and rounding shall not make extinction the smaller
        absorbing = np.maximum(share * (number @ sums), scattering[here])
        extinction[here] = absorbing if value.imag else scattering[here]
        moments /= moments[:, :1]
        mean_cosine[here] = moments[:, 1]
        tables[here] = table(moments, cosines)
    return MieOptics(scattering, extinction, mean_cosine, tables)


def mie_spheres(
    radius: float,
    index: ArrayLike,
    number_density: float,
    spread: float = 1.0,
    metres_per_unit: float = 1.0,
    angles: int = 1001,
) -> SpectralMedium:
    """Cloud of spheres with a phase function for each wavelength.

    Parameters
    ----------
    radius : float                     median radius by number [um]
    index : array_like, () or (81,)    complex refractive index, as for `mie_optics`; at `WAVELENGTHS`
    number_density : float             spheres a volume [1/cm^3]
    spread : float                     geometric standard deviation of the radii, 1 or more
    metres_per_unit : float            length of the scene unit [m]
    angles : int                       cosines in a table

    Raises
    ------
    ValueError
        If number_density or metres_per_unit is not one positive finite number, or `mie_optics` refuses an argument.
    ModuleNotFoundError
        If miepython is missing.
    """
    density, length = (
        positive_number(name, value)
        for name, value in (("number_density", number_density), ("metres_per_unit", metres_per_unit))
    )
    optics = mie_optics(WAVELENGTHS, radius, index, spread, angles)
    scale = density * PER_CM3_TO_PER_M3 * UM2_TO_M2 * length
    phases = [phase("tabulated", values=tuple(values)) for values in optics.tables.tolist()]
    return SpectralMedium(scale * optics.scattering, scale * optics.extinction, phases)


def _indices(index: ArrayLike, wavelengths: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Refractive indices, (n,), once they make sense; miepython takes n - ik, and n + ik for the same."""
    try:
        given = np.asarray(index)
    except ValueError:  # rows of unequal length
        given = np.array(None)
    if given.dtype.kind not in "iufc" or given.shape not in ((), wavelengths.shape) or not np.all(np.isfinite(given)):
        raise ValueError("index must be one finite number, or one a wavelength; it may be complex")
    if np.any(given.real <= 0):
        raise ValueError("index must be positive in its real part")
    if np.any(np.abs(given - 1) < LEAST_CONTRAST):
        raise ValueError(
            f"index must differ from 1 by {LEAST_CONTRAST:g} or more: a sphere of air in air does not scatter"
        )
    return np.broadcast_to(given.astype(np.complex128), wavelengths.shape)


def _sizes(
    medians: NDArray[np.float64], spread: float, largest: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Size parameters, (k,), and how many of a cloud's spheres each stands for at each median, (n, k).

    Raises
    ------
    ValueError
        If sizes above `largest` count.
    """
    deviation = np.log(spread)
    # large spheres scatter like r^2, which moves the middle of the distribution up by 2 deviations squared
    if np.any(np.log(medians) + 2 * deviation**2 > np.log(largest)):
        raise ValueError(TOO_LARGE)
    if deviation < NARROWEST:
        return medians, np.eye(medians.size)
    step = min(STEP, deviation / STEPS_PER_DEVIATION)
    # small spheres scatter like r^6, which moves the middle of the distribution up by 6 deviations squared
    below, above = DEVIATIONS * deviation, (DEVIATIONS + 6 * deviation) * deviation
    reach = np.arange(-np.ceil(below / step), np.ceil(above / step) + 1)
    # multiples of one step for all medians, and only those near one: narrow distributions lie far apart
    log_size = step * np.unique(np.rint(np.log(medians) / step)[:, None] + reach)
    normal = np.exp(-(((log_size - np.log(medians)[:, None]) / deviation) ** 2) / 2)
    number = normal * (step / (deviation * np.sqrt(2 * np.pi)))
    # an efficiency is of order 1 for large spheres; of small ones that of scattering is of order x^4, of absorption x
    counts = np.zeros(log_size.size, dtype=bool)
    for power in (1, 4):
        share = number * np.exp(2 * log_size + np.minimum(power * log_size, 0))
        counts |= np.any(share > NEGLIGIBLE * share.max(axis=1, keepdims=True), axis=0)
    if np.any(log_size[counts] > np.log(largest)):
        raise ValueError(TOO_LARGE)
    return np.exp(log_size[counts]), number[:, counts]


def _miepython() -> ModuleType:
    try:
        import miepython
    except ModuleNotFoundError:
        message = "Mie scattering needs miepython, which is missing: pip install 'airlight[spectra]'."
        raise ModuleNotFoundError(message, name="miepython") from None
    return miepython
