"""Spheres of any size: fog, haze, dust, by Mie's solution.

A cloud of spheres has radii r of median r_g and geometric standard deviation s: ln r is normally distributed with
standard deviation ln s, and s = 1 is one size for all. Sums over sizes run in ln x, x = 2 pi r / lambda, on one grid
for all wavelengths of the same refractive index, for Mie's solution depends on x and the index alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.phase import phase
from analytic.spectra.bands import WAVELENGTHS
from analytic.spectra.mie_phase import intensity_moments, table
from analytic.spectra.spectral_medium import SpectralMedium

__all__ = ["MieOptics", "mie_optics", "mie_spheres"]

# Step in ln x, where a distribution is not narrower still. Spheres that do not absorb resonate in peaks too sharp for
# any step: droplets (x = 78, s = 1.35, n = 1.333) come within 4e-4 of a step of 2e-4, absorbing haze (x = 1.7, s = 1.5,
# 1.45 - 0.005i) within 1e-9.
STEP = 0.005
STEPS_PER_DEVIATION = 4.0
DEVIATIONS = 6.0
# sizes that carry less than this share of the largest contribution are left out
NEGLIGIBLE = 1e-7
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
    wavelengths : array_like, (n,)        [nm]
    radius : float                        median radius by number [um]
    index : array_like, () or (n,)        complex refractive index n - ik or n + ik: either sign of the imaginary part
        absorbs
    spread : float                        geometric standard deviation of the radii, 1 or more
    angles : int                          cosines in a table

    Raises
    ------
    ValueError
        If wavelengths, radius or the index's real part is not positive and finite, spread below 1, or angles below 2.
    ModuleNotFoundError
        If miepython is missing.

    Source: Bohren and Huffman 1983, Eqs. 4.53, 4.61, 4.62 and 4.74, by miepython.
    """
    nm = np.atleast_1d(np.asarray(wavelengths, dtype=np.float64))
    given = np.asarray(index, dtype=np.complex128)
    for name, value in (("wavelengths", nm), ("radius", np.asarray(radius)), ("index", given.real)):
        if not (np.all(np.isfinite(value)) and np.all(value > 0)):
            raise ValueError(f"{name} must be positive and finite")
    if not np.all(np.isfinite(given.imag)) or given.shape not in ((), nm.shape):
        raise ValueError("index must be one finite number, or one a wavelength")
    if not (np.isfinite(spread) and spread >= 1):
        raise ValueError(f"spread must be finite and at least 1: {spread}")
    if angles < 2:
        raise ValueError(f"angles must be at least 2: {angles}")
    miepython = _miepython()

    indices = np.broadcast_to(given, nm.shape)  # miepython takes n - ik, and n + ik for the same
    um = nm * NM_TO_UM
    scattering, extinction, mean_cosine = (np.empty(nm.shape) for _ in range(3))
    tables = np.empty((nm.size, angles))
    for value in np.unique(indices):
        here = indices == value
        sizes, number = _sizes(2 * np.pi * radius / um[here], spread)
        q_ext, q_sca, _, g = miepython.efficiencies_mx(value, sizes)
        area = number * (np.outer(um[here], sizes) ** 2 / (4 * np.pi))
        scattering[here] = area @ q_sca
        # without absorption the two are equal, and rounding shall not make extinction the smaller
        extinction[here] = area @ np.maximum(q_ext, q_sca)
        mean_cosine[here] = area @ (q_sca * g) / scattering[here]
        moments = intensity_moments([miepython.coefficients(value, size) for size in sizes], number)
        tables[here] = table(moments, angles)
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
        If number_density or metres_per_unit is not positive and finite, or `mie_optics` refuses an argument.
    ModuleNotFoundError
        If miepython is missing.
    """
    for name, value in (("number_density", number_density), ("metres_per_unit", metres_per_unit)):
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be positive and finite: {value}")
    optics = mie_optics(WAVELENGTHS, radius, index, spread, angles)
    scale = number_density * PER_CM3_TO_PER_M3 * UM2_TO_M2 * metres_per_unit
    phases = [phase("tabulated", values=tuple(values)) for values in optics.tables.tolist()]
    return SpectralMedium(scale * optics.scattering, scale * optics.extinction, phases)


def _sizes(medians: NDArray[np.float64], spread: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Size parameters, (k,), and how many of a cloud's spheres each stands for at each median, (n, k)."""
    if spread == 1:
        return medians, np.eye(medians.size)
    deviation = np.log(spread)
    step = min(STEP, deviation / STEPS_PER_DEVIATION)
    # small spheres scatter like r^6, which moves the middle of the distribution up by 6 deviations squared
    low = np.log(medians.min()) - DEVIATIONS * deviation
    high = np.log(medians.max()) + (DEVIATIONS + 6 * deviation) * deviation
    log_size = np.arange(low, high + step, step)
    normal = np.exp(-(((log_size - np.log(medians)[:, None]) / deviation) ** 2) / 2)
    number = normal * (step / (deviation * np.sqrt(2 * np.pi)))
    # an efficiency is of order 1 for large spheres and of order x^4 for small ones
    share = number * np.exp(2 * log_size + np.minimum(4 * log_size, 0))
    counts = np.any(share > NEGLIGIBLE * share.max(axis=1, keepdims=True), axis=0)
    return np.exp(log_size[counts]), number[:, counts]


def _miepython() -> ModuleType:
    try:
        import miepython
    except ModuleNotFoundError:
        message = "Mie scattering needs miepython, which is missing: pip install 'airlight[spectra]'."
        raise ModuleNotFoundError(message, name="miepython") from None
    return miepython
