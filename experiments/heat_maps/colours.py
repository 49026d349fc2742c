"""The colours of errors, and of what is no error that can be told.

`vik` and `lajolla` are perceptually even and keep their order for colour-blind people (Crameri 2018, Geodynamic
diagnostics, scientific visualisation and StagLab 3.0). tests/experiments/test_heat_maps.py measures both. In both, no
error is light.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.colors import Colormap

MapName = Literal["vik", "lajolla", "hue"]

ENTRIES = 256
# within the reference's noise: between white and the maps' dark ends, and neither even map has a neutral grey
NOISE_COLOUR = "#a0a0a0"
# beyond the scale: far from every colour of the map, in simulated colour blindness too
BEYOND: dict[MapName, dict[str, str]] = {
    "vik": {"under": "#000000", "over": "#ffe000"},
    "lajolla": {"over": "#00e5ff"},
    # the hue map has each pure hue between blue and red
    "hue": {"over": "#ffffff"},
}


@cache
def colour_map(name: MapName) -> Colormap:
    """Map of `ENTRIES` colours, with those for values beyond it and, as the "bad" colour, for noise.

    Parameters
    ----------
    name : "vik" for signed errors, "lajolla" for absolute ones, or "hue", the thesis's map of absolute errors from blue
        to red (Weng 2010, Figure 2.3)
    """
    from cmcrameri import cm
    from matplotlib.colors import ListedColormap, hsv_to_rgb

    if name == "hue":
        hue = np.linspace(2 / 3, 0, ENTRIES)
        full = np.ones(ENTRIES)
        found: Colormap = ListedColormap(hsv_to_rgb(np.stack([hue, full, full], axis=-1)), "hue")
    else:
        found = cm.vik if name == "vik" else cm.lajolla_r
    return found.with_extremes(bad=NOISE_COLOUR, **BEYOND[name])


def table(colour_map: Colormap) -> NDArray[np.uint8]:
    """The map's colours, then those below, above and of noise: (ENTRIES + 3, 3), for viewers of our own."""
    inside = colour_map(np.arange(ENTRIES))
    extremes = [colour_map.get_under(), colour_map.get_over(), colour_map.get_bad()]
    return np.rint(255 * np.concatenate([inside, extremes])[:, :3]).astype(np.uint8)
