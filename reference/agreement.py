"""Whether two estimates of one image agree, and how small a difference the comparison would have noticed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.convergence import Estimate

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
