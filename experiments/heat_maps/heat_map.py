"""What a heat map shows: which error, in which unit, on which scale."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from experiments.flip import LUMINANCE
from experiments.heat_maps.colours import MapName
from experiments.heat_maps.scale import Scale, round_up
from experiments.metrics import Image
from reference.brightness import darkest

Unit = Literal["relative", "radiance"]
Colours = Literal["even", "hue"]
# the scale's end, in relative errors or in parts of white: what is worth a look, and a whole pixel
LINEAR_LIMIT, LOGARITHMIC_LIMIT = 0.2, 1.0
# of a logarithmic scale: three decades, then linear
LINEAR_PIECE = 1e-3
# Errors below so many standard errors of the reference are marked as noise: of pixels without any error, 0.27 % stick
# out of Gaussian noise.
NOISE = 3.0
# radiance at this percentile of the reference's lit pixels is shown just below white
EXPOSURE_PERCENTILE = 99.0
PERCENT = 100.0


@dataclass(frozen=True)
class HeatMap:
    """One kind of error, the same for every picture that is drawn with it.

    All is of the luminance, so that one number a pixel carries the sign. The scale depends on the reference alone:
    pictures with one reference have one scale, whoever draws them and in whichever order.

    Attributes
    ----------
    signed : bool             t - r, positive where the picture is too bright; else |t - r|
    unit : str                "relative": over max(r, floor) [%], the floor as in `Metrics`; "radiance": as it is
    logarithmic : bool        beyond a linear piece of a thousandth of the scale
    limit : float | None      the scale's end, in the unit; None: 100 % (logarithmic) or 20 % (linear), of the pixel or
                              of white: `white` of the reference, rounded up to 1, 2 or 5 times a power of 10
    colours : str             "even" or "hue"

    Raises
    ------
    ValueError
        `limit` is not positive and finite, or `colours` is "hue" for signed errors.
    """

    signed: bool
    unit: Unit
    logarithmic: bool = True
    limit: float | None = None
    colours: Colours = "even"

    def __post_init__(self) -> None:
        if self.colours == "hue" and self.signed:
            raise ValueError("colours must be 'even' for signed errors: the hue map has no middle.")
        if self.limit is not None:
            Scale(self.limit, self.signed)

    def scale(self, reference: Image) -> Scale:
        """The scale of every picture with this reference, (H, W, 3)."""
        limit = self.limit
        if limit is None:
            limit = LOGARITHMIC_LIMIT if self.logarithmic else LINEAR_LIMIT
            limit = limit * PERCENT if self.unit == "relative" else round_up(limit * white(reference))
        return Scale(limit, self.signed, limit * LINEAR_PIECE if self.logarithmic else None)

    def errors(self, test: Image, reference: Image) -> NDArray[np.float64]:
        """(H, W), in the unit; 0 where the reference is black all over and the unit relative to it."""
        test_y, reference_y = luminance(test), luminance(reference)
        difference = (test_y - reference_y) * self._factor(reference_y)
        return difference if self.signed else np.abs(difference)

    def noise(self, standard_error: Image, reference: Image) -> NDArray[np.float64]:
        """`NOISE` standard errors of the reference's luminance, (H, W), in the unit.

        A path lights all channels: their errors add up as if they were one, which in grey fog they are.
        """
        return NOISE * luminance(standard_error) * self._factor(luminance(reference))

    def _factor(self, reference_y: NDArray[np.float64]) -> NDArray[np.float64] | float:
        if self.unit == "radiance":
            return 1.0
        lit = np.maximum(reference_y, darkest(reference_y))
        return np.divide(PERCENT, lit, out=np.zeros_like(lit), where=lit > 0)

    @property
    def colour_map(self) -> MapName:
        """Name of its colours; see `experiments.heat_maps.colours`."""
        if self.colours == "hue":
            return "hue"
        return "vik" if self.signed else "lajolla"

    @property
    def symbol(self) -> str:
        """The unit as a bar has it."""
        return "%" if self.unit == "relative" else "radiance"

    @property
    def title(self) -> str:
        """What the map shows, with its unit."""
        kind = "signed" if self.signed else "absolute"
        relative = " relative" if self.unit == "relative" else ""
        return f"{kind}{relative} error [{self.symbol}]"


def luminance(image: Image) -> NDArray[np.float64]:
    """Luminance of linear Rec.709, (H, W, 3) to (H, W)."""
    return np.asarray(image, np.float64) @ LUMINANCE


def white(reference: Image) -> float:
    """Radiance that is shown as white, (H, W, 3) to a number: a percentile over the lit pixels; 1 for a black picture.

    Over all pixels it would be 0 where a beam lights less than 1 % of them.
    """
    lit = reference[(reference > 0).any(axis=-1)]
    return float(np.percentile(lit, EXPOSURE_PERCENTILE)) if lit.size else 1.0


def typical_noise(noise: NDArray[np.float64]) -> float:
    """Median over the pixels that have any noise, which are those that the reference found lit; 0 where none has."""
    found = noise[noise > 0]
    return float(np.median(found)) if found.size else 0.0


def is_noise(errors: NDArray[np.float64], noise: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which errors cannot be told from the reference's noise, (H, W); without noise, an error is one however small."""
    return np.abs(errors) < noise
