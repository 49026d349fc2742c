"""Numbers with their uncertainty, and a witness: an image measured at three scales."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from operator import add

import numpy as np
from numpy.typing import NDArray

from reference.convergence import Estimate
from reference.moments import TILE, Image, tiles

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Measured:
    """Numbers, each known to a variance that is itself known to some degrees of freedom.

    Attributes
    ----------
    mean, variance, dof : (...)    dof is infinite where the variance is no estimate
    allowed : (...)                of the variance, what allows for the unknown and is no spread of samples
    """

    mean: Array
    variance: Array
    dof: Array
    allowed: Array

    @classmethod
    def sampled(cls, mean: Array, error: Array, passes: int) -> Measured:
        """Means of `passes` passes, or where there were none, numbers with a known error."""
        variance = np.square(error)
        dof = np.full(np.shape(mean), passes - 1.0 if passes else np.inf)
        return cls(mean, variance, dof, np.zeros_like(variance) if passes else variance)

    @classmethod
    def uncertain(cls, variance: Array) -> Measured:
        """Nothing but an uncertainty, of known variance."""
        return cls(np.zeros_like(variance), variance, np.full(np.shape(variance), np.inf), variance)

    def __add__(self, other: Measured) -> Measured:
        """Sum with what is independent of it; degrees of freedom by Welch (1947) and Satterthwaite (1946)."""
        variance = self.variance + other.variance
        spread = self.variance**2 / self.dof + other.variance**2 / other.dof
        dof = np.divide(variance**2, spread, out=np.full(np.shape(spread), np.inf), where=spread > 0)
        return Measured(self.mean + other.mean, variance, dof, self.allowed + other.allowed)

    def __sub__(self, other: Measured) -> Measured:
        """Difference from what is independent of it."""
        return self + Measured(-other.mean, other.variance, other.dof, other.allowed)


@dataclass(frozen=True)
class Witness:
    """One estimator's image.

    Attributes
    ----------
    name : str
    pixels : Measured, (H, W, 3)
    tiles : Measured, (h, w, 3)    means over 8 x 8 pixels
    image : Measured, ()           mean over all pixels and channels
    """

    name: str
    pixels: Measured
    tiles: Measured
    image: Measured


def witness(name: str, estimate: Estimate, unseen: Image | None = None, surface: Image | None = None) -> Witness:
    """Sum of an estimate's sampled layers, or of its computed ones where nothing was sampled.

    Parameters
    ----------
    unseen : (H, W, 3)     variance of each pixel for what no sample met; none by default
    surface : (H, W, 3)    added as an exact layer; the estimate's own is left out
    """
    pixels, means, images = [], [], []
    for layer in estimate.mean:
        if layer == "surface":
            continue
        n = estimate.passes
        pixels.append(Measured.sampled(estimate.mean[layer], estimate.standard_error[layer], n))
        means.append(Measured.sampled(estimate.tile_mean[layer], estimate.tile_error[layer], n))
        # channels of a pass share their paths, so their errors add up rather than average out
        image, error = (values[layer].mean() for values in (estimate.image_mean, estimate.image_error))
        images.append(Measured.sampled(image, error, n))
    if surface is not None:
        exact = exact_witness(name, surface)
        pixels.append(exact.pixels)
        means.append(exact.tiles)
        images.append(exact.image)
    if unseen is not None:
        pixels.append(Measured.uncertain(unseen))
        means.append(Measured.uncertain(tiles(unseen) / _tile_sizes(unseen)))
        images.append(Measured.uncertain(np.square(np.sqrt(unseen.sum((0, 1))).mean() / unseen[..., 0].size)))
    return Witness(name, reduce(add, pixels), reduce(add, means), reduce(add, images))


def exact_witness(name: str, image: Image) -> Witness:
    """Numbers without an error."""

    def exact(values: Array) -> Measured:
        return Measured.sampled(np.asarray(values), np.zeros(np.shape(values)), 0)

    return Witness(name, exact(image), exact(tiles(image)), exact(image.mean()))


def _tile_sizes(image: Image) -> Array:
    """Pixels in each tile, (h, w, 1)."""
    heights, widths = (np.minimum(TILE, size - np.arange(0, size, TILE)) for size in image.shape[:2])
    return np.multiply.outer(heights, widths)[..., None].astype(float)
