"""How surprising a difference is, and how small a bias would have been caught: Student's t on the scale of a Gaussian.

An error bar from n passes is itself uncertain, so a difference in error bars follows Student's t. It is mapped to the
Gaussian score with the same tail, which makes scores of different numbers of passes comparable; a family of m of them
is tested at the significance of one test by the correction of Sidak. That rests on passes whose means are near a
Gaussian: of 32 exponential ones, the test of the pixels raised an alarm 46 % of the time for 5 %.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import betaln, log_ndtr, ndtri_exp, stdtr, stdtrit

# A family of scores that agree fails once in 10,000 tests: eleven scenes, six phase functions, three pairs and three
# tests are 594 of them, of which one fails by chance in 6 % of the whole runs.
SIGNIFICANCE = 1e-4
# of catching the bias that a test says it would catch
POWER = 0.95
# beyond it Student's t is a Gaussian to float64's last digits, and scipy's inverse loses its own
MOST_DOF = 1e8
# of a score's spread where nothing is sampled: narrow, and no division by zero
NARROWEST = 1e-12
# below it the tail's logarithm comes from its leading term
SMALLEST_TAIL = 1e-290

Array = NDArray[np.float64]


def gaussian_score(t: ArrayLike, dof: ArrayLike) -> Array:
    """Gaussian score with the tail that Student's t has beyond `t`.

    Parameters
    ----------
    t : array_like, (...)     difference over its standard error
    dof : array_like, (...)   degrees of freedom; infinite where the error is known

    Returns
    -------
    ndarray, (...)   finite for every finite t: where the tail leaves float64, its logarithm is that of the leading term
                     x^a / (2 a B(a, 1/2) sqrt(1 - x)), a = nu / 2, x = nu / (nu + t^2)
    """
    t, dof = np.broadcast_arrays(np.asarray(t, float), np.asarray(dof, float))
    size, exact = np.abs(t), np.isinf(dof)
    nu = np.where(exact, 1.0, np.minimum(dof, MOST_DOF))
    tail = stdtr(nu, -size)
    # by hypot: the square of a large t leaves float64
    log_x = -2 * np.log(np.hypot(1, size / np.sqrt(nu)))
    with np.errstate(divide="ignore"):
        leading = 0.5 * nu * log_x - np.log(nu) - betaln(0.5 * nu, 0.5) - 0.5 * np.log(-np.expm1(log_x))
        log_tail = np.where(tail > SMALLEST_TAIL, np.log(tail), leading)
    score = -ndtri_exp(log_tail)
    return np.where(exact, t, np.copysign(score, t))


def critical_score(count: int) -> float:
    """Score that the largest of `count` independent ones exceeds with the probability SIGNIFICANCE (Sidak 1967)."""
    return float(-ndtri_exp(np.log(_tail(count))))


def _tail(count: int) -> float:
    """Probability of either tail of one score among `count`."""
    return float(-np.expm1(np.log1p(-SIGNIFICANCE) / count)) / 2


def smallest_bias(mean: Array, error: Array, dof: Array, count: int, sampled: ArrayLike = 1.0) -> float:
    """Smallest factor - 1 on every place of the image that the test of a family catches with the probability POWER.

    Parameters
    ----------
    mean, error, dof : (n,)   places whose scores are independent
    count : int               size of the family that the critical score is made for, n or more
    sampled : (n,)            share of the error that is the spread of samples, from 0 to 1; the rest is an allowance,
                              which raises what a difference must exceed and never helps it to

    Returns
    -------
    float   infinite where no bias would be caught. With one place of known error it is
            (critical score + 1.645 sampled) error / mean. It rests on the errors as they were estimated: in a
            simulation with 32 passes and errors from 0.04 to 3 of the mean, the bias that 240 pixels promise to catch
            was caught 89 % of the time, 1.05 times it 95 %.
    """
    # Student's t under a shift: Johnson and Welch's (1940) approximation of its tail
    nu = np.minimum(dof, MOST_DOF)
    critical = -stdtrit(nu, _tail(count))
    width = np.sqrt(np.maximum(np.square(sampled), NARROWEST) + critical**2 / (2 * nu))
    shrunk = critical * (1 - 1 / (4 * nu))

    def missed(bias: float) -> float:
        """Log of the probability that no place exceeds its critical value, on the side of the bias."""
        return float(log_ndtr((shrunk - bias * np.abs(mean) / error) / width).sum())

    low, high = 1e-15, 1e15
    if not missed(high) < np.log(1 - POWER):
        return float("inf")
    while high / low > 1 + 1e-6:
        middle = np.sqrt(low * high)
        low, high = (low, middle) if missed(middle) < np.log(1 - POWER) else (middle, high)
    return float(high)
