"""How accurate a reference is asked for; apart from the estimators, so that asking does not load Mitsuba."""

from __future__ import annotations

from dataclasses import dataclass

from scenes.errors import InputError


@dataclass(frozen=True)
class Goal:
    """When to stop.

    Attributes
    ----------
    rel_error : float      standard error relative to the pixel, at the 95th percentile of lit pixels
    time_limit : float     [s]; checked after each pass from the eighth on
    """

    rel_error: float = 0.005
    time_limit: float = 600.0

    def __post_init__(self) -> None:
        """Refuse goals that cannot be meant."""
        if not 0 < self.rel_error < 1:
            raise InputError(f"The relative error asked for is {self.rel_error}; use a number between 0 and 1.")
        if not self.time_limit > 0:
            raise InputError(f"The time limit is {self.time_limit} s; use a positive number.")
