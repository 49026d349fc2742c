"""What a caller hands in, taken as numbers or refused by name."""

from __future__ import annotations

from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["real_array", "real_number", "whole_number"]


def real_array(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Real numbers as a float64 array, (...), NaN and infinities among them.

    Parameters
    ----------
    name : str          of the argument, for the message
    value : array_like  integers, floats or booleans; not complex numbers, texts or dates

    Raises
    ------
    ValueError
        If it is anything else.
    """
    try:
        array = np.asarray(value)
        if array.dtype.kind in "biuf":
            return array.astype(np.float64)
        # integers that no machine type holds; anything else is no number
        if array.dtype.kind == "O" and all(isinstance(item, int) for item in array.ravel()):
            return array.astype(np.float64)
    except (ValueError, TypeError, OverflowError):
        pass
    raise ValueError(f"{name} must be real numbers that a float holds: {_shown(value)}")


def real_number(name: str, value: ArrayLike) -> float:
    """One real number, as a Python float: one of NumPy's would widen float32 arrays.

    Raises
    ------
    ValueError
        If it is more than one, or none.
    """
    array = real_array(name, value)
    if array.ndim:
        raise ValueError(f"{name} must be one number: {_shown(value)}")
    return float(array)


def whole_number(name: str, value: Any, least: int, most: int | None = None) -> int:
    """Return a whole number from `least` to `most`.

    Raises
    ------
    ValueError
        If it is anything else; a float too.
    """
    wanted = f"{least} to {most}" if most else f"{least} or more"
    whole = isinstance(value, Integral) and not isinstance(value, bool)
    number = int(value) if whole else least - 1
    if number < least or (most and number > most):
        raise ValueError(f"{name} must be a whole number, {wanted}: {_shown(value)}")
    return number


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
