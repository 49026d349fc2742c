"""How a quantity grows: the exponent of a power law along one curve, and its mean over scenes, with their intervals."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from experiments.intervals import CONFIDENCE

# two points lie on a line whatever they are, and say nothing about its slope's error
FEWEST_POINTS = 3
# over less, an exponent is that of the noise: a march of points has nearly as many lit pieces in every grating
LEAST_SPAN = 2.0


@dataclass(frozen=True)
class Fit:
    """The line through points on logarithmic axes, y = factor x^exponent.

    Attributes
    ----------
    exponent : float
    low, high : float    the interval that holds the exponent with probability `CONFIDENCE`
    n : int              how many points it was fitted to
    factor : float       y at x = 1
    """

    exponent: float
    low: float
    high: float
    n: int
    factor: float

    def __call__(self, x: ArrayLike) -> np.ndarray:
        """The law's y at x, both (n,)."""
        return self.factor * np.asarray(x, float) ** self.exponent

    def __str__(self) -> str:
        """The exponent and its interval, for tables."""
        return f"{self.exponent:z.2f} [{self.low:z.2f}, {self.high:z.2f}]"


@dataclass(frozen=True)
class MeanFit:
    """The mean of scenes' exponents.

    Attributes
    ----------
    exponent : float
    low, high : float            of several scenes, the interval that holds the mean over all scenes like them with
                                 probability `CONFIDENCE`; of one, that of the scatter about its own lines
    slopes : tuple of float      each scene's exponent
    n : int                      how many points they were fitted to
    """

    exponent: float
    low: float
    high: float
    slopes: tuple[float, ...]
    n: int

    def __str__(self) -> str:
        """The mean, its interval, and the least and the most of the scenes' exponents, for tables."""
        shown = f"{self.exponent:z.2f} [{self.low:z.2f}, {self.high:z.2f}]"
        if len(self.slopes) == 1:
            return f"{shown} (1 scene, n = {self.n})"
        spread = f"{min(self.slopes):z.2f} to {max(self.slopes):z.2f}"
        return f"{shown}; {spread} ({len(self.slopes)} scenes, n = {self.n})"


def power_law(x: ArrayLike, y: ArrayLike) -> Fit:
    """Fit the slope of log y over log x by least squares; its interval is Student's.

    The interval takes the scatter about the line for independent errors of log y. Where the points bend, it is the
    slope's over the range that was measured, and says nothing beyond; nor does it say anything of another scene.

    Parameters
    ----------
    x, y : (n,)    above 0; n at least `FEWEST_POINTS`

    Raises
    ------
    ValueError
        There are too few points, x grows by less than `LEAST_SPAN`, or a value is not positive and finite.

    Source: Draper and Smith 1998, Applied Regression Analysis, section 1.4.
    """
    x, y = _positive(x, y)
    if len(x) < FEWEST_POINTS:
        raise ValueError(f"x must have {FEWEST_POINTS} values or more, not {len(x)}.")
    if x.max() < LEAST_SPAN * x.min():
        raise ValueError(f"x must grow by a factor of {LEAST_SPAN:g} or more, not {x.max() / x.min():.3g}.")
    log_x, log_y = np.log(x), np.log(y)
    from_mean, freedom = log_x - log_x.mean(), len(x) - 2
    spread = from_mean @ from_mean
    slope = float(from_mean @ log_y / spread)
    residual = log_y - log_y.mean() - slope * from_mean
    reach = _student(freedom) * float(np.sqrt(residual @ residual / freedom / spread))
    return Fit(slope, slope - reach, slope + reach, len(x), float(np.exp(np.mean(log_y - slope * log_x))))


def mean_power_law(x: ArrayLike, y: ArrayLike, scenes: Sequence[Hashable], curves: Sequence[Hashable]) -> MeanFit:
    """Fit each curve's slope, take their mean in each scene, and the mean of the scenes'.

    Scenes grow each in its own way, and the curves of one scene err alike: its phase functions have the same shadows.
    So scenes are what is counted. The interval is Student's over their slopes, each of one weight, and takes the
    scenes for drawn by chance from all that are like them. Of one scene nothing is known about others: there the
    interval is of the scatter about its curves' lines, as in `power_law`, and as wide as if they all erred alike.

    Parameters
    ----------
    x, y : (n,)      above 0
    scenes : (n,)    where a point was measured
    curves : (n,)    points of one scene and one curve share a factor. Curves of fewer points than `FEWEST_POINTS`, or
                     over less than `LEAST_SPAN`, are left out.

    Raises
    ------
    ValueError
        No curve can be fitted, or a value is not positive and finite.

    Source: Student's interval over the experimental units' own statistics: Hurlbert 1984, Pseudoreplication and the
    Design of Ecological Field Experiments.
    """
    x, y = _positive(x, y)
    if not len(x) == len(scenes) == len(curves):
        raise ValueError("x, y, scenes and curves must be lists of one length.")
    places: dict[tuple[Hashable, Hashable], list[int]] = {}
    for place, key in enumerate(zip(scenes, curves, strict=True)):
        places.setdefault(key, []).append(place)
    lines: dict[Hashable, list[Fit]] = {}
    refusal = ValueError(f"x must have {FEWEST_POINTS} values or more, not 0.")
    for (scene, _), found in places.items():
        try:
            line = power_law(x[found], y[found])
        except ValueError as error:
            refusal = error
            continue
        lines.setdefault(scene, []).append(line)
    if not lines:
        raise refusal
    slopes = [float(np.mean([line.exponent for line in mine])) for mine in lines.values()]
    mean, number = float(np.mean(slopes)), len(slopes)
    if number > 1:
        reach = _student(number - 1) * float(np.std(slopes, ddof=1)) / np.sqrt(number)
    else:
        # the standard error of a mean is at most the mean of the standard errors
        (mine,) = lines.values()
        reach = float(np.mean([line.high - line.exponent for line in mine]))
    count = sum(line.n for mine in lines.values() for line in mine)
    return MeanFit(mean, mean - reach, mean + reach, tuple(slopes), count)


def _positive(x: ArrayLike, y: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    x, y = np.asarray(x, float), np.asarray(y, float)
    if x.ndim != 1 or x.shape != y.shape:
        raise ValueError("x and y must be lists of one length.")
    for name, values in (("x", x), ("y", y)):
        if not (np.isfinite(values).all() and (values > 0).all()):
            raise ValueError(f"{name} must be positive and finite: a power law has no other values.")
    return x, y


def _student(freedom: int) -> float:
    """How many standard errors an interval reaches to each side."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, (1 + CONFIDENCE) / 2))
