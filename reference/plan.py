"""How many strata each pixel needs: pilot passes tell, before the passes that count."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter

from reference.goal import FEWEST_IN_LIMIT, FEWEST_PASSES, Goal
from reference.moments import Image, Moments, check_finite, relative_errors

PILOT_PASSES = 8
PILOT_STRATA = 16
# A shadow, or a gap in one, that takes a share q of a ray's samples is missed by n of them with the probability
# e^(-q n), and leaves no trace in the error bar then. One that changes the pixel by twice the goal is missed in so few
# pixels. With 16 strata for all, two pixels of `yeahright` at 256 x 256 were 0.9 % and 0.3 % too bright, by 130 and 35
# error bars.
MISSED = 1e-6
# against the pilot's own error and a law that holds only from some strata on; measured with 1: the goal took 32, 32, 45
# and 53 passes on sphere, donut_dragon, yeahright and wire_mesh at 256 x 256 and 0.5 %
MARGIN = 1.25
# more would add hours to a pass whose pixels are known to a ten-thousandth
MOST_STRATA = 4096


def plan_strata(one_pass: Callable[[int], Image], goal: Goal) -> tuple[NDArray[np.uint32], float]:
    """Choose the strata of each pixel with which the fewest passes meet the goal.

    A pass with n strata is off by a / n^{3/2} where the integrand is smooth, and by b / n where a shadow's edge crosses
    the ray: twice the strata are worth more than twice the passes, whose error falls with the square root. So the
    strata are made as many as the pilot's spread asks for under the law 1 / n, and the passes as few as an error bar
    takes. The pilot's own passes are not counted in the estimate, which therefore stays unbiased.

    Parameters
    ----------
    one_pass : callable    number of a pilot pass to a picture, (H, W, 3), of PILOT_STRATA strata a pixel

    Returns
    -------
    strata : (H, W)
    planned_for : float    relative error that they are for; the goal's, or more where the limits have no room

    Raises
    ------
    BlackReferenceError, NotFiniteError
        The pilot saw nothing, or what is no radiance.
    """
    pilot = Moments()
    # the first pass compiles
    pilot.add(one_pass(0))
    begin = time.perf_counter()
    for number in range(1, PILOT_PASSES):
        pilot.add(one_pass(number))
    per_sample = (time.perf_counter() - begin) / ((PILOT_PASSES - 1) * PILOT_STRATA)
    check_finite("scattering", pilot.mean)
    spread = relative_errors(pilot.mean, pilot.standard_error) * np.sqrt(PILOT_PASSES)
    # what holds for a pixel holds for the next, whose own pilot may have met no edge
    spread, lit = maximum_filter(np.nan_to_num(spread).max(axis=2), size=3), pilot.mean.max(axis=2) > 0
    needed = MARGIN * PILOT_STRATA * spread / (goal.rel_error * np.sqrt(FEWEST_PASSES))
    fewest = np.clip(-np.log(MISSED) / (2 * goal.rel_error * FEWEST_PASSES), PILOT_STRATA, MOST_STRATA)
    # the goal is a percentile's: what lies beyond it need not be as accurate
    most = np.clip(np.percentile(needed[lit], goal.percentile), fewest, MOST_STRATA)
    strata = np.clip(needed, fewest, most)
    # the limits leave room for the passes that are always made, no more, so that what goes on from there goes on well
    mean = float(strata.mean())
    share = min(1.0, goal.time_limit / (FEWEST_IN_LIMIT * per_sample * mean))
    if goal.sample_limit:
        share = min(share, goal.sample_limit / (FEWEST_IN_LIMIT * mean))
    strata = np.ceil(strata) if share == 1 else np.maximum(np.floor(strata * share), 1)
    if goal.sample_limit and strata.mean() * FEWEST_IN_LIMIT > goal.sample_limit:
        # what was raised to a whole stratum
        strata = np.full_like(strata, goal.sample_limit // FEWEST_IN_LIMIT)
    return strata.astype(np.uint32), goal.rel_error * max(1.0, mean / float(strata.mean()))
