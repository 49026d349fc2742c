"""A committed reference held against a new estimate with other random numbers.

The tests are those of `reference.agreement`, of pixels, tiles and the image mean: each raises a false alarm at most
once in 10,000 runs, so that all three together do at most once in 3,300. Surfaces have no noise, and a test of their
own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from experiments.gate.references import GOAL, RENEW, load_reference, reference_path
from experiments.gate.surfaces import Surfaces, compare_surfaces
from reference.agreement.comparison import Comparison, compare
from reference.agreement.measured import witness
from reference.agreement.unseen import Unseen, unseen_variance
from reference.agreement.witnesses import EquiangularWitness
from reference.convergence import converge
from reference.integrator import mi
from reference.moments import Image
from scenes.model import Scene

# seeds of a new estimate's passes begin here or later, far from those of the committed one and of the pilot
FIRST_SEED, LAST_SEED = 1 << 21, 1 << 30
# the largest relative bias of the image mean that may go uncaught: what would hide a larger one tests nothing. Measured
# on the committed references: at most 3.4e-4, on `sphere` with hg 0.6
WEAKEST = 1e-3


class OtherNumbers(EquiangularWitness):
    """The estimator of the committed references with the seeds from `first` on."""

    def __init__(self, scene: Scene, first: int) -> None:
        super().__init__(scene)
        self._first = first

    def one_pass(self, seed: int) -> dict[str, Image]:
        """Airlight along each ray."""
        return super().one_pass(self._first + seed)


@dataclass(frozen=True)
class Agreement:
    """What the tests said of one committed reference.

    Attributes
    ----------
    reference : str         name of the file without its ending
    comparison : Comparison or None    None where this machine cannot estimate one, and `reason` says why
    surfaces : Surfaces or None        likewise
    """

    reference: str
    comparison: Comparison | None
    surfaces: Surfaces | None = None
    reason: str = ""

    @property
    def agrees(self) -> bool:
        """Whether no test says otherwise, and they could have; or whether there was none."""
        if self.comparison is None or self.surfaces is None:
            return True
        return self.comparison.agrees and self.power <= WEAKEST and self.surfaces.agree

    @property
    def power(self) -> float:
        """The least relative bias of the image mean that would have been caught with a probability of 95 %."""
        return self.comparison.verdicts[2].power if self.comparison else math.inf

    def __str__(self) -> str:
        """One sentence."""
        if self.comparison is None or self.surfaces is None:
            return f"{self.reference} is not estimated anew: {self.reason}"
        if self.agrees:
            return (
                f"{self.reference}, estimated anew, agrees; a bias of {self.power:.2%} of the image mean would have "
                "been caught with a probability of 95 %"
            )
        reasons = [
            f"{one.test} {abs(one.largest):.1f} standard errors apart (at most {one.critical:.1f})"
            for one in self.comparison.verdicts
            if not one.agrees
        ]
        if not self.power <= WEAKEST:
            reasons.append(f"errors so large that a bias of {self.power:.2%} goes uncaught (at most {WEAKEST:.2%})")
        if not self.surfaces.agree:
            reasons.append(str(self.surfaces))
        return (
            f"{self.reference} does not agree with what this machine's Mitsuba estimates now: {'; '.join(reasons)}; "
            f"where the new one is right, {RENEW}"
        )


def check_reference(folder: Path, scene: Scene, first_seed: int) -> Agreement:
    """Estimate a committed reference anew, with seeds from `first_seed` on, and compare.

    Raises
    ------
    InputError
        The reference is missing, damaged or stale.
    """
    name, committed = reference_path(folder, scene).stem, load_reference(folder, scene).estimate
    if mi.variant() == "scalar_rgb":
        return Agreement(name, None, reason="scalar_rgb averages over pixels, and it holds values at their centres")
    again = converge(OtherNumbers(scene, first_seed), GOAL)
    brightest = Unseen(scene).equiangular
    old, new = (
        witness(text, one, unseen_variance(brightest, one.samples * one.passes))
        for text, one in (("committed", committed), ("estimated anew", again))
    )
    return Agreement(name, compare(new, old), compare_surfaces(committed.mean["surface"], again.mean["surface"]))
