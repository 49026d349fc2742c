"""A committed reference held against a new estimate with other random numbers.

The tests are those of `reference.agreement`, of pixels, tiles and the image mean: each raises a false alarm once in
10,000 runs, all three together in 3,300 or more.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from experiments.gate.references import GOAL, load_reference, reference_path
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
# of float32 arithmetic that another compiler orders otherwise; measured between Dr.Jit's kernels of one machine: 0
SURFACES = 1e-5


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
    surface : float         largest relative difference of the surfaces, which have no noise
    """

    reference: str
    comparison: Comparison | None
    surface: float = 0.0
    reason: str = ""

    @property
    def agrees(self) -> bool:
        """Whether no test says otherwise."""
        return self.comparison is None or (self.comparison.agrees and self.surface <= SURFACES)

    def __str__(self) -> str:
        """One sentence."""
        if self.comparison is None:
            return f"{self.reference} is not estimated anew: {self.reason}"
        power = self.comparison.verdicts[2].power
        if self.agrees:
            return (
                f"{self.reference}, estimated anew, agrees; a bias of {power:.2%} of the image mean would have been "
                "caught with a probability of 95 %"
            )
        scores = ", ".join(
            f"{one.test} {abs(one.largest):.1f} (at most {one.critical:.1f})"
            for one in self.comparison.verdicts
            if not one.agrees
        )
        surface = f"surfaces differ by {self.surface:.1e} (at most {SURFACES:.0e})" if self.surface > SURFACES else ""
        return (
            f"{self.reference} does not agree with what this machine's Mitsuba estimates now, in standard errors: "
            f"{'; '.join(filter(None, (scores, surface)))}"
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
    surfaces = committed.mean["surface"], again.mean["surface"]
    largest = max(float(surfaces[1].max()), 1e-30)
    return Agreement(name, compare(new, old), float(abs(surfaces[0] - surfaces[1]).max()) / largest)
