"""How far the airlight is from the reference's where both look at the same surface.

OpenGL and Mitsuba round rays otherwise, and a pixel at a silhouette may see what is in front in one and what is behind
in the other. No technique has any part in that, and a few such pixels hold most of a good one's squared error.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from experiments.measurements import Measurement, Value
from experiments.measurements.regions import measure_regions
from experiments.measurements.shot import Shot
from reference.first_surfaces import first_surfaces

# of the reference's depth
ALIKE = 0.01


def same_surface(shot: Shot) -> dict[str, Value]:
    """Errors over the pixels whose depth is the reference's within 1 %.

    Returns
    -------
    dict
        `same_surface.bias`, `same_surface.rel_50`, `same_surface.rel_95`: as in `experiments.metrics`, over those
        pixels with airlight, in the picture or in the reference; `same_surface.share` of all such pixels they are;
        `same_surface.pixels`, `same_surface.others`: how many there are, lit or not, and how many are not.

    Raises
    ------
    InputError
        Mitsuba has no variant that casts rays in packets.
    """
    alike = is_same_surface(shot.frame.depth, first_surfaces(shot.scene).depth)
    truth, noise = shot.reference.scattering, shot.reference.noise("scattering")
    known = np.zeros_like(truth) if noise is None else noise
    return {
        **measure_regions(shot.frame.scattering, truth, known, {"same_surface": alike}),
        "same_surface.pixels": int(alike.sum()),
        "same_surface.others": int((~alike).sum()),
    }


def is_same_surface(depth: NDArray[np.floating], truth: NDArray[np.floating]) -> NDArray[np.bool_]:
    """Where depths along the ray agree to `ALIKE` of the true ones, all (H, W)."""
    truth = np.asarray(truth, np.float64)
    found: NDArray[np.bool_] = np.abs(depth - truth) <= ALIKE * truth
    return found


MEASUREMENT = Measurement(same_surface)
