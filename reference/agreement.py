"""Whether two estimates of one image agree, and how small a difference the comparison would have noticed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from reference.convergence import Estimate, Progress, converge
from reference.estimators import Equiangular, Volpath
from reference.goal import Goal
from reference.integrator import mi
from scenes.model import Scene

LARGEST_Z = 4.0


@dataclass(frozen=True)
class MeanTest:
    """The image means of two independent estimates of the composite, all channels together.

    Attributes
    ----------
    difference : float       relative to the first
    standard_error : float   of that difference, relative to the first
    """

    difference: float
    standard_error: float

    @property
    def z(self) -> float:
        """Difference in standard errors."""
        return self.difference / self.standard_error

    @property
    def agrees(self) -> bool:
        """Whether |z| < 4."""
        return abs(self.z) < LARGEST_Z


def image_mean_test(ours: Estimate, theirs: Estimate) -> MeanTest:
    """Compare the means of the composite, `theirs` relative to `ours`."""
    our_mean, our_error = _composite_mean(ours)
    their_mean, their_error = _composite_mean(theirs)
    return MeanTest((their_mean - our_mean) / our_mean, float(np.hypot(our_error, their_error)) / our_mean)


def _composite_mean(estimate: Estimate) -> tuple[float, float]:
    mean = sum(float(np.mean(value)) for value in estimate.image_mean.values())
    # channels of a pass share their paths, so their errors add up rather than average out; layers do not
    error = np.sqrt(sum(float(np.mean(value)) ** 2 for value in estimate.image_error.values()))
    return mean, float(error)


@dataclass(frozen=True)
class VolpathCheck:
    """The main estimator against Mitsuba's `volpath`.

    Attributes
    ----------
    test : MeanTest    with the main estimator under `volpath`'s convention
    shift : float      by how much that convention brightens the image mean, relative
    """

    test: MeanTest
    shift: float


def check_against_volpath(scene: Scene, goal: Goal, report: Callable[[Progress], None] | None = None) -> VolpathCheck:
    """Compare image means with `volpath`, which is never cached: the check is made each time.

    `volpath` walks to a light in steps and stops ShadowEpsilon (8.9e-4) of the way short of it, the last piece left
    without extinction. That makes it too bright by the factor e^(sigma_t d ShadowEpsilon), d the distance to the light:
    +0.03 % on `empty`, where the closed form says that we are right and it is not. So the test compares it with our
    estimator stopped as short, and says what that changes.

    Parameters
    ----------
    goal : for `volpath`; its pixels are noisy, its image mean is not
    report : called after each pass of `volpath`
    """
    ours = converge(Equiangular(scene), Goal())
    # the same seeds: the two differ by the convention alone, not by noise
    short = converge(Equiangular(scene, light_share=1 - mi.math.ShadowEpsilon), Goal())
    test = image_mean_test(short, converge(Volpath(scene), goal, report))
    return VolpathCheck(test, _composite_mean(short)[0] / _composite_mean(ours)[0] - 1)
