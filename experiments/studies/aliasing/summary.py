"""What the study comes to: each technique's numbers over those of the regular march."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from experiments.studies.aliasing.bands import at_steps
from experiments.studies.aliasing.convergence import ladders, order
from experiments.studies.aliasing.naming import naming
from experiments.studies.cells import Gaps, Row

REGULAR = "uniform_march", "riemann"
INTRODUCTION = """## In short

Over the regular march (`Nishita1987`) with as many samples, the geometric mean over the scenes and phase functions that
both draw: the error's 95th percentile and its median, its bands and its grain at {steps} samples (below), and flicker
(95th percentile). Behind it the median of the orders of convergence of the 95th percentile over scenes and phase
functions, and from the least to the most of them: how far they differ, not an interval of the median; and of how many
ladders of steps they are, for the error of others falls over too few.

{table}"""
RATIOS: dict[str, tuple[str, Callable[[Row], float | None]]] = {
    "95 %": ("still", lambda row: row.get("scattering.rel_95")),
    "median": ("still", lambda row: row.get("scattering.rel_50")),
    "bands": (
        "still",
        lambda row: row.get("banding.rms") and float(np.hypot(row["banding.along"], row["banding.across"])),
    ),
    "grain": (
        "still",
        lambda row: row.get("banding.rms") and row["banding.rms"] * (1 - row["banding.coarse_share"]) ** 0.5,
    ),
    "flicker": ("path", lambda row: row.get("flicker.high")),
}


def summary_text(still: Sequence[Row], steps: Sequence[Row], path: Sequence[Row]) -> str:
    """A line a technique; empty where the regular march is not among them.

    Parameters
    ----------
    still : rows of all techniques, with fog on every pixel
    steps : rows over numbers of steps
    path : rows of the camera's path
    """
    shown, orders = at_steps(still), _orders(steps)
    products = {"still": _named(shown), "path": _named(path)}
    if not any(_is_regular(row) for row in shown):
        return ""
    gaps, lines = Gaps(), []
    for name in products["still"]:
        cells = [_ratio(products[product], name, value, gaps) for product, value in RATIOS.values()]
        found = orders.get(name, [])
        fitted = [one for one in found if one is not None]
        spread = (
            f"{np.median(fitted):.2f}; {min(fitted):.2f} to {max(fitted):.2f} ({len(fitted)} of {len(found)})"
            if fitted
            else gaps.because("no order of convergence was found")
        )
        lines.append([name, *cells, spread])
    return INTRODUCTION.format(steps=shown[0]["steps"], table=gaps.table(["technique", *RATIOS, "order"], lines))


def _is_regular(row: Row) -> bool:
    return (row["visibility"], row["airlight_model"]) == REGULAR


def _named(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """The rows of each technique."""
    found: dict[str, list[Row]] = {}
    if rows:
        name_of = naming(rows)
        for row in rows:
            found.setdefault(name_of(row), []).append(row)
    return found


def _ratio(rows: Mapping[str, Sequence[Row]], name: str, value: Callable[[Row], float | None], gaps: Gaps) -> str:
    """Geometric mean of a technique's values over the regular march's, picture by picture."""
    regular = {_picture(row): value(row) for mine in rows.values() for row in mine if _is_regular(row)}
    pairs = [(value(row), regular.get(_picture(row))) for row in rows.get(name, ())]
    logarithms = [np.log(mine / of) for mine, of in pairs if mine and of]
    if not logarithms:
        return gaps.because("no picture of which both have a number above zero with as many samples")
    return f"{np.exp(np.mean(logarithms)):.3g}"


def _picture(row: Row) -> tuple[str, str, int]:
    return row["scene"], row["phase"], row["steps"]


def _orders(rows: Sequence[Row]) -> dict[str, list[float | None]]:
    """The orders of the 95th percentile of each technique's measured ladders; None where none could be fitted."""
    found: dict[str, list[float | None]] = {}
    for (_, _, name), mine in ladders(rows).items():
        measured = [row for row in mine if row.get("scattering.rel_95") is not None]
        if measured:
            fit = order(measured, "scattering.rel_95").fit
            found.setdefault(name, []).append(-fit.exponent if fit else None)
    return found
