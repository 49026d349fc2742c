"""Passes accumulated in float64 until their standard error is as small as asked."""

from __future__ import annotations

import time
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from reference.estimators import Estimator
from reference.goal import FEWEST_IN_LIMIT, FEWEST_PASSES, Goal
from reference.moments import Image, Moments, check_finite, relative_errors, tiles
from scenes.errors import InputError

# what a kill costs at most, and the pass that it comes in [s]
KEEP_EVERY = 60.0
StoppedBy = Literal["goal", "time", "samples", "interrupt", "exact"]


@dataclass(frozen=True)
class Progress:
    """How far an estimate has got."""

    passes: int
    rel_error: float
    seconds: float
    seconds_left: float


@dataclass(frozen=True)
class Estimate:
    """Mean and standard error per layer.

    Attributes
    ----------
    mean, standard_error : dict of (H, W, 3)   radiance
    tile_mean, tile_error : dict               means over tiles of 8 x 8 pixels, (ceil(H / 8), ceil(W / 8), 3), and
                                               their standard error from the passes
    image_mean, image_error : dict of (3,)     the same of the image
    samples : (H, W)       taken of each pixel in a pass
    passes : int           0 for what is not sampled
    planned_for : float    relative error for which `samples` were chosen; larger than asked where a limit had no room
    rel_error : float      what was reached, at the goal's percentile
    stopped_by : str       "goal", "time" or "samples": which limit; "interrupt"; "exact" for what is not sampled
    seconds : float
    """

    mean: dict[str, Image]
    standard_error: dict[str, Image]
    tile_mean: dict[str, Image]
    tile_error: dict[str, Image]
    image_mean: dict[str, Image]
    image_error: dict[str, Image]
    samples: NDArray[np.uint32]
    passes: int
    planned_for: float
    rel_error: float
    stopped_by: StoppedBy
    seconds: float

    @property
    def reached(self) -> bool:
        """Whether it is as accurate as asked."""
        return self.stopped_by in ("goal", "exact")


class _Layer:
    """One layer's moments at three scales, for neighbouring pixels need not be independent."""

    def __init__(self) -> None:
        self.pixels, self.tiles, self.image = Moments(), Moments(), Moments()

    @classmethod
    def going_on(cls, layer: str, start: Estimate) -> _Layer:
        """Take up what passes have left."""
        made = cls()
        made.pixels = Moments(start.mean[layer], start.standard_error[layer], start.passes)
        made.tiles = Moments(start.tile_mean[layer], start.tile_error[layer], start.passes)
        made.image = Moments(start.image_mean[layer], start.image_error[layer], start.passes)
        return made

    def taking(self, sample: Image) -> _Layer:
        """Return this layer with one more sample; this one stays as it is."""
        made = _Layer()
        made.pixels, made.tiles, made.image = copy(self.pixels), copy(self.tiles), copy(self.image)
        made.pixels.add(sample)
        made.tiles.add(tiles(sample))
        made.image.add(sample.mean(axis=(0, 1)))
        return made


def converge(
    estimator: Estimator,
    goal: Goal,
    report: Callable[[Progress], None] | None = None,
    start: Estimate | None = None,
    keep: Callable[[Estimate], None] | None = None,
) -> Estimate:
    """Run passes until the goal is met, or a limit is.

    Parameters
    ----------
    report : called after each pass
    start : a stopped estimate of the same estimator, to go on with
    keep : called with what there is once a minute, and when Ctrl-C or SystemExit ends the work

    Raises
    ------
    InputError
        The sample limit is less than the fewest passes take.
    NotFiniteError
        An estimate is infinite or not a number somewhere.
    BlackReferenceError
        It is zero everywhere.
    """
    begin = time.perf_counter()
    if start:
        estimator.samples, planned_for = start.samples, start.planned_for
    else:
        planned_for = estimator.plan(goal)
        _check_sample_limit(estimator, goal)
    run = _Run(estimator, goal, start, planned_for, begin)
    kept = time.perf_counter()
    try:
        while not (stopped_by := run.stopped_by()):
            run.one_pass()
            if report and run.passes > 1:
                report(run.progress())
            if keep and run.passes > 1 and time.perf_counter() - kept > KEEP_EVERY:
                keep(run.estimate("interrupt"))
                kept = time.perf_counter()
    except (KeyboardInterrupt, SystemExit):
        if keep and run.passes > 1:
            keep(run.estimate("interrupt"))
        raise
    return run.estimate(stopped_by)


class _Run:
    """One run of passes, from nothing or from where another one stopped."""

    def __init__(
        self, estimator: Estimator, goal: Goal, start: Estimate | None, planned_for: float, begin: float
    ) -> None:
        self._estimator, self._goal, self._start, self._begin = estimator, goal, start, begin
        self._planned_for = planned_for
        self.passes = start.passes if start else 0
        self._layers = {layer: _Layer.going_on(layer, start) if start else _Layer() for layer in estimator.layers}
        self._fixed: dict[str, _Layer] = {}
        for layer, image in estimator.fixed().items():
            check_finite(layer, image)
            # twice the same has no error
            self._fixed[layer] = _Layer().taking(image).taking(image)

    @property
    def _seconds(self) -> float:
        return time.perf_counter() - self._begin

    def one_pass(self) -> None:
        layers = {}
        for layer, image in self._estimator.one_pass(seed=self.passes).items():
            check_finite(layer, image)
            layers[layer] = self._layers[layer].taking(image)
        # Ctrl-C may come at any time, and must find all of a pass or nothing of it
        self._layers, self.passes = layers, self.passes + 1

    def rel_error(self) -> float:
        decisive = self._layers[self._estimator.layers[0]].pixels
        return relative_error(decisive.mean, decisive.standard_error, self._goal.percentile)

    def stopped_by(self) -> StoppedBy | None:
        if self.passes >= FEWEST_PASSES and self.rel_error() <= self._goal.rel_error:
            return "goal"
        if self.passes < FEWEST_IN_LIMIT:
            return None
        # of a run that goes on, the time starts anew; it does at least one pass
        if self._seconds > self._goal.time_limit and (not self._start or self.passes > self._start.passes):
            return "time"
        return "samples" if self._samples_left() < 1 else None

    def _samples_left(self) -> float:
        """Passes that the sample limit has left."""
        if self._goal.sample_limit is None:
            return np.inf
        return self._goal.sample_limit / float(self._estimator.samples.mean()) - self.passes

    def progress(self) -> Progress:
        present = self.rel_error()
        # the error falls with the square root of the number of passes
        needed = max(FEWEST_PASSES, self.passes * (present / self._goal.rel_error) ** 2) - self.passes
        done = self.passes - (self._start.passes if self._start else 0)
        left = min(self._seconds / done * min(needed, self._samples_left()), self._goal.time_limit - self._seconds)
        return Progress(self.passes, present, self._seconds, max(left, 0.0))

    def estimate(self, stopped_by: StoppedBy) -> Estimate:
        layers = (self._layers | self._fixed).items()
        return Estimate(
            mean={layer: of.pixels.mean for layer, of in layers},
            standard_error={layer: of.pixels.standard_error for layer, of in layers},
            tile_mean={layer: of.tiles.mean for layer, of in layers},
            tile_error={layer: of.tiles.standard_error for layer, of in layers},
            image_mean={layer: of.image.mean for layer, of in layers},
            image_error={layer: of.image.standard_error for layer, of in layers},
            samples=self._estimator.samples,
            passes=self.passes,
            planned_for=self._planned_for,
            rel_error=self.rel_error(),
            stopped_by=stopped_by,
            seconds=self._seconds + (self._start.seconds if self._start else 0.0),
        )


def _check_sample_limit(estimator: Estimator, goal: Goal) -> None:
    fewest = int(np.ceil(FEWEST_IN_LIMIT * estimator.samples.mean()))
    if goal.sample_limit is not None and goal.sample_limit < fewest:
        raise InputError(
            f"The sample limit is {goal.sample_limit}, and the fewest passes take {fewest} samples a pixel; "
            f"use at least {fewest}."
        )


def relative_error(mean: Image, standard_error: Image, percentile: float) -> float:
    """Standard error over mean at a percentile of the pixels and channels that are lit; see `relative_errors`."""
    return float(np.nanpercentile(relative_errors(mean, standard_error), percentile))
