"""Below which brightness a relative error is not taken at its word; the same for the reference and for techniques."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

DARKEST = 0.01


def darkest(reference: NDArray[np.floating]) -> float:
    """Radiance below which a pixel counts as if it were as bright as this: 1 % of the median of the lit values.

    In an umbra the relative error of next to nothing would otherwise decide. The median, because a single pixel that
    looks into a light may own the mean. 0 for a black picture.
    """
    lit = reference[reference > 0]
    return DARKEST * float(np.median(lit)) if lit.size else 0.0
