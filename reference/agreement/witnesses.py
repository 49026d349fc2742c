"""Three witnesses of a scene and what each pair says: the main estimator, the deterministic mode, `volpath`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from reference.agreement.comparison import Comparison, compare
from reference.agreement.measured import Witness, witness
from reference.agreement.rim import rim_variance
from reference.agreement.surfaces import Surfaces, compare_surfaces
from reference.agreement.unseen import Unseen, unprobed_variance, unseen_variance
from reference.agreement.volpath import estimate_volpath, image_mean_error
from reference.checks.why_black import why_black
from reference.convergence import Estimate, Progress, converge
from reference.deterministic import Deterministic
from reference.estimators import Equiangular, Volpath
from reference.goal import Goal
from reference.integrator import mi
from reference.moments import BlackReferenceError, Image
from scenes.errors import InputError
from scenes.model import Scene

Report = Callable[[str, Progress], None]

# relative bias of the image mean that the comparison with volpath is to catch
IMAGE_POWER = 1e-3
# of it that volpath may use up by itself; the others know the image mean to a power of 0.015 % or better
VOLPATH_SHARE = 0.97
# of the main estimator's pixels, so that nearly all of a difference's error is volpath's
REL_ERROR = 1e-3
# strata of a pixel in a pass: what 32 passes of them may not have met is 4e-4 of the brightest sample
FEWEST_STRATA = 256
# steps between the deterministic mode's probes, at first sixteen times as many as by default: the picture is small
PROBES = (8192, 16384, 32768)
# [s] for the main estimator; measured on the shipped scenes at 64 x 64: 2 to 41, the most on `wire_mesh`
LONGEST = 120.0


class EquiangularWitness(Equiangular):
    """The main estimator with enough strata that little can have been missed.

    Parameters
    ----------
    plugin : str    the integrator, `single_scattering` or what imitates or spoils it
    """

    def __init__(self, scene: Scene, plugin: str = "single_scattering") -> None:
        super().__init__(scene)
        self.integrator = mi.load_dict({"type": plugin})

    def plan(self, goal: Goal) -> float:
        """Never fewer than FEWEST_STRATA."""
        planned_for = super().plan(goal)
        self.samples = np.maximum(self.samples, np.uint32(FEWEST_STRATA))
        return planned_for


@dataclass(frozen=True)
class Witnesses:
    """All that testifies to a scene.

    Attributes
    ----------
    airlight : tuple of Witness     the main estimator and the deterministic mode, of the scattering layer
    composite : tuple of Witness    the same two under `volpath`'s convention, and `volpath`; of all light
    surface_as_volpath : (H, W, 3)  the surfaces in them
    surfaces : Surfaces             the shipped ones held against them
    unseen : Unseen
    doubt : (H, W, 3)               variance of the deterministic mode for what it or float32 cannot know
    convention_shift : float        what that convention adds to the image mean, relative
    volpath_error : float           standard error of volpath's image mean, relative; infinite where it met no light
    volpath_samples : int           of each pixel
    seconds : dict                  that each witness took
    """

    airlight: tuple[Witness, Witness]
    composite: tuple[Witness, Witness, Witness]
    surface_as_volpath: Image
    surfaces: Surfaces
    unseen: Unseen
    doubt: Image
    convention_shift: float
    volpath_error: float
    volpath_samples: int
    seconds: dict[str, float]

    def comparisons(self) -> tuple[Comparison, ...]:
        """Each pair."""
        ours, exact, theirs = self.composite
        return compare(*self.airlight), compare(ours, theirs), compare(exact, theirs)


def call_witnesses(scene: Scene, time_limit: float, report: Report | None = None) -> Witnesses:
    """Estimate a scene three times.

    Parameters
    ----------
    time_limit : float    [s]; for `volpath`, which else goes on until a bias of the image mean of 0.1 % would show
    report : callable     told which witness is at work, and how far it is

    Raises
    ------
    InputError
        In scalar_rgb; or an estimate is not finite, or one but volpath's is zero everywhere.
    """
    if mi.variant() == "scalar_rgb":
        raise InputError(
            "The witnesses are compared in an LLVM or CUDA variant of Mitsuba, and in scalar_rgb the reference is "
            "volpath itself: `airlight doctor` says what is missing."
        )
    try:
        ours, surface = estimate_equiangular(scene, "single_scattering", report)
    except BlackReferenceError as error:
        raise InputError(f"{error} {why_black(scene)}") from None
    short, short_surface = estimate_equiangular(scene, "single_scattering_as_volpath", report)
    exact = estimate_deterministic(scene)
    exact_short = estimate_deterministic(scene, 1 - mi.math.ShadowEpsilon)
    volpath = estimate_volpath(scene, VOLPATH_SHARE * IMAGE_POWER, time_limit, _named("volpath", report))
    unseen = Unseen(scene)
    main = (unseen_variance(unseen.equiangular, estimate.samples * estimate.passes) for estimate in (ours, short))
    # what float32 makes of a rim is in both of Mitsuba's estimators alike, so it counts on the other side
    between = unprobed_variance(unseen.even, exact.samples) + rim_variance(scene)
    rare = unseen_variance(unseen.volpath, int(volpath.samples.mean()) * volpath.passes)
    before, after = (
        float(image.mean() + e.image_mean["scattering"].mean())
        for image, e in ((surface, ours), (short_surface, short))
    )
    return Witnesses(
        airlight=(witness(Equiangular.name, ours, next(main)), witness(Deterministic.name, exact, between)),
        composite=(
            witness(Equiangular.name, short, next(main), short_surface),
            witness(Deterministic.name, exact_short, between, short_surface),
            witness(Volpath.name, volpath, rare),
        ),
        surface_as_volpath=short_surface,
        surfaces=compare_surfaces(scene, surface, short_surface),
        unseen=unseen,
        doubt=between,
        convention_shift=after / before - 1,
        volpath_error=image_mean_error(volpath),
        volpath_samples=int(volpath.samples.mean()) * volpath.passes,
        seconds={"equiangular": ours.seconds, "deterministic": exact.seconds, "volpath": volpath.seconds},
    )


def estimate_equiangular(scene: Scene, plugin: str, report: Report | None = None) -> tuple[Estimate, Image]:
    """Run the main estimator with an integrator.

    Returns
    -------
    estimate : Estimate
    surface : (H, W, 3)    its exact layer
    """
    estimate = converge(
        EquiangularWitness(scene, plugin), Goal(rel_error=REL_ERROR, time_limit=LONGEST), _named("equiangular", report)
    )
    return estimate, estimate.mean["surface"]


def estimate_deterministic(scene: Scene, light_share: float = 1.0) -> Estimate:
    """Run the deterministic mode with more probes than by default."""
    return Deterministic(scene, light_share, PROBES).estimate()


def _named(name: str, report: Report | None) -> Callable[[Progress], None] | None:
    return (lambda progress: report(name, progress)) if report else None
