"""A claim of the thesis, how it is tested, and the rule that makes a verdict of what was measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from experiments.figures.stage import Stage

# the scenes of Figures 5.1 and 5.2 and of Table 5.1
SCENES = ("donut_dragon", "dragon", "yeahright", "many_objects")
# samples a ray, for all that are compared
SAMPLES = 64


class Verdict(StrEnum):
    """What became of a claim."""

    REPRODUCED = "reproduced"
    WITH_THE_REPAIR = "reproduced with the repair"
    NOT = "not reproduced"


@dataclass(frozen=True)
class Finding:
    """What was measured of a claim.

    Attributes
    ----------
    measured : str       in words, with the numbers and how sure they are
    as_printed : bool    whether the thesis's own equations and algorithms keep the claim, by its stated rule
    repaired : bool      whether the repaired ones do
    """

    measured: str
    as_printed: bool
    repaired: bool

    @property
    def verdict(self) -> Verdict:
        """By the two answers alone."""
        if self.as_printed:
            return Verdict.REPRODUCED
        return Verdict.WITH_THE_REPAIR if self.repaired else Verdict.NOT


@dataclass(frozen=True)
class Claim:
    """One claim.

    Attributes
    ----------
    words : str        the thesis's, or near them
    pages : str        of the thesis
    test : str         how it is tested, and the rule of the verdict
    figure : str       number of the figure that shows it; empty for none
    measure : callable
    """

    words: str
    pages: str
    test: str
    figure: str
    measure: Callable[[Stage], Finding]


def listed(values: dict[str, str]) -> str:
    """Names with what was found of each, in one line."""
    return "; ".join(f"{name} {value}" for name, value in values.items())
