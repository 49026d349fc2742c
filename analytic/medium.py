"""Homogeneous participating media: what they scatter, what they let through."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.inputs import real_array

__all__ = ["Medium", "transmittance"]


@dataclass(frozen=True, eq=False)
class Medium:
    """A homogeneous medium.

    Attributes
    ----------
    sigma_s : ndarray, () or (3,)  scattering coefficient [1 / scene unit]
    sigma_t : ndarray, () or (3,)  extinction coefficient [1 / scene unit], absorption included

    A scalar beside an RGB triple is repeated; both are kept as read-only float64 arrays of one shape.

    Raises
    ------
    ValueError
        If a coefficient is negative, infinite, NaN or not a scalar or RGB, or if sigma_s exceeds sigma_t.

    Source: Weng 2010, Eqs. 2 to 5; its kappa_s and kappa_t of Eq. 14.
    """

    sigma_s: NDArray[np.float64]
    sigma_t: NDArray[np.float64]

    def __init__(self, sigma_s: ArrayLike, sigma_t: ArrayLike) -> None:
        scattering, extinction = np.broadcast_arrays(_coefficient("sigma_s", sigma_s), _coefficient("sigma_t", sigma_t))
        if np.any(scattering > extinction):
            raise ValueError(f"sigma_s must not exceed sigma_t: {scattering} > {extinction}")
        for name, value in (("sigma_s", scattering), ("sigma_t", extinction)):
            value = value.copy()
            value.setflags(write=False)
            object.__setattr__(self, name, value)

    @classmethod
    def from_albedo(cls, albedo: ArrayLike, sigma_t: ArrayLike) -> Medium:
        """Make a medium of single-scattering albedo sigma_s / sigma_t.

        Parameters
        ----------
        albedo : array_like, () or (3,)   share of the extinction that is scattering, 0 to 1
        sigma_t : array_like, () or (3,)  extinction coefficient [1 / scene unit]

        Raises
        ------
        ValueError
            If the albedo is outside 0 to 1 or NaN, or sigma_t is negative, infinite or NaN.
        """
        share = _coefficient("albedo", albedo)
        if np.any(share > 1):
            raise ValueError(f"albedo must lie between 0 and 1: {share}")
        extinction = _coefficient("sigma_t", sigma_t)
        return cls(share * extinction, extinction)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Medium):
            return NotImplemented
        return np.array_equal(self.sigma_s, other.sigma_s) and np.array_equal(self.sigma_t, other.sigma_t)

    def __hash__(self) -> int:
        return hash((tuple(self.sigma_s.flat), tuple(self.sigma_t.flat)))

    @property
    def albedo(self) -> NDArray[np.float64]:
        """sigma_s / sigma_t, () or (3,); 0 where the medium is clear."""
        return np.divide(self.sigma_s, self.sigma_t, out=np.zeros_like(self.sigma_t), where=self.sigma_t > 0)


def _coefficient(name: str, value: ArrayLike) -> NDArray[np.float64]:
    array = real_array(name, value)
    if array.shape not in ((), (3,)):
        raise ValueError(f"{name} must be a scalar or an RGB triple, not of shape {array.shape}")
    if not np.all(np.isfinite(array)) or np.any(array < 0):
        raise ValueError(f"{name} must be finite and not negative: {array}")
    return array


def transmittance(sigma_t: ArrayLike, distance: ArrayLike) -> NDArray[np.float64]:
    """Fraction of light that crosses `distance` of a homogeneous medium (Beer-Lambert).

    Parameters
    ----------
    sigma_t : array_like, (...)   extinction coefficient [1 / scene unit]
    distance : array_like, (...)  length of the path [scene unit], may be inf; broadcasts with sigma_t

    Returns
    -------
    ndarray, (...)  1 where sigma_t is 0, however long the path

    Raises
    ------
    ValueError
        If sigma_t or distance is negative or NaN, or sigma_t infinite.

    Source: Weng 2010, Eqs. 2 and 5 with beta_ex = beta_ab + beta_sc.
    """
    extinction, length = real_array("sigma_t", sigma_t), real_array("distance", distance)
    if not (np.all(extinction >= 0) and np.all(np.isfinite(extinction))):
        raise ValueError("sigma_t must be finite and not negative")
    if not np.all(length >= 0):
        raise ValueError("distance must not be negative or NaN")
    with np.errstate(invalid="ignore"):
        depth = np.where(extinction == 0, 0.0, extinction * length)
    return np.exp(-depth)
