"""How accurate a reference is asked for; apart from the estimators, so that asking does not load Mitsuba."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from scenes.errors import InputError

PixelFilter = Literal["centre", "box"]
# An error bar from few passes is itself uncertain. From 32, |z| > 4 by chance is a matter of 4e-4 (Student's t); from 8
# it would be 5e-3, and every large image would seem to disagree somewhere.
FEWEST_PASSES = 32
# a limit stops earlier, with the error bar that there is
FEWEST_IN_LIMIT = 8


@dataclass(frozen=True)
class Goal:
    """When to stop.

    Attributes
    ----------
    rel_error : float             standard error relative to the pixel ...
    percentile : float            ... at this percentile of lit pixels and channels
    time_limit : float            [s]; checked after each pass from the eighth on
    sample_limit : int or None    samples a pixel, on average over the image, that are not exceeded but by the pilot's
    """

    rel_error: float = 0.005
    time_limit: float = 600.0
    percentile: float = 95.0
    sample_limit: int | None = None

    def __post_init__(self) -> None:
        """Refuse goals that cannot be meant."""
        if not 0 < self.rel_error < 1:
            raise InputError(f"The relative error asked for is {self.rel_error}; use a number between 0 and 1.")
        if not 0 < self.percentile <= 100:
            raise InputError(f"The percentile asked for is {self.percentile}; use a number above 0 and at most 100.")
        if not self.time_limit > 0:
            raise InputError(f"The time limit is {self.time_limit} s; use a positive number.")
        if self.sample_limit is not None and self.sample_limit < FEWEST_IN_LIMIT:
            raise InputError(
                f"The sample limit is {self.sample_limit}; use at least {FEWEST_IN_LIMIT}: fewer give no error bar."
            )
