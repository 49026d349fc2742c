"""What can be measured of a case. A new measurement is one file here, with a `MEASUREMENT`, and a line below."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from experiments.measurements.shot import Shot

Value = float | int | str | None

# by the names that suites call them; imported when they are asked for
MEASUREMENTS = {
    name: f"experiments.measurements.{name}"
    for name in ("errors", "same_surface", "regions", "banding", "flicker", "timing", "counts")
}


@dataclass(frozen=True)
class Measurement:
    """One kind of numbers.

    Attributes
    ----------
    measure : callable     Shot to columns, "banding.across" for instance, each named after what it is of
    needs_quiet : bool     nothing else may run on the machine meanwhile
    """

    measure: Callable[[Shot], Mapping[str, Value]]
    needs_quiet: bool = False


def find_measurement(name: str) -> Measurement:
    """Import the measurement of this name."""
    found: Measurement = import_module(MEASUREMENTS[name]).MEASUREMENT
    return found
