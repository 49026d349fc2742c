"""One scene: the main estimator, `volpath` and what limits the first, in one run."""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiments.benchmark.contenders import AirlightVolpath, unshadowed, with_strata
from experiments.benchmark.efficiency import (
    Array,
    Passes,
    edge_pixels,
    fitted_exponent,
    interleave,
    relative_deviation,
    seconds_as_run,
    seconds_by_variance,
)
from reference.convergence import relative_error
from reference.estimators import Equiangular, Estimator
from reference.goal import FEWEST_PASSES, Goal
from reference.integrator import mi
from reference.moments import Image
from reference.plan import PILOT_PASSES
from scenes.errors import InputError
from scenes.model import Scene

# How many strata to passes with them, fewer where they are dear. Six of one stratum are too few: most of them miss the
# shadow that a rare one meets, and the median error of `yeahright` then grows from one stratum to four.
STRATA = {1: 32, 4: 32, 16: 32, 64: 16, 256: 6}


@dataclass(frozen=True)
class Strata:
    """Passes with as many strata for every pixel.

    Attributes
    ----------
    strata : int
    seconds : float         of a pass
    deviation : (lit,)      relative, of a pass
    """

    strata: int
    seconds: float
    deviation: Array


@dataclass(frozen=True)
class Measurement:
    """What was measured of one scene; `Passes` are all of the airlight.

    Attributes
    ----------
    goal : Goal
    ours, theirs : Passes                 the main estimator as `airlight reference` runs it, and `volpath`
    shadowless : Passes                   ours without shadow rays
    one_stratum : Passes                  ours with one stratum a pixel: next to nothing but what a pass costs anyway
    strata : tuple of Strata
    samples : float                       strata of a pixel in a pass of ours, on average
    volpath_samples : int                 of a pixel in a pass of theirs
    plan_seconds : float                  of ours, before the first pass
    compile_seconds : (float, float)      of ours and theirs: what the first pass took beyond a later one; next to 0
                                          where Dr.Jit's cache on disk had the kernels
    peak_memory : float                   of the process so far, both estimators in it [GB]
    """

    scene: Scene
    goal: Goal
    ours: Passes
    theirs: Passes
    shadowless: Passes
    one_stratum: Passes
    strata: tuple[Strata, ...]
    samples: float
    volpath_samples: int
    plan_seconds: float
    compile_seconds: tuple[float, float]
    peak_memory: float

    @property
    def truth(self) -> Image:
        """What errors are relative to, for both: the airlight by the more accurate one."""
        return self.ours.mean

    def by_variance(self) -> tuple[Array, Array]:
        """Seconds of each lit pixel to the goal by variance x time, of ours and of theirs."""
        return (
            seconds_by_variance(self.ours, self.truth, self.goal.rel_error),
            seconds_by_variance(self.theirs, self.truth, self.goal.rel_error),
        )

    def as_run(self) -> tuple[Array, Array]:
        """Seconds of each lit pixel to the goal in whole passes, the plan included, of ours and of theirs."""
        return (
            seconds_as_run(self.ours, self.truth, self.goal.rel_error, self.plan_seconds),
            seconds_as_run(self.theirs, self.truth, self.goal.rel_error),
        )

    def seconds_to_goal(self) -> float:
        """Seconds until ours stops: until the goal's percentile of lit pixels and channels is as accurate as asked."""
        of_a_pass = relative_error(self.truth, self.ours.deviation, self.goal.percentile)
        needed = max(FEWEST_PASSES, np.ceil((of_a_pass / self.goal.rel_error) ** 2))
        return float(self.plan_seconds + needed * self.ours.typical_seconds)

    def edges(self) -> NDArray[np.bool_]:
        """Which of the lit pixels have an error that shadows set."""
        return edge_pixels(self.ours, self.shadowless, self.truth)

    def exponents(self) -> tuple[float, float, float]:
        """Of the median error of a pass against strata: all lit pixels, those at edges of shadows, the others."""
        strata, edges = np.array([one.strata for one in self.strata], np.float64), self.edges()

        def of(pixels: NDArray[np.bool_]) -> float:
            if not pixels.any():
                return float("nan")
            return fitted_exponent(strata, np.array([np.median(one.deviation[pixels]) for one in self.strata]))

        return of(np.ones_like(edges)), of(edges), of(~edges)

    def time_shares(self) -> tuple[float, float, float]:
        """Of a pass's seconds: shadow rays, eye rays with what a pass costs anyway, and the rest, sampling and fog."""
        whole = self.ours.typical_seconds
        shadows = 1 - self.shadowless.typical_seconds / whole
        fixed = self.one_stratum.typical_seconds / whole
        return shadows, fixed, 1 - shadows - fixed


def measure(scene: Scene, rel_error: float, volpath_spp: int, tell: Callable[[str], None]) -> Measurement:
    """Measure one scene.

    Parameters
    ----------
    scene : Scene          whose surfaces are black afterwards, in Mitsuba
    volpath_spp : int      samples a pixel that `volpath` takes at least
    tell : callable        told what is at work

    Raises
    ------
    InputError
        The goal cannot be meant, or the variant is scalar_rgb, where the reference is `volpath` itself.
    BlackReferenceError
        There is no airlight.
    """
    if mi.variant() == "scalar_rgb":
        raise InputError(
            "The benchmark needs an LLVM or CUDA variant of Mitsuba: in scalar_rgb volpath is all there is."
        )
    goal = Goal(rel_error)
    theirs = AirlightVolpath(scene, -(-volpath_spp // FEWEST_PASSES))
    ours = Equiangular(scene)
    tell("the plan")
    our_first = _seconds(lambda: ours.one_pass(0))
    plan_seconds = _seconds(lambda: ours.plan(goal))
    one_stratum = with_strata(scene, np.ones_like(ours.samples))
    shadowless = unshadowed(ours, scene)
    for estimator in (one_stratum, shadowless):
        estimator.one_pass(0)
    tell("passes of both in turn")
    their_first = _seconds(lambda: theirs.one_pass(0))
    passes = interleave(
        {
            "ours": _layer(ours, "scattering"),
            "theirs": _layer(theirs, "composite"),
            "shadowless": _layer(shadowless, "scattering"),
            "one_stratum": _layer(one_stratum, "scattering"),
        },
        FEWEST_PASSES,
    )
    return Measurement(
        scene=scene,
        goal=goal,
        **passes,
        strata=tuple(_sweep(scene, passes["ours"].mean, tell)),
        samples=float(ours.samples.mean()),
        volpath_samples=theirs.rays_per_pixel,
        plan_seconds=plan_seconds,
        compile_seconds=(
            max(0.0, our_first - plan_seconds / PILOT_PASSES),
            max(0.0, their_first - passes["theirs"].typical_seconds),
        ),
        peak_memory=_peak_memory(),
    )


def _layer(estimator: Estimator, layer: str) -> Callable[[int], Image]:
    return lambda seed: estimator.one_pass(seed)[layer]


def _sweep(scene: Scene, truth: Image, tell: Callable[[str], None]) -> Iterator[Strata]:
    for number, passes in STRATA.items():
        tell(f"{number} strata")
        estimator = with_strata(scene, np.full(truth.shape[:2], number, np.uint32))
        found = interleave({"": _layer(estimator, "scattering")}, passes)[""]
        yield Strata(number, found.typical_seconds, relative_deviation(found, truth))


def _seconds(work: Callable[[], object]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin


def _peak_memory() -> float:
    """Of this process, [GB]."""
    # kilobytes on Linux, bytes on macOS
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit / 1e9
