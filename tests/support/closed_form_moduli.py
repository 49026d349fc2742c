"""How large the terms are whose sum a closed form is: what rounding errors are in proportion to."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from analytic import MODELS
from analytic.models import sun2005
from analytic.models.weng2010.antiderivatives import i_pair, real_ei
from analytic.models.weng2010.polynomials import near_minimax, taylor
from analytic.phase import Phase
from analytic.segments import Segments

EVEN = (1 / (4 * np.pi),)


def rounding_unit(name: str, phase: Phase, segments: Segments, t0: np.ndarray | float = 0.0) -> np.ndarray:
    """What float32 may be off by for each unit of a form's own conditioning, (n,): 2^-24 of its terms, times depths.

    Parameters
    ----------
    name : str           a closed form of `analytic.MODELS`
    segments : Segments  of float64, (n,)
    t0 : ndarray, (n,)   how far from the eye each begins, whose transmittance is left out
    """
    s = segments
    depth = 1 + s.optical_h + s.sigma_t * (np.abs(s.x_a) + t0)
    if name == "weng2010:printed":
        # Ei of a large number, and the cancellation of u +- sqrt(1 + u^2)
        depth += s.sigma_t * s.length + s.optical_h * s.v_b * (phase.name == "isotropic")
        depth *= 1 + (s.x_a / s.h) ** 2 + (s.x_b / s.h) ** 2
    return 2**-24 * depth * moduli(name, phase, s)


def moduli(name: str, phase: Phase, segments: Segments) -> np.ndarray:
    """Sum of the moduli of a model's terms for segments of float64, (n,), in the units of its result."""
    with np.errstate(all="ignore"):
        if name in ("weng2010", "one_ei"):
            return _of_two_terms(name, phase, segments)
        if name.startswith("sun2005"):
            return _of_two_reads(segments)
        if name.endswith("-ei") or phase.name == "isotropic":
            coefficients = EVEN, EVEN
        else:
            coefficients = (near_minimax if name.endswith("minimax") else taylor)(phase, 5)
        return (_printed if name.endswith("printed") else _repaired)(segments, *coefficients)


def _of_two_terms(name: str, phase: Phase, s: Segments) -> np.ndarray:
    # to the end of the world there is but the near term; the far one is what is missing
    endless = Segments(s.h, s.x_a, np.full_like(s.h, np.inf), np.full_like(s.h, np.inf), s.sigma_t)
    near, value = (MODELS[name].function(given, phase) for given in (endless, s))
    # Schlick's two terms are larger than their sum (the model's `domain`)
    k = abs(getattr(phase, "k", 0.0))
    return (2 * near - value) * (1 + (1 + k) / (2 - 2 * k) if k else 1)


def _of_two_reads(s: Segments) -> np.ndarray:
    # of the function that is tabulated: what a table makes of it is as large
    ends = sum(sun2005.f(s.optical_h, np.arctan2(s.h, -x) / 2) for x in (s.x_a, s.x_b))
    return np.exp(s.sigma_t * s.x_a) * ends / (2 * np.pi * s.h)


def _repaired(s: Segments, front: Sequence[float], back: Sequence[float]) -> np.ndarray:
    h, one = s.optical_h, np.ones_like(s.h)
    before, behind = s.x_b <= 0, s.x_a >= 0
    first = _front(front, h, s.v_a, np.minimum(s.v_b, 1))
    w_a, w_b = -1 / np.maximum(s.v_a, one), -1 / s.v_b
    second = _back(back, h, w_a, w_b, lambda w, j: np.exp(h / w) * np.abs(w) ** (j + 1))
    return 2 * np.exp(s.sigma_t * s.x_a) / s.h * (np.where(behind, 0, first) + np.where(before, 0, second))


def _printed(s: Segments, front: Sequence[float], back: Sequence[float]) -> np.ndarray:
    h, one, level = s.optical_h, np.ones_like(s.h), len(front) == 1
    before, behind = s.x_b <= 0, s.x_a >= 0

    def inside_the_exponent(w: np.ndarray, j: int) -> np.ndarray:
        return np.exp(h / w * w ** (j + 1))

    faded = np.exp(-s.sigma_t * s.length)
    # of Eq. 27's j_0(-H, w): Ei on the side where it grows
    opposite = back[0] * (_modulus(-h, -s.v_a) + _modulus(-h, -s.v_b)) * faded
    grown = np.exp(s.sigma_t * s.x_a) * _back(back, h, -1 / s.v_a, -1 / s.v_b, inside_the_exponent)
    around = _back(back, h, -one, -1 / s.v_b, inside_the_exponent) * (np.exp(-s.sigma_t * s.x_b) if level else 1)
    around += np.exp(-s.sigma_t * s.x_a) * _front(front, h, s.v_a, one)
    ahead = faded * _front(front, h, s.v_a, s.v_b)
    return 2 / s.h * np.where(before, ahead, np.where(behind, opposite if level else grown, around))


def _modulus(a: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.hypot(*i_pair(a, v))


def _front(coefficients: Sequence[float], h: np.ndarray, v_a: np.ndarray, v_b: np.ndarray) -> np.ndarray:
    total = np.zeros_like(h)
    for n, c in enumerate(coefficients):
        total += abs(c) * (_modulus(-h, v_a) + _modulus(-h, v_b))
        for j in range(n - 1):
            powers = np.exp(-h * v_a) * v_a**j + np.exp(-h * v_b) * v_b**j
            total += abs(c) * powers * sum(math.perm(i + j, i) * h ** -(i + 1.0) for i in range(n - 1 - j))
    return total


def _back(
    coefficients: Sequence[float],
    h: np.ndarray,
    w_a: np.ndarray,
    w_b: np.ndarray,
    power: Callable[[np.ndarray, int], np.ndarray],
) -> np.ndarray:
    total = np.zeros_like(h)
    real = abs(real_ei(h / w_a, coefficients)) + abs(real_ei(h / w_b, coefficients))
    for n, d in enumerate(coefficients):
        total += abs(d) * (_modulus(-h, -1 / w_a) + _modulus(-h, -1 / w_b) + real)
        for j in range(n - 1):
            series = sum(h**i / math.perm(i + j + 1, i + 1) for i in range(n - 1 - j))
            total += abs(d) * (power(w_a, j) + power(w_b, j) + (h * real if j == 0 else 0)) * series
    return total
