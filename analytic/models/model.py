"""What is known of an airlight model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.phase import Phase

__all__ = ["AirlightModel"]


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

    def takes(self, phase: Phase) -> bool:
        """Whether the model serves that phase function."""
        return not self.phases or phase.name in self.phases
