"""Flicker: what changes from frame to frame although it does not in the truth."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from experiments.flip import LUMINANCE
from experiments.measurements import Measurement, Value
from experiments.measurements.shot import Shot
from reference.brightness import darkest
from scenes.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sight:
    """One frame of a path: luminances, (H, W) each."""

    test: Array
    truth: Array
    standard_error: Array


@dataclass(frozen=True)
class Flicker:
    """How much a path flickers, over its pixels with light and its pairs of neighbouring frames.

    A pair's value is ((t' - t) - (r' - r)) / max((r + r') / 2, floor): t and t' are the technique's frames, r and r'
    the reference's, the floor is that of relative errors (reference/brightness.py) for all frames together. An error
    that stays where it is does not flicker, however large it is.

    Attributes
    ----------
    rms : float       root of the mean square [relative]
    high : float      95th percentile of the absolute value [relative]
    moved : float     root mean square of the truth's own change, (r' - r) over the same [relative]
    noise : float     root mean square that the reference's standard errors would add to `rms` if those of two frames
                      were independent; they add far less, since all frames are sampled with the same random numbers
                      and err alike. Nothing is taken away for it. [relative]
    """

    rms: float
    high: float
    moved: float
    noise: float


def flicker_of(sights: Iterable[Sight]) -> Flicker | None:
    """Measure a path of two frames or more; None where nothing is lit."""
    path = list(sights)
    floor = darkest(np.stack([sight.truth for sight in path]))
    if floor == 0:
        return None
    values, moves, noises = [], [], []
    for one, two in pairwise(path):
        seen = (one.truth > 0) | (two.truth > 0) | (one.test > 0) | (two.test > 0)
        scale = np.maximum((one.truth + two.truth) / 2, floor)[seen]
        moves.append((two.truth - one.truth)[seen] / scale)
        values.append((two.test - one.test)[seen] / scale - moves[-1])
        # as if independent: an upper bound, for the passes of every frame have the same seeds
        noises.append(np.hypot(one.standard_error, two.standard_error)[seen] / scale)
    square, moved, noise = (float(np.mean(np.concatenate(found) ** 2)) for found in (values, moves, noises))
    return Flicker(
        rms=float(np.sqrt(square)),
        high=float(np.percentile(np.abs(np.concatenate(values)), 95)),
        moved=float(np.sqrt(moved)),
        noise=float(np.sqrt(noise)),
    )


def flicker(shot: Shot) -> dict[str, Value]:
    """The scattering layer's flicker along the case's path: its columns are `Flicker`'s attributes.

    flicker.rms, .high, .moved, .noise   see there; None where nothing is lit
    flicker.frames                       how many frames the path has
    flicker.degrees                      how far the camera turns around the scene from one to the next [degree]

    Raises
    ------
    InputError
        The camera stays where it is.
    """
    camera = shot.case.camera
    if camera.frames < 2:
        raise InputError("flicker needs a path: give the camera two frames or more.")
    found = flicker_of(
        Sight(
            view.frame.scattering @ LUMINANCE,
            view.reference.scattering @ LUMINANCE,
            view.reference.standard_error("scattering") @ LUMINANCE,
        )
        for view in shot.views()
    )
    numbers = dict.fromkeys(("rms", "high", "moved", "noise")) if found is None else vars(found)
    return {
        **{f"flicker.{name}": value for name, value in numbers.items()},
        "flicker.frames": camera.frames,
        "flicker.degrees": camera.step,
    }


MEASUREMENT = Measurement(flicker)
