"""Values held against their limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from experiments.gate.limits import Limit, Limits
from experiments.gate.measuring import Values


@dataclass(frozen=True)
class Verdict:
    """One value of one case.

    Attributes
    ----------
    case, metric : str
    value : float
    limit : Limit
    """

    case: str
    metric: str
    value: float
    limit: Limit

    @property
    def margins(self) -> float:
        """How many margins the value is above the measured one; negative below it."""
        return (self.value - self.limit.value) / self.limit.margin

    @property
    def badness(self) -> float:
        """Margins in the direction that counts; infinite for what is no number."""
        margins = abs(self.margins) if self.is_two_sided else self.margins
        return math.inf if math.isnan(margins) else margins

    @property
    def is_two_sided(self) -> bool:
        """Whether a lower value is a failure too."""
        return self.metric.endswith("image_mean_rel")

    @property
    def passes(self) -> bool:
        """Whether it keeps its limit; what is no number does not."""
        return self.badness <= 1

    @property
    def is_better(self) -> bool:
        """Whether an error fell by more than its margin."""
        return not self.is_two_sided and self.margins < -1

    def __str__(self) -> str:
        """One sentence: by how much."""
        if math.isnan(self.value):
            return f"{self.case}: {self.metric} is no number, for the picture has pixels that are not finite"
        most = self.limit.value + (self.limit.margin if self.margins > 0 else -self.limit.margin)
        side = "above" if self.margins > 0 else "below"
        return (
            f"{self.case}: {self.metric} is {self.value:.4g}, {side} its limit of {most:.4g}: "
            f"{abs(self.margins):.1f} margins of {self.limit.margin:.2g} from the {self.limit.value:.4g} measured"
        )


def judge(values: Values, limits: Limits) -> list[Verdict]:
    """A verdict for each metric of each case that was measured."""
    return [
        Verdict(case, metric, value, limits[case][metric])
        for case, metrics in values.items()
        for metric, value in metrics.items()
    ]


def worst_of(verdicts: list[Verdict]) -> Mapping[str, Verdict]:
    """Of each case the verdict that is nearest to its limit, or farthest beyond."""
    worst: dict[str, Verdict] = {}
    for one in verdicts:
        before = worst.get(one.case)
        if before is None or one.badness > before.badness:
            worst[one.case] = one
    return worst
