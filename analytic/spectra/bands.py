"""From a spectrum to linear Rec.709: what three coefficients can keep of a medium.

Light of spectrum E that a path changes by the factor f(lambda) has, relative to itself, the channels

    f_c = sum_i w_c(lambda_i) f(lambda_i),    w_c ~ E (M xbar)_c,    sum_i w_c = 1,

M the matrix from XYZ to linear Rec.709 and xbar the CIE 1931 observer: w_c is the channel's response. Over a distance
d a medium leaves f = e^{-sigma_t d}, and under uniform light scatters sigma_s / sigma_t (1 - e^{-sigma_t d}) towards
the eye. Three coefficients that are to do both right for that d obey

    e^{-sigma_t,c d} = sum_i w_c e^{-sigma_t d},
    sigma_s,c / sigma_t,c (1 - e^{-sigma_t,c d}) = sum_i w_c sigma_s / sigma_t (1 - e^{-sigma_t d}).

That is the projection *matched at d*. For d -> 0 it becomes the *response-weighted mean*, sigma_c = sum_i w_c sigma:
right to the first order in the optical depth, for transmittance and airlight alike, and so for any scene thin enough.
The second order is what it loses. With var_c = sum_i w_c (sigma_t - sigma_c)^2,

    sum_i w_c e^{-sigma_t d} = e^{-sigma_c d} (1 + var_c d^2 / 2 + ...),

three bands are too dark where the w_c are positive: the light that survives is that of the clearest wavelengths.

The responses of Rec.709 have negative lobes, for spectral lights lie outside its gamut. A medium that works mostly in a
lobe has a negative coefficient: light that crosses it gains in that channel. No renderer takes that. It is refused, or
set to zero with its size stated.
"""

from __future__ import annotations

import warnings
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.inputs import real_number
from analytic.medium import Medium
from analytic.spectra.coefficients import checked_coefficients

__all__ = ["CHANNELS", "LUMINANCE", "WAVELENGTHS", "responses", "three_bands"]

CHANNELS = ("red", "green", "blue")
WAVELENGTHS = np.arange(380.0, 781.0, 5.0)  # [nm], (81,): the steps in which CIE 15 tabulates observer and daylight
WAVELENGTHS.setflags(write=False)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # ITU-R BT.709-6, item 3.2
LUMINANCE.setflags(write=False)


def responses(illuminant: str = "D65") -> NDArray[np.float64]:
    """Weights of the wavelengths in the channels of linear Rec.709; each row sums to 1, and has negative entries.

    Parameters
    ----------
    illuminant : str  spectrum of the light, a name in `colour.SDS_ILLUMINANTS`

    Returns
    -------
    ndarray, (3, 81)  at `WAVELENGTHS`, read-only

    Raises
    ------
    ValueError
        If the illuminant is no name, or unknown.

    Source: CIE 15:2018 (tristimulus values by summation); ITU-R BT.709-6, items 1.3 and 1.4 (primaries and white).
    """
    if not isinstance(illuminant, str):
        raise ValueError(f"illuminant must be a name, such as D65 or A: {illuminant!r}")
    return _weights(illuminant)


@cache
def _weights(illuminant: str) -> NDArray[np.float64]:
    import colour

    if illuminant not in colour.SDS_ILLUMINANTS:
        raise ValueError(f"illuminant must be a name that colour-science knows, such as D65 or A: {illuminant!r}")
    light = colour.SDS_ILLUMINANTS[illuminant][WAVELENGTHS]
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"][WAVELENGTHS]
    weights = colour.RGB_COLOURSPACES["ITU-R BT.709"].matrix_XYZ_to_RGB @ (observer.T * light)
    weights /= weights.sum(axis=1, keepdims=True)
    weights.setflags(write=False)
    return weights


def three_bands(
    sigma_s: ArrayLike,
    sigma_t: ArrayLike,
    distance: float = 0.0,
    illuminant: str = "D65",
    clip: bool = False,
) -> Medium:
    """Linear Rec.709 coefficients that are right over `distance`; see the module for their derivation.

    Parameters
    ----------
    sigma_s : array_like, (81,)        scattering coefficient at `WAVELENGTHS` [1 / scene unit]
    sigma_t : array_like, (81,)        extinction coefficient at `WAVELENGTHS` [1 / scene unit]
    distance : float                   where to match [scene unit]; 0 takes the response-weighted mean
    illuminant : str                   spectrum of the light, as for `responses`
    clip : bool                        whether negative scattering or absorption becomes 0, with a warning that says
        how much that was

    Returns
    -------
    Medium  RGB

    Raises
    ------
    ValueError
        If a coefficient is not 81 real numbers, negative, infinite or NaN, or sigma_s exceeds sigma_t; if distance is
        not one number, negative, infinite or NaN; if the illuminant is unknown; if a channel has no light left at that
        distance; or if a channel's scattering or absorption is negative and `clip` is not set.
    """
    scattering, total = checked_coefficients(WAVELENGTHS, sigma_s, sigma_t)
    length = real_number("distance", distance)
    if not (np.isfinite(length) and length >= 0):
        raise ValueError(f"distance must be finite and not negative: {length}")
    weights = responses(illuminant)
    # (1 - e^{-tau}) / tau: each wavelength's loss over the distance, as a share of what it would be without saturation
    depth = total * length
    kept = np.divide(-np.expm1(-depth), depth, out=np.ones_like(depth), where=depth > 0)
    scattered = _not_negative("sigma_s", weights @ (scattering * kept), clip)
    absorbed = _not_negative("sigma_t - sigma_s", weights @ ((total - scattering) * kept), clip)
    lost = scattered + absorbed
    gone = lost * length
    if np.any(gone >= 1):
        dark = " and ".join(name for name, value in zip(CHANNELS, gone, strict=True) if value >= 1)
        raise ValueError(f"distance must be shorter: at {length:g} the light that is left has no {dark} in Rec.709")
    extinction = lost * np.divide(-np.log1p(-gone), gone, out=np.ones(3), where=gone > 0)
    albedo = np.divide(scattered, lost, out=np.zeros(3), where=lost > 0)
    return Medium(albedo * extinction, extinction)


def _not_negative(name: str, bands: NDArray[np.float64], clip: bool) -> NDArray[np.float64]:
    """The bands, (3,), once none is negative; `name` is what they are the bands of."""
    if np.all(bands >= 0):
        return bands
    largest = np.abs(bands).max()
    found = ", ".join(
        f"{-value / largest:.1%} of the largest band in {channel}"
        for channel, value in zip(CHANNELS, bands, strict=True)
        if value < 0
    )
    if not clip:
        raise ValueError(f"{name} must not lie in a negative lobe of Rec.709: it is below 0 by {found}; clip=True cuts")
    warnings.warn(f"{name} was below 0 by {found}, and is 0 there now", stacklevel=4)
    return np.maximum(bands, 0.0)
