"""The airlight of a point light in a homogeneous medium: single scattering along one straight piece of a ray."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from analytic.inputs import real_array
from analytic.medium import Medium
from analytic.models import MODELS, AirlightModel
from analytic.phase import Phase
from analytic.segments import Segments

__all__ = ["MODELS", "AirlightModel", "airlight"]


def airlight(
    h: ArrayLike,
    x_a: ArrayLike,
    x_b: ArrayLike,
    medium: Medium,
    phase: Phase,
    intensity: ArrayLike = 1.0,
    model: str = "quadrature",
    dtype: DTypeLike = np.float64,
    **options: float | None,
) -> NDArray[np.float64]:
    """Radiance that reaches the eye from the light scattered between x_a and x_b.

    Positions are measured along the ray from the light's projection on it, in viewing direction. The attenuation from
    the light to the point and from the point to the eye is included.

    Parameters
    ----------
    h : array_like, (...)          distance of the light from the ray [scene unit]
    x_a : array_like, (...)        the eye, where the segment begins [scene unit]
    x_b : array_like, (...)        where the segment ends, may be inf [scene unit]
    medium : Medium                scalar or RGB
    phase : Phase                  phase function, from `analytic.phase`
    intensity : array_like, (...)  of the light [W / sr]; broadcasts with the result
    model : str                    a name in `MODELS`
    dtype : dtype_like             in which the model computes: float64, or float32 to see what a shader would get from
        h, x_a, sigma_t and the length as it holds them
    **options                      what the model's function takes besides, such as `steps` for "riemann", `terms` for
        "weng2010:minimax", `nodes` for "quadrature_float32"

    Returns
    -------
    ndarray, (...) or (..., 3)  radiance [W / (m^2 sr) for a scene unit of 1 m]; with an RGB medium the channels come
        last. A segment that contains the light (h = 0, x_a <= 0 <= x_b) is infinitely bright; beside it h = 0 is an
        ordinary value.

    Raises
    ------
    ValueError
        If h, x_a, x_b or intensity is NaN, h or intensity negative or infinite, x_a infinite, x_b below x_a, the model
        unknown, the phase function one that the model does not take, or an option out of its range.
    TypeError
        If medium or phase is not what this package makes, or an option is not the model's.

    Examples
    --------
    >>> from analytic import Medium, airlight, phase
    >>> float(airlight(1.0, -2.0, 3.0, Medium(0.1, 0.2), phase("isotropic")).round(6))
    0.009531

    Source: Weng 2010, L_m of Eq. 16.
    """
    if not isinstance(model, str) or model not in MODELS:
        raise ValueError(f"model must be one of {', '.join(sorted(MODELS))}: {model!r}")
    if not isinstance(medium, Medium):
        raise TypeError(f"medium must be an analytic.Medium, not {type(medium).__name__}")
    if not isinstance(phase, Phase):
        raise TypeError(f"phase must be made by analytic.phase, not be a {type(phase).__name__}")
    chosen, precision = MODELS[model], np.dtype(dtype)
    if precision not in (np.float32, np.float64):
        raise ValueError(f"dtype must be float32 or float64: {precision}")
    if not chosen.takes(phase):
        raise ValueError(f"phase must be {' or '.join(chosen.phases)} for the model {model}, not {phase.name}")
    height, start, end = _positions(h, x_a, x_b)
    power = real_array("intensity", intensity)
    if not np.all(np.isfinite(power)) or np.any(power < 0):
        raise ValueError("intensity must be finite and not negative")

    if medium.sigma_t.ndim:
        height, start, end = height[..., None], start[..., None], end[..., None]
    arrays = np.broadcast_arrays(height, start, end, medium.sigma_t)
    shape = arrays[0].shape
    try:
        np.broadcast_shapes(power.shape, medium.sigma_s.shape, shape)
    except ValueError:
        raise ValueError(f"intensity must have a shape that broadcasts with {shape}: {power.shape}") from None
    height, start, end, sigma_t = (array.ravel() for array in arrays)
    pieces = Segments.between(height, start, end, sigma_t)

    result = np.zeros(height.shape)
    lamp = (height == 0) & (start <= 0) & (end >= 0) & (end > start)
    result[lamp] = np.inf
    # a ray through the light is no model's own matter: its limit is that of the integral
    through = pieces.through_light & ~lamp & (end > start)
    result[through] = MODELS["quadrature"].function(pieces[through].beside_light(), phase)
    plain = (end > start) & ~through & ~lamp
    given = pieces[plain] if precision == np.float64 else pieces[plain].astype(precision)
    result[plain] = chosen.function(given, phase, **options)

    # no light and no scattering make no airlight, at the lamp neither; what float64 cannot hold is inf
    with np.errstate(invalid="ignore", over="ignore"):
        scale = power * medium.sigma_s
        return np.where(scale > 0, scale * result.reshape(shape), 0.0)


def _positions(
    h: ArrayLike, x_a: ArrayLike, x_b: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The three lengths as float64 arrays of one shape, once they make sense."""
    given = real_array("h", h), real_array("x_a", x_a), real_array("x_b", x_b)
    try:
        height, start, end = np.broadcast_arrays(*given)
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in given)
        raise ValueError(f"h, x_a and x_b must have shapes that broadcast: {shapes}") from None
    if not np.all(np.isfinite(height)) or np.any(height < 0):
        raise ValueError("h must be finite and not negative")
    if not np.all(np.isfinite(start)):
        raise ValueError("x_a must be finite")
    if not np.all(end >= start):
        raise ValueError("x_b must not be NaN or below x_a")
    return height, start, end
