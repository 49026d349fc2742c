"""Airlight from a table of one special function, as graphics hardware of 2005 could: isotropic scattering.

With H = sigma_t h and theta the scattering angle (tan(theta / 2) = v of Weng 2010, section 4.3)

    L = I sigma_s / (2 pi h) e^{sigma_t x_a} (F(H, theta_b / 2) - F(H, theta_a / 2)),
    F(u, v) = int_0^v e^{-u tan(xi)} d xi,

exact but for the table. The paper tabulates F for 0 <= u <= 10, 0 <= v <= pi/2 at equal steps and reads it with
bilinear interpolation. Near the corner u = 0, v = pi/2 F bends within a width u, so at equal steps the error falls only
in proportion to the step (`axis="linear"`); `axis="root"`, not the paper's, spaces u in the square of the row and so
serves a longer range with fewer rows.

The paper gives the range of the table; its size here, 64 x 64, is this project's reading of "small", and variants named
after their sides, `sun2005:128`, show what the size does. Only isotropic scattering is served.

====================  =========  ==============  ==========================  =========================
table                 u up to    error of F      off by more than 1 %, f64   the same in float32
====================  =========  ==============  ==========================  =========================
32 x 32, linear       10         1.04e-1         53 % (57 %)                 57 %
64 x 64, linear       10         5.45e-2         38 % (33 %)                 43 %
128 x 128, linear     10         2.79e-2         27 % (17 %)                 33 %
512 x 512, linear     10         7.13e-3         16 % (1.5 %)                23 %
128 x 32, root        50         6.70e-3         30 % (14 %)                 34 %
256 x 128, root       50         1.91e-3         18 % (2.0 %)                24 %
512 x 512, root       50         5.40e-4         12 % (under 0.1 %)          20 %
====================  =========  ==============  ==========================  =========================

The share is of visible segments (optical depth to the near end at most 12) drawn over H 1e-4 .. 50, optical positions
-50 .. 50 and lengths from 1e-7 to infinite; in brackets of those that contain the light's projection. What the larger
tables leave is the subtraction: a table is an antiderivative, and short segments, and those far behind the light, where
F is all but level, lose the digits that both ends share. Where the light is more than 88 behind the eye in optical
depth (709 in float64), the result is 0.

A table is made at its first use: the published one in 0.02 s, the search for 1e-2 takes 0.7 s and for 512 x 512 3.4 s.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from analytic.exponential_integral import scaled_e1
from analytic.inputs import real_number
from analytic.models.model import AirlightModel
from analytic.phase import Phase
from analytic.segments import Segments

__all__ = [
    "MODELS",
    "PUBLISHED_SIDE",
    "SIDES",
    "Table",
    "f",
    "published_table",
    "read",
    "smallest_table",
    "sun2005",
    "sun2005_sized",
]

PUBLISHED_LARGEST_U = 10.0
PUBLISHED_SIDE = 64
# of the variants, and which share of the visible segments each leaves off by more than 1 %
SIDES = {32: "53 %", 128: "27 %", 512: "16 %"}
SMALLEST_SIDE, LARGEST_SIDE = 8, 512
DOMAIN_LARGEST_U = 50.0
AXES = ("linear", "root")
CELL_SAMPLES = 8  # a side, where `table_error` looks for the worst place


@dataclass(frozen=True, eq=False)
class Table:
    """Samples of F, the first at u = 0 and v = 0, the last at `largest_u` and pi/2.

    Attributes
    ----------
    values : ndarray, (rows, columns)  F, u by rows and v by columns
    largest_u : float                  beyond it the last row is read, as a clamped texture is
    axis : str                         "linear": rows at equal steps of u, as published; "root": of sqrt(u)
    """

    values: NDArray[np.floating]
    largest_u: float
    axis: str


def f(u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
    """F(u, v) = int_0^v e^{-u tan(xi)} d xi, broadcasting, to some 1e-15.

    By t = tan(xi) it is an exponential integral: G(u, 0) - e^{-u t} G(u, t), G(u, t) = -Im(e^z E1(z)), z = u (t + i).

    Source: Sun et al. 2005, Eq. 10; Weng 2010, Eq. 20, for the closed form.
    """
    u, v = np.broadcast_arrays(np.asarray(u, dtype=np.float64), np.asarray(v, dtype=np.float64))
    clear = u == 0
    some = np.where(clear, 1.0, u)
    t = np.tan(np.minimum(v, np.pi / 2))
    integral = np.exp(-some * t) * scaled_e1(some * (t + 1j)).imag - scaled_e1(some * 1j).imag
    return np.where(clear, v, integral)


@lru_cache(maxsize=8)
def make_table(rows: int, columns: int, largest_u: float, axis: str) -> Table:
    """The table in float64, made once per process."""
    row = np.linspace(0, 1, rows)
    u = largest_u * (row if axis == "linear" else row * row)
    return Table(f(u[:, None], np.linspace(0, np.pi / 2, columns)), largest_u, axis)


def published_table(side: int = PUBLISHED_SIDE) -> Table:
    """The table of the paper's range and axes, `side` x `side` samples."""
    return make_table(side, side, PUBLISHED_LARGEST_U, "linear")


def read(table: Table, u: NDArray[np.floating], v: NDArray[np.floating]) -> NDArray[np.floating]:
    """One table read: F interpolated bilinearly in the table's type, (n,), as a texture with clamped coordinates is."""
    rows, columns = table.values.shape
    share = np.clip(u / table.largest_u, 0, 1)
    row = (np.sqrt(share) if table.axis == "root" else share) * (rows - 1)
    column = np.clip(v / (np.pi / 2), 0, 1) * (columns - 1)
    i, j = (np.minimum(place.astype(int), last) for place, last in ((row, rows - 2), (column, columns - 2)))
    down, right = row - i.astype(row.dtype), column - j.astype(column.dtype)
    upper = table.values[i, j] * (1 - right) + table.values[i, j + 1] * right
    lower = table.values[i + 1, j] * (1 - right) + table.values[i + 1, j + 1] * right
    return upper * (1 - down) + lower * down


def table_error(table: Table) -> float:
    """Largest absolute error of `read` over the table's range.

    F_uu falls with u and grows with v, and F_vv is largest along u tan(v) = 1, the more so the closer v is to pi/2. So
    the worst place lies in the cells next to u = 0 or in those next to pi/2: both strips are sampled, and then the
    surroundings of the worst sample.
    """
    rows, columns = table.values.shape
    inside, fine = np.arange(CELL_SAMPLES + 1) / CELL_SAMPLES, np.linspace(-1, 1, 33) / CELL_SAMPLES
    all_rows, all_columns = (np.arange((n - 1) * CELL_SAMPLES + 1) / CELL_SAMPLES for n in (rows, columns))
    worst, row, column = max(_worst(table, inside, all_columns), _worst(table, all_rows, columns - 2 + inside))
    around = np.clip(row + fine, 0, rows - 1), np.clip(column + fine, 0, columns - 1)
    return max(worst, _worst(table, *around)[0])


def _worst(table: Table, rows: NDArray[np.float64], columns: NDArray[np.float64]) -> tuple[float, float, float]:
    """The largest absolute error on a grid of places counted in rows and columns, and its row and column."""
    row, column = (grid.ravel() for grid in np.meshgrid(rows, columns, indexing="ij"))
    last_row, last_column = (size - 1 for size in table.values.shape)
    share = row / last_row
    u, v = table.largest_u * (share * share if table.axis == "root" else share), np.pi / 2 * column / last_column
    errors = np.abs(read(table, u, v) - f(u, v))
    worst = np.argmax(errors)
    return float(errors[worst]), float(row[worst]), float(column[worst])


@lru_cache(maxsize=8)
def smallest_table(error: float, largest_u: float = PUBLISHED_LARGEST_U, axis: str = "linear") -> Table:
    """The smallest table, its sides powers of two, that gives F with an absolute error of at most `error`.

    Parameters
    ----------
    error : float      wanted, above 0
    largest_u : float  the table serves 0 <= u <= largest_u
    axis : str         see `Table`

    Raises
    ------
    ValueError
        If 512 x 512 samples are not enough, or a parameter is out of its range.
    """
    if not real_number("error", error) > 0:
        raise ValueError(f"error must be above 0: {error}")
    if not 0 < real_number("largest_u", largest_u) < np.inf:
        raise ValueError(f"largest_u must be above 0 and finite: {largest_u}")
    if axis not in AXES:
        raise ValueError(f"axis must be one of {', '.join(AXES)}: {axis!r}")
    # along the border between tables that are good enough and those that are not: fewer rows, then more columns
    rows, columns, best = LARGEST_SIDE, SMALLEST_SIDE, None
    while rows >= SMALLEST_SIDE and columns <= LARGEST_SIDE:
        table = make_table(rows, columns, largest_u, axis)
        if table_error(table) > error:
            columns *= 2
            continue
        if best is None or table.values.size < best.values.size:
            best = table
        rows //= 2
    if best is None:
        raise ValueError(f"error must be within reach of {LARGEST_SIDE} x {LARGEST_SIDE} samples: {error}")
    return best


def sun2005(segments: Segments, phase: Phase, side: int = PUBLISHED_SIDE) -> NDArray[np.floating]:
    """Airlight of unit intensity and unit scattering coefficient, with the table of the paper's range.

    Parameters
    ----------
    segments : Segments, (n,)  their type is the table's and the reads' too
    phase : Phase              isotropic
    side : int                 samples on a side of the table

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Source: Sun, Ramamoorthi, Narasimhan and Nayar 2005, their airlight and its F(u, v).
    """
    return _airlight(segments, published_table(side))


def sun2005_sized(segments: Segments, phase: Phase, *, error: float = 1e-2) -> NDArray[np.floating]:
    """The same with the smallest table that gives F to `error` for u up to 50, on the axis that is not the paper's.

    Parameters
    ----------
    segments : Segments, (n,)
    phase : Phase              isotropic
    error : float              of F, absolute

    Returns
    -------
    ndarray, (n,)  L / (I sigma_s) [1 / (sr scene unit)]

    Raises
    ------
    ValueError
        As `smallest_table`.
    """
    return _airlight(segments, smallest_table(error, DOMAIN_LARGEST_U, "root"))


def _airlight(segments: Segments, table: Table) -> NDArray[np.floating]:
    s, dtype = segments, segments.h.dtype
    samples = Table(table.values.astype(dtype), table.largest_u, table.axis)
    # theta, the angle between the ray's direction and the one from the light
    near, far = (np.arctan2(s.h, -x) / 2 for x in (s.x_a, s.x_b))
    difference = read(samples, s.optical_h, far) - read(samples, s.optical_h, near)
    # beyond the largest exponential the airlight is below the smallest one, and the table holds nothing of it
    depth, largest = s.sigma_t * s.x_a, dtype.type(0.99) * np.log(np.finfo(dtype).max)
    prefactor = np.where(depth > largest, 0, np.exp(np.minimum(depth, largest)))
    return prefactor * difference / (2 * np.pi * s.h)


CITATION = "Sun, Ramamoorthi, Narasimhan and Nayar 2005"
COST = "2 table reads (bilinear), 2 arc tangents, 1 exponential"
MODELS = (
    AirlightModel(
        name="sun2005",
        function=sun2005,
        citation=CITATION,
        domain="isotropic, H up to 10; off by more than 1 % on 38 % of the visible segments, the short ones above all",
        cost=COST,
        phases=("isotropic",),
    ),
    *(
        AirlightModel(
            name=f"sun2005:{side}",
            function=partial(sun2005, side=side),
            citation=f"{CITATION}; {side} x {side} samples",
            domain=f"isotropic, H up to 10; off by more than 1 % on {share} of the visible segments",
            cost=COST,
            phases=("isotropic",),
        )
        for side, share in SIDES.items()
    ),
    AirlightModel(
        name="sun2005:sized",
        function=sun2005_sized,
        citation=f"{CITATION}; the axis is this project's",
        domain="isotropic, H up to 50; off by more than 1 % on 30 % of the visible segments; 0.7 s at first use",
        cost=f"{COST}, 1 square root a read",
        phases=("isotropic",),
    ),
)
