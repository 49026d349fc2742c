"""The registry of visibility strategies. A new one is a file under `shaders/visibility` and a line here."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Visibility:
    """Which pieces of a ray are lit."""

    source: str
    what: str


VISIBILITIES = {
    "uniform_march": Visibility("visibility/uniform_march.glsl", "equal steps over the ray"),
    "lit_intervals": Visibility("visibility/lit_intervals.glsl", "samples merged to lit intervals (Algorithm 4.1)"),
}
