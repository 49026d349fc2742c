"""One bias for many cases: what `volpath`'s image means say of the deterministic mode's, taken together.

Known to 0.1 % by itself, a scene of thin shafts costs `volpath` hours; a common bias shows in the mean over all cases.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reference.agreement.comparison import Comparison
from reference.agreement.significance import critical_score, gaussian_score, smallest_bias


@dataclass(frozen=True)
class Pooled:
    """Relative bias of the second witness against the first, the same in all cases.

    Attributes
    ----------
    cases : int
    bias, error : float    weighted mean of the relative differences, and its standard error
    score, critical : float
    power : float          common relative bias that would have been caught with a probability of 95 %
    """

    cases: int
    bias: float
    error: float
    score: float
    critical: float
    power: float

    @property
    def agrees(self) -> bool:
        """Whether the bias may be zero."""
        return abs(self.score) <= self.critical


def pooled(comparisons: Sequence[Comparison]) -> Pooled:
    """Pool the image means of the same pair in several cases, each weighted by its inverse variance.

    The weights are themselves estimates, which makes the naive error of the mean too small: it is multiplied by the
    root of 1 + 4 sum p_i (1 - p_i) / nu_i, p_i the case's share of the weights (Meier 1953, "Variance of a weighted
    mean"), and has 1 / sum (p_i^2 / nu_i) degrees of freedom.

    Raises
    ------
    ValueError
        `comparisons` is empty.
    """
    if not comparisons:
        raise ValueError("comparisons must not be empty")
    differences = [comparison.second.image - comparison.first.image for comparison in comparisons]
    scale = np.array([float(comparison.first.image.mean) for comparison in comparisons])
    values = np.array([float(difference.mean) for difference in differences]) / scale
    variances = np.array([float(difference.variance) for difference in differences]) / scale**2
    dof = np.array([float(difference.dof) for difference in differences])
    share = 1 / variances
    share /= share.sum()
    bias = float(share @ values)
    inflation = 1 + 4 * float((share * (1 - share) / dof).sum())
    error = float(np.sqrt(inflation / (1 / variances).sum()))
    taken_together = np.array(1 / max(float((share**2 / dof).sum()), 1e-300))
    return Pooled(
        cases=len(comparisons),
        bias=bias,
        error=error,
        score=float(gaussian_score(bias / error, taken_together)),
        critical=critical_score(1),
        power=smallest_bias(np.ones(1), np.array([error]), taken_together.reshape(1), count=1),
    )
