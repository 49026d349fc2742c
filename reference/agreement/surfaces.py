"""Whether `volpath`'s convention changes the shipped surfaces by what it is, and by nothing else.

`volpath` is compared with surfaces under its own convention, and the deterministic mode has none of its own. What is
shipped is therefore held against those: light attenuated over the share 1 - ShadowEpsilon of its way d is brighter by
e^(sigma_t d ShadowEpsilon), of the nearest light and of the furthest the bounds of any mixture. In fog that a body
holds, light crosses less of d, and a shadow ray that begins beside the surface leaves the body at another place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.agreement.comparison import ROUNDING
from reference.estimators import Equiangular
from reference.integrator import delta_emitters, eye_path, mi
from reference.moments import Image
from scenes.model import Scene

# isort: split
import drjit as dr  # after the integrator, which chose Dr.Jit's LLVM

# of the pixels whose surface is lit, those that a hair of its own may shade for one of the two, or one pixel; measured
# at 16 x 16 and 64 x 64: 1.4 % on `wire_mesh`, the most of the shipped scenes, and 3.2 % in a room whose walls touch
MOST_FLIPS = 0.05
# lengths of the gap that Mitsuba leaves above a surface; measured in a box seen at a slant: 1.3
SLANT = 2.0
# of a length, which thick fog makes much of; measured in fog of 50 optical depths: 1.5e-7
FLOAT32 = 2.4e-7


@dataclass(frozen=True)
class Surfaces:
    """Surfaces under the two conventions.

    Attributes
    ----------
    lit : int       pixels whose surface is lit under either
    flips : int     of them, those of which a light reaches the surface under one convention alone
    excess : float  how far the ratio of the others is beyond what the convention explains, at most; 0 at best
    """

    lit: int
    flips: int
    excess: float

    @property
    def agrees(self) -> bool:
        """Whether the convention explains the difference."""
        return self.excess <= ROUNDING and self.flips <= max(1, MOST_FLIPS * self.lit)

    def __str__(self) -> str:
        """One sentence."""
        verdict = "agree" if self.agrees else "DO NOT AGREE"
        return (
            f"surfaces: shipped and under volpath's convention {verdict}: of {self.lit} lit pixels {self.flips} "
            f"flip{'s' * (self.flips == 1)}, and the others differ by what the convention is and {self.excess:.1e}"
        )


def compare_surfaces(scene: Scene, shipped: Image, as_volpath: Image) -> Surfaces:
    """Hold surfaces, (H, W, 3) each, against the convention that sets them apart."""
    lowest, highest = _bounds(scene)
    lit = (shipped > 0) | (as_volpath > 0)
    both = (shipped > 0) & (as_volpath > 0)
    ratio = np.divide(as_volpath, shipped, out=np.ones_like(shipped), where=both)
    beyond = np.maximum(np.maximum(lowest / ratio, ratio / highest) - 1, 0) * both
    flipped = (lit & ~both).any(axis=-1)
    if len(scene.lights) > 1:
        # the other lights are still there
        flipped |= (beyond > ROUNDING).any(axis=-1)
    return Surfaces(
        lit=int(lit.any(axis=-1).sum()),
        flips=int(flipped.sum()),
        excess=float(beyond[~flipped].max(initial=0.0)),
    )


def _bounds(scene: Scene) -> tuple[Image, Image]:
    """Least and most by which the convention multiplies each pixel's surface."""
    estimator = Equiangular(scene)
    ray = estimator.rays(dr.arange(mi.UInt32, estimator.samples.size))
    path = eye_path(estimator.mitsuba.scene, ray, estimator.mitsuba.medium)
    it = dr.zeros(mi.Interaction3f, dr.width(ray))
    it.p = ray(dr.select(path.blocked, path.t_end, 0))
    ways = [light.sample_direction(it, mi.Point2f(0.5))[0].dist for light in delta_emitters(estimator.mitsuba.scene)]
    distances = np.array([np.broadcast_to(np.array(way, np.float64), dr.width(ray)) for way in ways])
    rounded = FLOAT32 * (np.array(path.t_end, np.float64) + distances.max(axis=0)) * np.array(path.blocked)
    short = (
        mi.math.ShadowEpsilon * distances.min(axis=0) - rounded,
        mi.math.ShadowEpsilon * distances.max(axis=0) + rounded,
    )
    if scene.boundary:
        gap = SLANT * mi.math.RayEpsilon * (1 + np.abs(np.array(it.p, np.float64)).max(axis=0))
        short = -gap - rounded, short[1] + gap
    sigma_t = np.broadcast_to(scene.medium.sigma_t, 3)
    lowest, highest = (np.exp(np.multiply.outer(length, sigma_t)).reshape(*estimator.shape, 3) for length in short)
    return lowest, highest
