"""Mean and standard error of passes, in float64: per pixel, per tile of 8 x 8 pixels, and of the image."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reference.brightness import darkest
from scenes.errors import InputError

Image = NDArray[np.float64]
TILE = 8


class BlackReferenceError(InputError):
    """A reference is zero everywhere."""


class NotFiniteError(InputError):
    """A layer has pixels that are infinite or not a number.

    Attributes
    ----------
    layer : str
    image : (H, W, 3)
    """

    def __init__(self, layer: str, image: Image) -> None:
        super().__init__(f"The reference's layer '{layer}' has pixels that are not finite.")
        self.layer, self.image = layer, image


class Moments:
    """Welford's running mean and sum of squared deviations of arrays of one shape.

    Parameters
    ----------
    mean, standard_error : array    of `count` samples that were taken before, to go on with
    """

    def __init__(self, mean: Image | float = 0.0, standard_error: Image | float = 0.0, count: int = 0) -> None:
        self.count = count
        self.mean: Image = np.asarray(mean, np.float64)
        self._squares: Image = np.square(standard_error) * (count * (count - 1))

    def add(self, sample: Image) -> None:
        """Take one more sample."""
        self.count += 1
        delta = sample - self.mean
        self.mean = self.mean + delta / self.count
        self._squares = self._squares + delta * (sample - self.mean)

    @property
    def standard_error(self) -> Image:
        """Of the mean; from two samples on."""
        return np.sqrt(self._squares / (self.count * (self.count - 1)))


def tiles(image: Image) -> Image:
    """Means over tiles of 8 x 8 pixels, those at the right and at the bottom smaller.

    Parameters
    ----------
    image : (H, W, 3)

    Returns
    -------
    (ceil(H / 8), ceil(W / 8), 3)
    """
    rows, columns = (np.arange(0, size, TILE) for size in image.shape[:2])
    sums = np.add.reduceat(np.add.reduceat(image, rows, axis=0), columns, axis=1)
    heights, widths = (
        np.diff(np.append(starts, size)) for starts, size in zip((rows, columns), image.shape[:2], strict=True)
    )
    return sums / (heights[:, None] * widths)[..., None]


def relative_errors(mean: Image, standard_error: Image) -> Image:
    """Standard error over mean, (H, W, 3); NaN where the mean is zero, and kept small in the dark: see `darkest`.

    Raises
    ------
    BlackReferenceError
        The image is zero everywhere.
    """
    floor = darkest(mean)
    if floor == 0:
        raise BlackReferenceError("The reference is zero everywhere.")
    return np.where(mean > 0, standard_error / np.maximum(mean, floor), np.nan)


def check_finite(layer: str, image: Image) -> None:
    """Raise NotFiniteError where a picture, (H, W, 3), is infinite or not a number."""
    if not np.isfinite(image).all():
        raise NotFiniteError(layer, image)
