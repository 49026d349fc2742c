"""Whether a picture fits its reference far better turned, brighter, or decoded: the mistakes of exchange, measured."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.brightness import darkest

Pixels = NDArray[np.floating]

# what is said leaves a quarter of the misfit at most, each change for itself
FAR_BETTER = 0.25
# Half a relative error of 1 %: two pictures that fit so well need no hint.
FITS = 0.005
# a factor that is this near to one that people forget is called by its name
NAMED = 0.01
FACTORS = {"pi": np.pi, "1 / pi": 1 / np.pi, "4 pi": 4 * np.pi, "1 / (4 pi)": 1 / (4 * np.pi)}


@dataclass(frozen=True)
class Change:
    """What may have happened to a picture on its way: turned over, encoded for a screen, exposed.

    Attributes
    ----------
    rows, columns : int    -1 where their order is turned round
    encoded : bool         sRGB values in place of linear ones
    scaled : bool          every value times one factor
    """

    rows: int = 1
    columns: int = 1
    encoded: bool = False
    scaled: bool = False

    @property
    def number(self) -> int:
        """How many things have to be wrong."""
        return (self.rows < 0) + (self.columns < 0) + self.encoded + self.scaled

    def undone(self, test: Pixels, linear: Pixels, reference: Pixels) -> tuple[Pixels, float]:
        """The picture as it would be without, (H, W, 3), and the factor that it was multiplied by here."""
        image = (linear if self.encoded else test)[:: self.rows, :: self.columns]
        factor = _factor(image, reference) if self.scaled else 1.0
        return factor * image, factor


_EVERY = [Change(*one) for one in itertools.product((1, -1), (1, -1), (False, True), (False, True))]
# by how many things have to be wrong
CHANGES = {number: [change for change in _EVERY if change.number == number] for number in range(1, 5)}


def fits_better(test: NDArray[np.floating], reference: NDArray[np.floating]) -> str:
    """Say what would make a picture fit its reference far better; empty where nothing would.

    Parameters
    ----------
    test, reference : (H, W, 3)    finite, linear Rec.709 as they are meant

    Returns
    -------
    str
        Such as "upside down and times 3.14 (pi): 0.4 % apart in place of 71.0 %". The misfit is the mean of
        |t - r| / (|t| + |r| + floor), twice of which is the relative error where that is small; it is bounded, so that
        no bright pixel decides. The floor is that of the metrics.
    """
    from colour.models import eotf_sRGB

    test, reference = np.asarray(test, np.float64), np.asarray(reference, np.float64)
    # what is above white was clipped by an encoding, or there was none
    linear = np.asarray(eotf_sRGB(np.clip(test, 0, 1)))
    now = found = _misfit(test, reference)
    said = ""
    done = 0
    if now < FITS:
        return ""
    for number, changes in CHANGES.items():
        # of as many mistakes the likeliest is the one that explains most: an encoding looks like an exposure, too
        undone = [change.undone(test, linear, reference) for change in changes]
        misfits = [_misfit(image, reference) for image, _ in undone]
        best = int(np.argmin(misfits))
        if misfits[best] < found * FAR_BETTER ** (number - done):
            done, found, said = number, misfits[best], _words(changes[best], undone[best][1])
    return f"{said}: {200 * found:.2g} % apart on average in place of {200 * now:.2g} %" if said else ""


def _factor(image: Pixels, reference: Pixels) -> float:
    """Median ratio of the values that are lit in both."""
    lit = (image > 0) & (reference > 0)
    return float(np.median(reference[lit] / image[lit])) if lit.any() else 1.0


def _misfit(image: Pixels, reference: Pixels) -> float:
    size = np.abs(image) + np.abs(reference) + darkest(reference)
    return float(np.mean(np.abs(image - reference) / np.where(size > 0, size, 1)))


def _words(change: Change, factor: float) -> str:
    words = []
    if change.rows < 0 and change.columns < 0:
        words.append("turned by 180 degrees")
    elif change.rows < 0:
        words.append("upside down")
    elif change.columns < 0:
        words.append("mirrored left to right")
    if change.encoded:
        words.append("decoded from sRGB to linear")
    if change.scaled:
        name = next((f" ({name})" for name, value in FACTORS.items() if abs(factor / value - 1) < NAMED), "")
        words.append(f"times {factor:.4g}{name or f' ({np.log2(factor):+.2f} stops)'}")
    return " and ".join(words)
