"""The result of one check, its verdict drawn from the residuals."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from mpmath import mp, mpf

__all__ = [
    "CLOSED_FORM_DIGITS",
    "INTEGRAL_DIGITS",
    "LARGEST_RIGHT",
    "Entry",
    "conclude",
    "largest",
    "relative",
    "shown",
]

# the truth has 30 digits; an equation that is off by more than this is wrong
LARGEST_RIGHT = 1e-20
INTEGRAL_DIGITS = 45
# Eq. 20's terms are up to 1e36 times their difference, those of Eq. 24 with 32 terms 1e63 times
CLOSED_FORM_DIGITS = 120


@dataclass(frozen=True)
class Entry:
    """What was found of one equation.

    Attributes
    ----------
    equation : str           "1" ... "32", "Fig. 4.11", "Alg. 4.1", "Alg. 4.2"
    verdict : str            "right", or "wrong: " and what the slip is
    finding : str            what was compared, and the numbers
    residual_printed : float or None   largest relative error as printed; of several readings, the best one's;
        at most the largest float
    residual_repaired : float or None  of the repair; where nothing had to be repaired, the same
    """

    equation: str
    verdict: str
    finding: str
    residual_printed: float | None
    residual_repaired: float | None


def conclude(equation: str, printed: Any, finding: str, repaired: Any = None, slip: str = "") -> Entry:
    """An entry whose verdict follows from the residual of the print.

    Parameters
    ----------
    equation : str  its number
    printed : mpf   residual as printed
    finding : str
    repaired : mpf, optional  residual of the repair; left out where there is none
    slip : str      what is wrong with the print, said only if the residual shows it
    """
    residual = _as_float(printed)
    verdict = "right" if residual <= LARGEST_RIGHT else f"wrong: {slip}"
    return Entry(equation, verdict, finding, residual, residual if repaired is None else _as_float(repaired))


def _as_float(residual: Any) -> float:
    """The largest float for what is beyond: JSON knows no infinity."""
    return float(min(residual, sys.float_info.max))


def relative(value: Any, truth: Any) -> Any:
    """|value - truth| / |truth|."""
    return abs((mpf(value) - truth) / truth)


def largest(errors: Iterable[Any]) -> Any:
    """The largest of some errors; NaN if one is."""
    found = list(errors)
    return mp.nan if any(mp.isnan(error) for error in found) else max(found)


def shown(number: Any) -> str:
    """Two digits, as they are read: 0.67, 4.4, 2e-30."""
    return f"{float(number):.2g}" if abs(number) < sys.float_info.max else str(mp.nstr(number, 2))
