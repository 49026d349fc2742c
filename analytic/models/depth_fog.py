"""Fog whose source term is constant along the ray, so that only depth counts, as James 2003 and games have it.

What a unit length of fog at the eye's place sends towards the eye is taken for what it sends from everywhere. A
piece's airlight then depends on where the eye is, and not on the light's place beside the piece: this is no
`AirlightModel`, whose pieces know of the eye by a factor alone, and it stands in no list of theirs. The twin of
gpu_impl/shaders/airlight/depth_fog.glsl.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.inputs import real_array

__all__ = ["depth_fog"]


def depth_fog(source: ArrayLike, sigma_t: ArrayLike, begin: ArrayLike, length: ArrayLike) -> NDArray[np.float64]:
    """Airlight that reaches the eye from [begin, begin + length] of a ray.

    Parameters
    ----------
    source : array_like, (...)   what a unit length of fog sends towards the eye: sigma_s I p(cos theta) e^{-sigma_t d}
        / d^2 of the light at the eye's place [radiance / scene unit]
    sigma_t : array_like, (...)  extinction coefficient [1 / scene unit]
    begin : array_like, (...)    counted from where the ray begins in fog [scene unit]
    length : array_like, (...)   of the piece, may be inf where sigma_t is above 0 [scene unit]

    Returns
    -------
    ndarray, (...)  S e^{-sigma_t begin} (1 - e^{-sigma_t length}) / sigma_t, the limit S length in a clear medium

    Raises
    ------
    ValueError
        If an argument is NaN, or sigma_t or length negative.

    Source: Weng 2010, Eq. 14 with a constant L_i; James 2003.
    """
    given = {"source": source, "sigma_t": sigma_t, "begin": begin, "length": length}
    light, extinction, start, piece = (real_array(name, value) for name, value in given.items())
    for name, value in zip(given, (light, extinction, start, piece), strict=True):
        if np.any(np.isnan(value)):
            raise ValueError(f"{name} must not be NaN")
    for name, value in (("sigma_t", extinction), ("length", piece)):
        if np.any(value < 0):
            raise ValueError(f"{name} must not be negative")
    with np.errstate(invalid="ignore"):
        depth = extinction * piece
        scattered = np.where(extinction > 0, -np.expm1(-depth) / np.where(extinction > 0, extinction, 1), piece)
    return light * np.exp(-extinction * start) * scattered
