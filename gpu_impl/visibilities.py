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
    blue_noise : bool        whether it reads the tile of blue noise (blue_noise.py)
    """

    source: str
    what: str
    polygons: Literal["repaired", "printed"] | None = None
    blue_noise: bool = False


VISIBILITIES = {
    "uniform_march": Visibility("visibility/uniform_march.glsl", "equal steps over the ray"),
    "uniform_march:jittered": Visibility(
        "visibility/uniform_march_jittered.glsl",
        "equal steps, each ray's samples shifted by interleaved gradient noise (Jimenez 2014)",
    ),
    "uniform_march:blue_noise": Visibility(
        "visibility/uniform_march_blue_noise.glsl",
        "equal steps, each ray's samples shifted by a tile of blue noise (Ulichney 1993)",
        blue_noise=True,
    ),
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
