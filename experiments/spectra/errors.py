"""Air, fog, haze and stained water: what three bands get wrong in each.

The eye looks past a light that is at distance D and 30 degrees off its ray; the ray is followed for 2 D. D runs so that
the optical depth to the light at 550 nm goes from 0.1 to 10. Transmittance is that of the distance D.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic import Medium, phase, spectra

Row = dict[str, Any]

DEPTHS = np.geomspace(0.1, 10, 9)
ANGLE = np.radians(30)
GREEN = int(np.searchsorted(spectra.WAVELENGTHS, 550))
# where Bruneton and Neyret 2008, section 2.1, take the coefficients of air
SAMPLED = np.searchsorted(spectra.WAVELENGTHS, (680, 550, 440))
COEFFICIENTS = ("mean", "matched", "sampled")
QUANTITIES = ("transmittance", "airlight")
ONE_PHASE = "airlight, one phase function"

# real refractive index of water from 375 to 800 nm in steps of 25 nm (Hale and Querry 1973, Table I); its imaginary
# part is below 2e-7 there
WATER = [1.341, 1.339, 1.338, 1.337, 1.336, 1.335, 1.334, 1.333, 1.333]
WATER += [1.332, 1.332, 1.331, 1.331, 1.331, 1.330, 1.330, 1.330, 1.329]


@dataclass(frozen=True)
class Case:
    """A medium of the experiment, its scene unit, and what to say of it."""

    make: Callable[[], spectra.SpectralMedium]
    unit: str
    what: str


def _fog() -> spectra.SpectralMedium:
    # to the three decimals that were published: spheres of one index share their sums
    index = np.round(np.interp(spectra.WAVELENGTHS, np.arange(375, 801, 25), WATER), 3)
    return spectra.mie_spheres(radius=5.0, index=index, number_density=50.0, spread=1.35)


def _haze() -> spectra.SpectralMedium:
    return spectra.mie_spheres(0.15, 1.45 - 0.005j, number_density=2000.0, spread=1.5, metres_per_unit=1000.0)


def _stained_water() -> spectra.SpectralMedium:
    absorbed = np.exp(-0.014 * (spectra.WAVELENGTHS - 440))
    return spectra.tabulated(spectra.WAVELENGTHS, np.full_like(absorbed, 0.5), 0.5 + absorbed, phase("hg", g=0.9))


MEDIA: dict[str, Case] = {
    "air": Case(partial(spectra.rayleigh_air, metres_per_unit=1000.0), "km", "molecules at 288.15 K and 1013.25 hPa"),
    "fog": Case(
        _fog, "m", "50 droplets of water a cm^3, median radius 5 um, geometric deviation 1.35 (Hale and Querry 1973)"
    ),
    "haze": Case(
        _haze, "km", "2000 spheres a cm^3 of index 1.45 - 0.005i, median radius 0.15 um, geometric deviation 1.5"
    ),
    "stained water": Case(
        _stained_water,
        "m",
        "absorption 1/m at 440 nm, falling by 0.014 per nm (dissolved organic matter: Bricaud, Morel and Prieur 1981); "
        "scattering 0.5/m, `hg` 0.9; water's own absorption left out",
    ),
}


def measure_medium(name: str, medium: spectra.SpectralMedium) -> list[Row]:
    """One row a choice of coefficients, quantity and depth: both results, relative errors and Delta E 2000."""
    unit_depth = float(1 / medium.sigma_t[GREEN])
    choices = {
        "mean": medium.medium(),
        "matched": medium.medium(distance=unit_depth),
        "sampled": Medium(medium.sigma_s[SAMPLED], medium.sigma_t[SAMPLED]),
    }
    distance = DEPTHS * unit_depth
    ray = (distance * np.sin(ANGLE), -distance * np.cos(ANGLE), distance * (2 - np.cos(ANGLE)))
    rows = []
    for choice, bands in choices.items():
        errors = {
            "transmittance": spectra.transmittance_error(medium, bands, distance),
            "airlight": spectra.airlight_error(medium, bands, *ray),
        }
        if choice == "mean" and len(medium.phases) > 1:
            errors[ONE_PHASE] = spectra.airlight_error(_one_phase(medium), bands, *ray)
        for quantity, error in errors.items():
            head: Row = {"medium": name, "coefficients": choice, "quantity": quantity}
            rows += [head | _at(error, number) for number in range(DEPTHS.size)]
            for row, length in zip(rows[-DEPTHS.size :], distance, strict=True):
                row["distance"] = float(length)
    return rows


def _one_phase(medium: spectra.SpectralMedium) -> spectra.SpectralMedium:
    return spectra.SpectralMedium(medium.sigma_s, medium.sigma_t, medium.phase())


def _at(error: spectra.ThreeBandError, number: int) -> Row:
    columns = {"spectral": error.spectral, "three_band": error.three_band, "relative": error.relative}
    channels = {
        f"{name}_{channel}": float(values[number, index])
        for name, values in columns.items()
        for index, channel in enumerate(spectra.CHANNELS)
    }
    return {"optical_depth": float(DEPTHS[number]), **channels, "delta_e": float(error.delta_e[number])}


def select(rows: list[Row], column: str, **where: str) -> NDArray[np.float64]:
    """Values of a column, (depths,), in the rows that have the given medium, coefficients and quantity."""
    return np.array([row[column] for row in rows if all(row[key] == value for key, value in where.items())])
