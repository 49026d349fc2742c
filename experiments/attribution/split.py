"""The error of a picture, split over the parts of the technique that drew it, with what the reference's noise does.

Of pictures t of all coalitions and a reference r, known up to noise of variance s^2,

    v(S) = mean (t_S - r)^2 - mean s^2

is the mean squared error that replacing the coalition S leaves. The Shapley values phi of v add up to v(nothing) -
v(all), and their per-pixel companions, the Shapley values D of the signed errors t_S - r, to t_nothing - t_all.

In v(S) - v(S + i) the squares of r cancel: it is mean (t_S - t_Si)(t_S + t_Si - 2 r), linear in r with the slope
-2 (t_S - t_Si) / N at each of N values. So phi_i is linear in r too, with the slope -2 D_i / N, and so is the sum of
the parts with that of the D_i. Noise that is independent from pixel to pixel gives them the variance

    sum over pixels (sum over channels 2 |D_i| s / N)^2,

channels counted as if their noise were one, which in grey fog under white light it is; elsewhere this is an upper
bound. The same formula with t - r for D_i serves v itself: with d the error without noise, its mean is the sum of
4 d^2 s^2 + 4 s^4, over N^2, and v's variance that of 4 d^2 s^2 + 2 s^4 + 2 s^4 / (m - 1), the last from s^2 as it was
estimated from m passes: no more, from two passes on. Pixels are no sample: the split is of this picture.

A deterministic reference has no noise, and a bound b of its error in place of s. Nothing is subtracted then, so that no
v is negative, and every share is off by no more than mean (2 |D_i| b + b^2).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.attribution.shapley import Coalition, coalitions, shapley
from experiments.metrics import Image

Signed = NDArray[np.float64]


@dataclass(frozen=True)
class Share:
    """A squared error with its standard error, and the signed error of each pixel beside it.

    Attributes
    ----------
    value, standard_error : float    [radiance^2]; by a deterministic reference a bound in place of the second
    signed : (H, W, 3)               [radiance]
    """

    value: float
    standard_error: float
    signed: Signed

    @property
    def is_noise(self) -> bool:
        """Whether it lies within three standard errors of 0."""
        return abs(self.value) < 3 * self.standard_error


@dataclass(frozen=True)
class Split:
    """The error of one picture.

    Attributes
    ----------
    whole : Share             with nothing replaced
    parts : dict              name of a part to its share
    together : Share          the sum of the parts: what replacing all of them takes away
    remains : Share           with all of them replaced
    left : dict               coalition to v, the mean squared error that replacing it leaves [radiance^2]
    """

    whole: Share
    parts: dict[str, Share]
    together: Share
    remains: Share
    left: dict[Coalition, float]

    def fraction(self, share: Share) -> float:
        """A share over the parts together; NaN where their sum cannot be told from noise.

        Not over the whole, whose noise is of the square of the reference's: the parts are known where it is not.
        """
        return float("nan") if self.together.is_noise else share.value / self.together.value


def split(
    parts: Sequence[str],
    pictures: Mapping[Coalition, Image],
    reference: Image,
    standard_error: Image,
    is_bound: bool = False,
) -> Split:
    """Split the error of the picture in which nothing is replaced.

    Parameters
    ----------
    parts : names
    pictures : coalition of replaced parts to the picture (H, W, 3), for all `coalitions(parts)`
    reference, standard_error : (H, W, 3)    the noise independent from pixel to pixel
    is_bound : bool                          the reference has no noise, and this bounds its error

    Raises
    ------
    ValueError
        As `shapley`; or a picture is not of the reference's shape.
    """
    noise = np.asarray(standard_error, np.float64)
    subtracted = 0.0 if is_bound else np.mean(noise**2)
    signed, left = {}, {}
    for chosen in coalitions(parts):
        if chosen not in pictures:
            continue
        if pictures[chosen].shape != reference.shape:
            raise ValueError(f"pictures must have the reference's shape {reference.shape}: {pictures[chosen].shape}")
        signed[chosen] = np.asarray(pictures[chosen], np.float64) - reference
        left[chosen] = float(np.mean(signed[chosen] ** 2) - subtracted)
    values, maps = shapley(parts, left), shapley(parts, signed)

    def share(value: float, errors: Signed) -> Share:
        slope = 2 * np.abs(errors) / errors.size
        if is_bound:
            return Share(value, float(np.sum(slope * noise) + np.mean(noise**2)), errors)
        return Share(value, float(np.sqrt(np.sum(np.sum(slope * noise, axis=-1) ** 2))), errors)

    nothing, everything = Coalition(), Coalition(parts)
    return Split(
        whole=share(left[nothing], signed[nothing]),
        parts={part: share(values[part], maps[part]) for part in parts},
        together=share(left[nothing] - left[everything], signed[nothing] - signed[everything]),
        remains=share(left[everything], signed[everything]),
        left=left,
    )
