"""How accurate the complex exponential integral is over the plane: scipy's, and ours in both precisions.

Float64 values are compared with mpmath's of 30 digits. Ours in float32 is compared with the same at the same points,
for the picture, and with float64 at many more, for the table. All points are float32 numbers, so every implementation
is asked for the same z.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.exponential_integral import ei, scaled_e1
from experiments.provenance import environment, package_version
from scenes.replacing import make_folder, replacing

__all__ = ["write_map"]

# rows of the table; the expansions change at 1, 20, 24, 45 and 300
ANNULI = (1e-6, 0.3, 0.6, 0.8, 1.0, 2.0, 6.0, 20.0, 24.0, 45.0, 300.0, 1e3)
RADII = np.geomspace(ANNULI[0], ANNULI[-1], 91)  # cells of the picture, ten a decade
ANGLES = np.linspace(-180, 180, 121)  # [degree]
QUADRANTS = {"I": (0, 90), "II": (90, 180), "III": (-180, -90), "IV": (-90, 0)}  # [degree]
FEW, MANY = 3_000, 200_000  # points an annulus at which 30 digits and float64 are the truth
DIGITS = 30
LARGEST_EXPONENT = 700.0  # beyond it e^z overflows or E1 loses digits as a subnormal number
ROUNDOFF = {"float64": 2.0**-53, "float32": 2.0**-24}

Points = NDArray[np.complexfloating]


@dataclass(frozen=True)
class Panel:
    """One function by one implementation.

    Attributes
    ----------
    function : str            F, Im F or Ei
    implementation : str      whose, and in which precision
    error : callable          of (value, truth): relative error
    evaluate : callable       of points
    """

    function: str
    implementation: str
    error: Callable[[Points, Points], NDArray[np.float64]]
    evaluate: Callable[[Points], Points]

    @property
    def of(self) -> str:
        """Function that is evaluated: F or Ei."""
        return self.function.split()[-1]

    @property
    def precision(self) -> str:
        """float64 or float32."""
        return self.implementation.split()[-1]

    def measure(self, z: Points, truth: Points) -> NDArray[np.float64]:
        """Relative error in the shape of z; NaN where the function overflows or is not asked for."""
        asked = np.abs(truth) < np.finfo(self.precision).max
        if self.function == "Im F":
            asked &= z.real > 0
        result = np.full(z.shape, np.nan)
        result[asked] = self.error(self.evaluate(z[asked]), truth[asked])
        return result


def _complex_error(value: Points, truth: Points) -> NDArray[np.float64]:
    return np.abs(value - truth) / np.abs(truth)


def _imaginary_error(value: Points, truth: Points) -> NDArray[np.float64]:
    return np.abs(value.imag / truth.imag - 1)


def _error_of_ei(value: Points, truth: Points) -> NDArray[np.float64]:
    """Relative to |Ei|, or to 1 where that is smaller: Ei has zeros, among terms of the size of pi."""
    return np.abs(value - truth) / np.maximum(np.abs(truth), 1)


def _scipy_f(z: Points) -> Points:
    from scipy.special import exp1

    return _where_moderate(z, lambda moderate: np.exp(moderate) * exp1(moderate))


def _scipy_ei(z: Points) -> Points:
    from scipy.special import expi

    return _where_moderate(z, expi)


def _where_moderate(z: Points, function: Callable[[Points], Points]) -> Points:
    """function(z), NaN where an exponential overflows or underflows."""
    result = np.full(z.shape, complex(np.nan, np.nan))
    moderate = np.abs(z.real) < LARGEST_EXPONENT
    result[moderate] = function(z[moderate])
    return result


def _single(function: Callable[[Any], Any]) -> Callable[[Points], Points]:
    return lambda z: function(z.astype(np.complex64))


PANELS = (
    Panel("F", "scipy float64", _complex_error, _scipy_f),
    Panel("F", "airlight float64", _complex_error, scaled_e1),
    Panel("F", "airlight float32", _complex_error, _single(scaled_e1)),
    Panel("Im F", "scipy float64", _imaginary_error, _scipy_f),
    Panel("Im F", "airlight float64", _imaginary_error, scaled_e1),
    Panel("Im F", "airlight float32", _imaginary_error, _single(scaled_e1)),
    Panel("Ei", "scipy float64", _error_of_ei, _scipy_ei),
    Panel("Ei", "airlight float32", _error_of_ei, _single(ei)),
)


def write_map(folder: Path) -> list[Path]:
    """Measure the exponential integral over the plane and write a picture and a table.

    Parameters
    ----------
    folder : Path  where exponential_integral.png and exponential_integral.csv go; made if it is missing

    Returns
    -------
    list of Path  the two files

    Raises
    ------
    InputError
        If the folder cannot be made or written.
    ImportError
        If mpmath is missing.
    """
    import polars

    make_folder(folder, "choose another --out")
    picture, table = folder / "exponential_integral.png", folder / "exponential_integral.csv"
    grid, few, many = _cells(), _random(FEW), _random(MANY)
    with replacing(picture) as beside:
        _figure(grid, _exact(grid)).savefig(beside, format="png")
    truths: dict[str, dict[str, Points]] = {
        "float64": _exact(few),
        "float32": {"z": many, "F": scaled_e1(many), "Ei": ei(many)},
    }
    rows = [{**row, **_made_by()} for row in _rows(truths)]
    with replacing(table) as beside:
        polars.DataFrame(rows).write_csv(beside)
    return [picture, table]


def _made_by() -> dict[str, str]:
    versions = {name: environment()[name] for name in ("commit", "numpy")}
    others = {name: package_version(name) for name in ("scipy", "mpmath")}
    return {"date": datetime.now(UTC).date().isoformat(), **versions, **others}


def _rounded(z: Points) -> Points:
    return z.astype(np.complex64).astype(np.complex128)


def _cells() -> Points:
    """Centres of the picture's cells, (radii, angles)."""
    radii, angles = np.sqrt(RADII[1:] * RADII[:-1]), (ANGLES[1:] + ANGLES[:-1]) / 2
    return _rounded(radii[:, None] * np.exp(1j * np.radians(angles)))


def _random(count: int) -> Points:
    """Random points, `count` an annulus, half of them within a tenth of a radian of a half axis, (n,)."""
    random = np.random.default_rng(1)
    inner, outer = np.repeat(np.log(ANNULI[:-1]), count), np.repeat(np.log(ANNULI[1:]), count)
    number = inner.size
    beside = random.choice([-1, 1], number) * 10 ** random.uniform(-8, -1, number)
    near_axis = random.integers(0, 4, number) * (np.pi / 2) + beside
    angle = np.where(random.random(number) < 0.5, near_axis, random.uniform(-np.pi, np.pi, number))
    return _rounded(np.exp(random.uniform(inner, outer) + 1j * angle))


def _exact(z: Points) -> dict[str, Points]:
    """The points themselves, and F and Ei at them, in the shape of z: values of 30 digits in the upper half plane."""
    import mpmath

    upper, place = np.unique(z.real + 1j * np.abs(z.imag), return_inverse=True)
    values = np.empty((2, upper.size), np.complex128)
    with mpmath.workdps(DIGITS):
        for i, point in enumerate(upper):
            exact = mpmath.mpc(complex(point))
            values[0, i] = complex(mpmath.exp(exact) * mpmath.e1(exact))
            values[1, i] = complex(mpmath.ei(exact))
    f, e = np.where(z.imag < 0, values[:, place].conj(), values[:, place])
    return {"z": z, "F": f, "Ei": e}


def _rows(truths: dict[str, dict[str, Points]]) -> Iterator[dict[str, Any]]:
    """The worst error of each function, implementation, annulus and quadrant; `truths` by precision."""
    for panel in PANELS:
        truth = truths[panel.precision]
        z = truth["z"]
        error = panel.measure(z, truth[panel.of])
        radius, angle = np.abs(z), np.degrees(np.angle(z))
        for inner, outer in pairwise(ANNULI):
            for quadrant, (first, last) in QUADRANTS.items():
                here = (radius >= inner) & (radius < outer) & (angle >= first) & (angle < last) & ~np.isnan(error)
                if not here.any():
                    continue
                worst = np.flatnonzero(here)[np.argmax(error[here])]
                yield {
                    "function": panel.function,
                    "implementation": panel.implementation,
                    "modulus_from": inner,
                    "modulus_to": outer,
                    "quadrant": quadrant,
                    "points": int(here.sum()),
                    "worst_relative_error": float(error[worst]),
                    "at_real": float(z[worst].real),
                    "at_imaginary": float(z[worst].imag),
                }


def _figure(grid: Points, exact: dict[str, Points]) -> Any:
    """Error maps of all panels on one scale: multiples of the precision's own roundoff."""
    from matplotlib.colors import LogNorm
    from matplotlib.figure import Figure

    functions = {"F": "F = e$^z$ E$_1$", "Im F": "Im F alone, Re z > 0", "Ei": "Ei, relative to max(|Ei|, 1)"}
    columns = {"scipy float64": 0, "airlight float64": 1, "airlight float32": 2}
    figure = Figure(figsize=(12, 11), dpi=100, layout="constrained")
    axes = figure.subplots(len(functions), len(columns), sharex=True, sharey=True)
    smallest, largest = 0.1, 1e4
    for panel in PANELS:
        axis = axes[list(functions).index(panel.function), columns[panel.implementation]]
        error = panel.measure(grid, exact[panel.of])
        multiple = np.maximum(error / ROUNDOFF[panel.precision], smallest)
        mesh = axis.pcolormesh(ANGLES, RADII, multiple, norm=LogNorm(smallest, largest), cmap="viridis")
        axis.set_facecolor("lightgrey")
        worst = f"worst of the cells' centres {np.nanmax(error):.1e}"
        axis.set_title(f"{functions[panel.function]}: {panel.implementation}\n{worst}", fontsize=10)
        axis.set_yscale("log")
        axis.set_xticks(range(-180, 181, 90))
    for axis in axes[-1]:
        axis.set_xlabel("arg z [degree]")
    for axis in axes[:, 0]:
        axis.set_ylabel("|z|")
    made = "\n".join(f"{name} {value}" for name, value in _made_by().items())
    shown = f"airlight's Ei in float64 is scipy's here\ngrey: not asked for, or overflow\nagainst {DIGITS} digits"
    axes[-1, 1].set_axis_off()
    axes[-1, 1].text(
        0.5, 0.5, f"{shown}\n\n{made}", ha="center", va="center", fontsize=9, transform=axes[-1, 1].transAxes
    )
    label = "relative error [unit roundoff: 1.1e-16 in float64, 6.0e-8 in float32]"
    figure.colorbar(mesh, ax=axes, label=label, extend="both", shrink=0.6)
    return figure
