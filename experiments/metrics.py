"""How far a picture is from its reference, in numbers that say what they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.flip import hdr_flip
from reference.brightness import darkest
from scenes.errors import InputError

Image = NDArray[np.floating]


@dataclass(frozen=True)
class Metrics:
    """Errors of one layer, over pixels and channels. None where a number has no meaning: a black reference.

    Relative errors (mean and percentiles) count the values that are not zero in both pictures: outside a spot's cone
    every technique is right, and how much of that an image shows is no merit.
    The floor is 1 % of the median of the lit reference (reference/brightness.py).

    Attributes
    ----------
    rel_mse : float            mean of (t - r)^2 / (r^2 + eps), eps = floor^2
    rmse : float               root of the mean of (t - r)^2 [radiance]
    bias : float               sqrt(max(0, MSE - mean variance of the reference)) [radiance]: the technique's own error
    mean_rel : float           mean of (t - r) / max(r, floor)
    rel_50, rel_95, rel_99     percentiles of |t - r| / max(r, floor)
    image_mean_rel : float     (mean t - mean r) / mean r
    flip : float               mean HDR-FLIP (Andersson et al. 2021), 0 to 1, exposed for the lit pixels
    """

    rel_mse: float | None
    rmse: float
    bias: float
    mean_rel: float | None
    rel_50: float | None
    rel_95: float | None
    rel_99: float | None
    image_mean_rel: float | None
    flip: float | None

    def __repr__(self) -> str:
        """One line, for notebooks: the numbers that a sheet shows, and the bias."""
        if self.rel_50 is None:
            return f"<Metrics: the reference is black; RMSE {self.rmse:.3g}>"
        return (
            f"<Metrics: median {self.rel_50:.3%}, 95 % below {self.rel_95:.3%}, 99 % below {self.rel_99:.3%}, "
            f"image mean {self.image_mean_rel:+.3%}, bias {self.bias:.2g}, FLIP {self.flip:.4f}>"
        )


def signed_relative_error(test: Image, reference: Image) -> NDArray[np.float64]:
    """(t - r) / max(r, floor), same shape as the images."""
    reference = np.asarray(reference, np.float64)
    return (np.asarray(test, np.float64) - reference) / np.maximum(reference, darkest(reference))


def measure(test: Image, reference: Image, standard_error: Image | None = None) -> Metrics:
    """Compare a picture with its reference.

    Parameters
    ----------
    test, reference : (H, W, 3)    linear Rec.709
    standard_error : (H, W, 3)     of the reference's noise, whose variance the bias leaves out; None where
                                   nothing is subtracted: it is not known, or the reference is not sampled

    Raises
    ------
    InputError
        A picture is no array (H, W, 3), the sizes differ, or a picture holds values that are not finite.
    """
    test, reference = _picture("picture", test), _picture("reference", reference)
    error = np.zeros_like(reference)
    if standard_error is not None:
        error = _picture("reference's standard error", standard_error)
    for image in (test, error):
        if image.shape != reference.shape:
            sizes = " and ".join(f"{found.shape[1]} x {found.shape[0]}" for found in (image, reference))
            raise InputError(f"The pictures have different sizes, {sizes} pixels; render them at the same size.")
    squared = (test - reference) ** 2
    variance = float(np.mean(np.square(error)))
    rmse, bias = float(np.sqrt(squared.mean())), float(np.sqrt(max(0.0, squared.mean() - variance)))
    if not reference.mean() > 0:
        return Metrics(None, rmse, bias, None, None, None, None, None, None)
    relative = signed_relative_error(test, reference)[(test != 0) | (reference != 0)]
    percentiles = np.percentile(np.abs(relative), [50, 95, 99])
    return Metrics(
        rel_mse=float(np.mean(squared / (reference**2 + darkest(reference) ** 2))),
        rmse=rmse,
        bias=bias,
        mean_rel=float(relative.mean()),
        rel_50=float(percentiles[0]),
        rel_95=float(percentiles[1]),
        rel_99=float(percentiles[2]),
        image_mean_rel=float(test.mean() / reference.mean() - 1),
        flip=hdr_flip(test, reference),
    )


def _picture(name: str, image: Image) -> NDArray[np.float64]:
    """An array (H, W, 3) of finite values, or InputError."""
    try:
        found = np.asarray(image, np.float64)
    except (TypeError, ValueError):
        raise InputError(f"The {name} is no array of numbers; give one of the shape (height, width, 3).") from None
    if found.ndim != 3 or found.shape[2] != 3 or not found.size:
        raise InputError(f"The {name} is an array of the shape {found.shape}; give one of (height, width, 3).")
    broken = ~np.isfinite(found).all(axis=2)
    if broken.any():
        row, column = np.argwhere(broken)[0]
        raise InputError(
            f"The {name} holds values that are not finite in {broken.sum()} of its pixels, the first in row {row}, "
            f"column {column}; nothing can be measured on it."
        )
    return found
