"""Two witnesses compared pixel by pixel, tile by tile and by their image means."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from reference.agreement.measured import Measured, Witness
from reference.agreement.significance import critical_score, gaussian_score, smallest_bias

Array = NDArray[np.float64]

# Error bars cover sampling. Mitsuba's float32 comes on top, of each number, alike in every pass.
ROUNDING = 2e-6


@dataclass(frozen=True)
class Verdict:
    """One test of one pair.

    Attributes
    ----------
    test : str         "pixels", "tiles" or "image mean"
    scores : (...)     difference on the scale of a Gaussian, NaN where both are dark
    critical : float   size that the largest of so many scores exceeds once in 10,000 tests by chance
    power : float      smallest uniform relative bias that the test would catch with a probability of 95 %
    """

    test: str
    scores: Array
    critical: float
    power: float

    @cached_property
    def largest(self) -> float:
        """The score of the largest size, with its sign."""
        found = self.scores[~np.isnan(self.scores)]
        return float(found[np.argmax(np.abs(found))])

    @property
    def count(self) -> int:
        """Places and channels that are not dark in both."""
        return int((~np.isnan(self.scores)).sum())

    @property
    def agrees(self) -> bool:
        """Whether no score is beyond the critical size."""
        return abs(self.largest) <= self.critical


@dataclass(frozen=True)
class Spread:
    """How scores are spread; of a Gaussian 0, 1 and 3."""

    mean: float
    deviation: float
    kurtosis: float


@dataclass(frozen=True)
class Comparison:
    """Two witnesses of one image.

    Attributes
    ----------
    first, second : Witness
    verdicts : tuple of Verdict    of pixels, tiles and the image mean
    """

    first: Witness
    second: Witness
    verdicts: tuple[Verdict, Verdict, Verdict]

    @property
    def name(self) -> str:
        """Both names."""
        return f"{self.first.name} - {self.second.name}"

    @property
    def agrees(self) -> bool:
        """Whether all tests say so."""
        return all(verdict.agrees for verdict in self.verdicts)

    @property
    def difference(self) -> float:
        """Of the image means, relative to the second; infinite where that is black."""
        if self.second.image.mean == 0:
            return float("inf")
        return float(self.first.image.mean / self.second.image.mean - 1)

    @property
    def spread(self) -> Spread:
        """Of the pixels' scores."""
        z = self.verdicts[0].scores
        z = z[~np.isnan(z)]
        return Spread(float(z.mean()), float(z.std()), float(stats.kurtosis(z, fisher=False)))


def compare(first: Witness, second: Witness) -> Comparison:
    """Test whether two independent witnesses differ by more than their errors.

    Raises
    ------
    ValueError
        A mean or a variance is not finite.
    """
    return Comparison(
        first,
        second,
        (
            _verdict("pixels", first.pixels, second.pixels),
            _verdict("tiles", first.tiles, second.tiles),
            _verdict("image mean", first.image, second.image),
        ),
    )


def _verdict(test: str, first: Measured, second: Measured) -> Verdict:
    bright = np.maximum(np.abs(first.mean), np.abs(second.mean))
    difference = first - second + Measured.uncertain(np.square(ROUNDING * bright))
    # what is no number is not dark
    lit = ~(bright == 0)
    scores = np.full(np.shape(lit), np.nan)
    error = np.sqrt(difference.variance[lit])
    scores[lit] = gaussian_score(difference.mean[lit] / error, difference.dof[lit])
    if not np.isfinite(scores[lit]).all():
        raise ValueError(f"the means and variances of {test} must be finite")
    count = int(lit.sum())
    return Verdict(test, scores, critical_score(count), _power(difference, second.mean, lit))


def _power(difference: Measured, mean: Array, lit: NDArray[np.bool_]) -> float:
    error = np.sqrt(np.where(lit, difference.variance, 1.0))
    ratio = np.where(lit, np.abs(mean) / error, 0.0)
    if ratio.ndim < 3:
        best = np.flatnonzero(lit)
    else:
        # channels of a pixel share their paths, so the best of them speaks for all
        best = np.argmax(ratio, axis=-1) + ratio.shape[-1] * np.arange(ratio[..., 0].size).reshape(ratio.shape[:-1])
        best = best[lit.any(axis=-1)]
    sampled = np.sqrt(np.clip(1 - difference.allowed / np.square(error), 0, 1))
    value, error, dof, sampled = (values.ravel()[best] for values in (mean, error, difference.dof, sampled))
    return smallest_bias(value, error, dof, int(lit.sum()), sampled)
