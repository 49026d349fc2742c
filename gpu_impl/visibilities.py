"""The registry of visibility strategies. A new one is a file under `shaders/visibility` and a line here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Visibility:
    """Which pieces of a ray are lit.

    Attributes
    ----------
    source : str             file below `shaders/`
    what : str               in a few words
    polygons : str or None   which shadow polygons it asks for (passes/shadow_volume.py): "repaired", those that can
                             matter, or "printed", all of them; None for none
    """

    source: str
    what: str
    polygons: Literal["repaired", "printed"] | None = None


VISIBILITIES = {
    "uniform_march": Visibility("visibility/uniform_march.glsl", "equal steps over the ray"),
    "lit_intervals": Visibility(
        "visibility/lit_intervals.glsl",
        "samples between the first and the last shadow polygon, merged to lit intervals (Algorithms 4.1 and 4.2 "
        "repaired)",
        "repaired",
    ),
    "lit_intervals:printed": Visibility(
        "visibility/lit_intervals_printed.glsl", "Algorithms 4.1 and 4.2 as printed", "printed"
    ),
    "lit_intervals:unbounded": Visibility(
        "visibility/lit_intervals_unbounded.glsl",
        "samples over all of the ray that the light reaches, merged to lit intervals (Algorithm 4.1 repaired)",
    ),
    "front_final": Visibility(
        "visibility/front_final.glsl", "dark between the first and the last shadow polygon (Figure 1.1)", "repaired"
    ),
}
