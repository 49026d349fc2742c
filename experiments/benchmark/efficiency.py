"""From the spread and the seconds of passes to the seconds that each pixel takes to its goal."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.brightness import darkest
from reference.goal import FEWEST_PASSES
from reference.moments import Image, Moments, relative_errors

Array = NDArray[np.float64]

# A pixel's error is set by shadows where they take the variance of a pass to four times what it is without them: for
# 32 passes of each and one variance the ratio is above 4 by chance in 1e-4 of all pixels (Fisher's F).
EDGE = 4.0


@dataclass(frozen=True)
class Passes:
    """Independent passes of one estimator.

    Attributes
    ----------
    mean, deviation : (H, W, 3)    of a pass
    seconds : (passes,)            that each took
    """

    mean: Image
    deviation: Image
    seconds: Array

    @property
    def typical_seconds(self) -> float:
        """Of a pass: the median, for other programs take their time too."""
        return float(np.median(self.seconds))


def interleave(estimators: Mapping[str, Callable[[int], Image]], passes: int) -> dict[str, Passes]:
    """Run passes in turn, one of each estimator, so that a machine that slows down slows all of them.

    Parameters
    ----------
    estimators : name to callable    number of a pass to its picture, (H, W, 3); each has run once, to be compiled
    passes : int                     of each, 2 or more
    """
    moments = {name: Moments() for name in estimators}
    seconds: dict[str, list[float]] = {name: [] for name in estimators}
    for number in range(passes):
        for name, one_pass in estimators.items():
            begin = time.perf_counter()
            picture = one_pass(number)
            seconds[name].append(time.perf_counter() - begin)
            moments[name].add(picture)
    return {
        name: Passes(found.mean, found.standard_error * np.sqrt(passes), np.array(seconds[name]))
        for name, found in moments.items()
    }


def lit_pixels(truth: Image) -> NDArray[np.bool_]:
    """Pixels with airlight, (H, W): some channel is brighter than `darkest`, below which relative errors say little."""
    return truth.max(axis=2) > darkest(truth)


def relative_deviation(passes: Passes, truth: Image) -> Array:
    """Deviation of one pass over the truth, of each lit pixel's worst channel, (lit,)."""
    return np.nanmax(relative_errors(truth, passes.deviation)[lit_pixels(truth)], axis=1)


def seconds_by_variance(passes: Passes, truth: Image, rel_error: float) -> Array:
    """Seconds until the standard error of each lit pixel is at the goal, by variance x time, (lit,).

    The inverse of the field's efficiency. It lets a pixel stop at a fraction of a pass, so it compares estimators;
    what a person waits is `seconds_as_run`.
    """
    return passes.typical_seconds * (relative_deviation(passes, truth) / rel_error) ** 2


def seconds_as_run(passes: Passes, truth: Image, rel_error: float, plan_seconds: float = 0.0) -> Array:
    """Seconds after which each lit pixel is at the goal when whole passes of all pixels run, (lit,).

    Parameters
    ----------
    plan_seconds : float    spent before the first pass; there are never fewer passes than an error bar takes
    """
    needed = np.ceil((relative_deviation(passes, truth) / rel_error) ** 2)
    return plan_seconds + passes.typical_seconds * np.maximum(needed, FEWEST_PASSES)


def edge_pixels(shadowed: Passes, unshadowed: Passes, truth: Image) -> NDArray[np.bool_]:
    """Lit pixels whose error is set by the edges of shadows, not by how the light varies between them, (lit,)."""
    lit = lit_pixels(truth)
    with_shadows, without = (np.sum(passes.deviation[lit] ** 2, axis=1) for passes in (shadowed, unshadowed))
    return with_shadows > EDGE * without


def fitted_exponent(strata: Array, errors: Array) -> float:
    """Exponent of a power law by least squares of the logarithms; NaN where there is nothing to fit."""
    return float(np.polyfit(np.log(strata), np.log(errors), 1)[0]) if np.all(errors > 0) else float("nan")


def quartiles(values: Array) -> tuple[float, float, float]:
    """Lower quartile, median and upper quartile."""
    low, middle, high = np.percentile(values, (25, 50, 75))
    return float(low), float(middle), float(high)
