"""What is known of an airlight model.

Where a model's `domain` speaks of visible segments, they are those in which the light is at an optical depth of at most
12 from the eye; of which draw, the model's module says. `results/atlas` has all models on one grid of segments.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.phase import Phase

__all__ = ["AirlightModel", "by_name"]


@dataclass(frozen=True)
class AirlightModel:
    """A model and its record.

    Attributes
    ----------
    name : str           author and year where published; what follows a colon is a variant of it
    function : callable  (segments, phase, **options) -> L / (I sigma_s) [1 / (sr scene unit)], (n,), for `Segments` of
        n pieces, in their floating-point type
    citation : str       where it comes from
    domain : str         where it is valid, and how accurate it is there
    cost : str           evaluations a segment
    phases : tuple of str  names of the phase functions that it takes; empty means every one
    """

    name: str
    function: Callable[..., NDArray[np.floating]]
    citation: str
    domain: str
    cost: str
    phases: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.phases, tuple):
            raise TypeError(f"phases must be a tuple of names, also where there is one: {self.phases!r}")

    def __str__(self) -> str:
        served = ", ".join(self.phases) or "every phase function"
        return f"{self.name} ({served})\n  {self.citation}\n  {self.domain}\n  cost: {self.cost}"

    def takes(self, phase: Phase) -> bool:
        """Whether the model serves that phase function."""
        return not self.phases or phase.name in self.phases


def by_name(*models: AirlightModel) -> dict[str, AirlightModel]:
    """Models by their names, of which no two are the same."""
    named = {model.name: model for model in models}
    if len(named) != len(models):
        raise ValueError(f"two models have one name: {', '.join(model.name for model in models)}")
    return named
