"""Passes accumulated in float64 until their standard error is as small as asked."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from reference.brightness import darkest
from reference.estimators import Estimator, Image
from reference.goal import Goal
from scenes.errors import InputError

# An error bar from few passes is itself uncertain. From 32, |z| > 4 by chance is a matter of 4e-4 (Student's t); from 8
# it would be 5e-3, and every large image would seem to disagree somewhere.
FEWEST_PASSES = 32
# a time limit stops earlier, with the error bar that there is
FEWEST_IN_TIME = 8
PERCENTILE = 95


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
    image_mean, image_error : dict of (3,)     mean over the image, and its standard error from the passes
    passes : int
    rel_error : float    what was reached
    reached : bool       whether that is what was asked
    seconds : float
    """

    mean: dict[str, Image]
    standard_error: dict[str, Image]
    image_mean: dict[str, Image]
    image_error: dict[str, Image]
    passes: int
    rel_error: float
    reached: bool
    seconds: float


class _Running:
    """Welford's mean and variance of one layer, float64."""

    def __init__(self) -> None:
        self.count = 0
        self.mean: Image = np.zeros(())
        self.squares: Image = np.zeros(())
        self.image_means: list[Image] = []

    def add(self, sample: Image) -> None:
        self.count += 1
        delta = sample - self.mean
        self.mean = self.mean + delta / self.count
        self.squares = self.squares + delta * (sample - self.mean)
        # neighbouring pixels need not be independent, so the image mean gets an error bar of its own
        self.image_means.append(sample.mean(axis=(0, 1)))

    def standard_error(self) -> Image:
        return np.sqrt(self.squares / (self.count * (self.count - 1)))

    def image_error(self) -> Image:
        return np.std(self.image_means, axis=0, ddof=1) / np.sqrt(self.count)


def converge(estimator: Estimator, goal: Goal, report: Callable[[Progress], None] | None = None) -> Estimate:
    """Run passes until the goal is met or the time is up.

    Raises
    ------
    InputError
        An estimate is not finite, or is zero everywhere.
    """
    begin = time.perf_counter()
    running = {layer: _Running() for layer in estimator.layers}
    decisive = running[estimator.layers[0]]
    passes, reached = 0, False
    while True:
        for layer, image in estimator.one_pass(seed=passes).items():
            _check_finite(layer, image)
            running[layer].add(image)
        passes += 1
        seconds = time.perf_counter() - begin
        if passes < 2:
            continue
        present = relative_error(decisive.mean, decisive.standard_error())
        if report:
            # the error falls with the square root of the number of passes
            needed = max(FEWEST_PASSES, passes * (present / goal.rel_error) ** 2)
            left = min(seconds * (needed / passes - 1), goal.time_limit - seconds)
            report(Progress(passes, present, seconds, max(left, 0.0)))
        reached = passes >= FEWEST_PASSES and present <= goal.rel_error
        if reached or (seconds > goal.time_limit and passes >= FEWEST_IN_TIME):
            break
    fixed = estimator.fixed()
    for layer, image in fixed.items():
        _check_finite(layer, image)
    nothing = {layer: np.zeros_like(image) for layer, image in fixed.items()}
    return Estimate(
        mean={layer: r.mean for layer, r in running.items()} | fixed,
        standard_error={layer: r.standard_error() for layer, r in running.items()} | nothing,
        image_mean={layer: r.mean.mean(axis=(0, 1)) for layer, r in running.items()}
        | {layer: image.mean(axis=(0, 1)) for layer, image in fixed.items()},
        image_error={layer: r.image_error() for layer, r in running.items()} | {layer: np.zeros(3) for layer in fixed},
        passes=passes,
        rel_error=present,
        reached=reached,
        seconds=time.perf_counter() - begin,
    )


def relative_error(mean: Image, standard_error: Image) -> float:
    """Standard error over mean at the 95th percentile of the pixels and channels that are lit; see `darkest`.

    Raises
    ------
    InputError
        The image is zero everywhere.
    """
    floor = darkest(mean)
    if floor == 0:
        raise InputError(
            "The reference is zero everywhere: the camera sees no fog that light reaches, the fog scatters none "
            "(albedo or sigma_t is 0), or it lets none through (sigma_t is too large for these distances)."
        )
    lit = mean > 0
    return float(np.percentile(standard_error[lit] / np.maximum(mean[lit], floor), PERCENTILE))


def _check_finite(layer: str, image: Image) -> None:
    if not np.isfinite(image).all():
        raise InputError(
            f"The reference's layer '{layer}' has pixels that are not finite; is a light inside a surface?"
        )
