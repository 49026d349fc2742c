"""Two pictures of the same surfaces: they have no noise, and differ by rounding alone.

DESIGN: another CPU or compiler rounds a ray otherwise, and a pixel whose ray grazes a silhouette then sees what is
behind it: with the eye moved by one float32 spacing (1.2e-7 of its distance from the origin), one pixel of `sphere`
changes by 2.1e-3 of the brightest. A limit on the largest difference would be one on luck. So almost all pixels have to
be alike, and the image means.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.moments import Image

# of the brightest value; measured with the eye moved by eight spacings along each axis, at 64 x 64: away from
# silhouettes at most 9.2e-5
ALIKE = 1e-4
# share of pixels that may be less alike than that; measured on the same: 1 of 4,096 on `sphere`, 0 on the others
STRAYS = 1e-3
# relative difference of a channel's image mean; measured on the same: 1.8e-5
MEAN = 5e-5


@dataclass(frozen=True)
class Surfaces:
    """How far two pictures of surfaces are apart.

    Attributes
    ----------
    strays : float    share of pixels that differ by more than ALIKE of the brightest value
    mean : float      largest relative difference of a channel's image mean
    """

    strays: float
    mean: float

    @property
    def agree(self) -> bool:
        """Whether rounding explains it."""
        return self.strays <= STRAYS and self.mean <= MEAN

    def __str__(self) -> str:
        """What differs, and by how much."""
        return (
            f"surfaces differ on {self.strays:.2%} of the pixels (at most {STRAYS:.2%}) and by {self.mean:.1e} of the "
            f"image mean (at most {MEAN:.0e})"
        )


def compare_surfaces(committed: Image, again: Image) -> Surfaces:
    """Compare two pictures, (H, W, 3); where a channel of the second is black, the first has to be."""
    differ = np.abs(committed - again).max(axis=-1) > ALIKE * again.max()
    means, now = (image.mean(axis=(0, 1)) for image in (committed, again))
    difference = np.abs(means - now)
    relative = np.divide(difference, now, out=np.where(difference > 0, np.inf, 0.0), where=now > 0)
    return Surfaces(float(differ.mean()), float(relative.max()))
