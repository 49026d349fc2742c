"""What a model computes for a segment, counted while it runs.

The model gets arrays that look like any other and compute the same bits, and that add up how many elements passed
through each function of NumPy. What is counted is what depends on the segment: work on plain arrays, such as the nodes
of a rule, is not. A table is read, and an exponential integral evaluated, by a function of `analytic`; these are
wrapped where modules refer to them. What an exponential integral does inside is not counted besides; what a read does
is, for a texture unit does not find the place in the table.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from functools import wraps
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.models import AirlightModel
from analytic.phase import Phase
from analytic.segments import Segments

__all__ = ["OPERATIONS", "count_operations"]

OPERATIONS = (
    "exponentials",
    "square_roots",
    "logarithms",
    "trigonometric",
    "divisions",
    "table_reads",
    "exponential_integrals",
)
WIDENED = "widened"  # tallied beside them

# what one real element costs
UFUNCS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("exp", "exp2", "expm1", "sinh", "cosh", "tanh"), ("exponentials",)),
    **dict.fromkeys(("log", "log2", "log10", "log1p", "arctanh"), ("logarithms",)),
    **dict.fromkeys(("arcsinh", "arccosh"), ("logarithms", "square_roots")),
    **dict.fromkeys(("sqrt", "cbrt", "hypot"), ("square_roots",)),
    **dict.fromkeys(("sin", "cos", "tan", "arcsin", "arccos", "arctan", "arctan2"), ("trigonometric",)),
    **dict.fromkeys(("divide", "floor_divide", "reciprocal"), ("divisions",)),
    **dict.fromkeys(("power", "float_power"), ("exponentials", "logarithms")),
    **dict.fromkeys(("exp1", "expi"), ("exponential_integrals",)),
}
# and one complex element, where that is something else
COMPLEX_UFUNCS: dict[str, tuple[str, ...]] = {
    "exp": ("exponentials", "trigonometric", "trigonometric"),
    "log": ("logarithms", "trigonometric", "square_roots"),
    "sqrt": ("square_roots", "square_roots"),
    "absolute": ("square_roots",),
}
# functions of `analytic` that count as one operation an element, by their module
WRAPPED = {
    ("analytic.exponential_integral", "scaled_e1"): "exponential_integrals",
    ("analytic.exponential_integral", "ei"): "exponential_integrals",
    ("analytic.models.one_ei.orders", "scaled_orders"): "exponential_integrals",
    ("analytic.models.sun2005", "read"): "table_reads",
}
# Segments at once where bits are compared. NumPy lets a temporary array of 256 KiB or more hold the next result and may
# swap the factors of a product for it, on whose order the last bit of a complex one depends. It spares subclasses that.
BLOCK = 4096


class CountedArray(np.ndarray):
    """An ndarray that tells a tally what is done with it."""

    tally: Counter[str] | None

    def __array_finalize__(self, parent: Any) -> None:
        """Views, slices and copies keep the tally."""
        self.tally = getattr(parent, "tally", None)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        """Compute as NumPy would, and count the elements of the result."""
        given = options.get("out")
        if given is not None:
            options["out"] = _plain(given)
        plain = _plain(inputs)
        result = getattr(ufunc, method)(*plain, **options)
        tally = _tally_of((inputs, given))
        _note_widening(tally, plain, result)
        if tally is not None and not _is_whole_power(ufunc, plain):
            first = result[0] if isinstance(result, tuple) else result
            is_complex = np.iscomplexobj(plain[0])
            cost = COMPLEX_UFUNCS.get(ufunc.__name__) if is_complex else None
            for operation in cost or UFUNCS.get(ufunc.__name__, ()):
                tally[operation] += np.size(first)
        if given is not None:
            return given[0] if len(given) == 1 else given
        return _counted(result, tally)

    def __array_function__(self, function: Any, types: Any, arguments: Any, options: Any) -> Any:
        """np.where and the like, which would hand back plain arrays."""
        tally = _tally_of((arguments, options))
        result = function(*_plain(arguments), **_plain(options))
        _note_widening(tally, arguments, result)
        return _counted(result, tally)


def count_operations(model: AirlightModel, segments: Segments, phase: Phase) -> dict[str, float]:
    """Operations a segment, by name, the mean over the segments.

    Raises
    ------
    ValueError
        If counting changed a bit of the result, the result comes from something that was not counted, or something was
        computed in float64 from float32.
    """
    for first in range(0, len(segments), BLOCK):
        block = segments[first : first + BLOCK]
        with np.errstate(all="ignore"):
            plain = model.function(block, phase)
        counted = _run(model, block, phase, Counter())
        if not isinstance(counted, CountedArray) or plain.tobytes() != counted.tobytes():
            raise ValueError(f"{model.name} cannot be counted: its arrays get lost on the way, or its bits change")
    tally: Counter[str] = Counter()
    _run(model, segments, phase, tally)
    if tally[WIDENED]:
        raise ValueError(f"{model.name} computes in float64 on the way, asked in float32")
    return {operation: tally[operation] / len(segments) for operation in OPERATIONS}


def _run(model: AirlightModel, segments: Segments, phase: Phase, tally: Counter[str]) -> NDArray[np.floating]:
    """The model's answer to segments that tell the tally what is done with them."""
    counted = Segments(*(_counted(getattr(segments, field.name), tally) for field in fields(Segments)))
    with np.errstate(all="ignore"), _wrapped():
        return model.function(counted, phase)


@contextmanager
def _wrapped() -> Iterator[None]:
    """Within, the functions of WRAPPED count their calls, wherever in `analytic` they were imported to."""
    replaced: list[tuple[Any, str, Callable[..., Any]]] = []
    for (home, name), operation in WRAPPED.items():
        function = getattr(import_module(home), name)
        counting = _counting(function, operation)
        for module in [module for loaded, module in sys.modules.items() if loaded.split(".")[0] == "analytic"]:
            for alias in [alias for alias, value in vars(module).items() if value is function]:
                replaced.append((module, alias, function))
                setattr(module, alias, counting)
    try:
        yield
    finally:
        for module, alias, function in replaced:
            setattr(module, alias, function)


def _counting(function: Callable[..., Any], operation: str) -> Callable[..., Any]:
    """The function, counting the elements of its result, or of the first of several."""

    @wraps(function)
    def counting(*arguments: Any, **options: Any) -> Any:
        tally = _tally_of((arguments, options))
        if operation == "table_reads":
            result = function(*arguments, **options)
        else:
            result = function(*_plain(arguments), **_plain(options))
        if tally is not None:
            tally[operation] += np.size(result[0] if isinstance(result, tuple) else result)
        return _counted(result, tally)

    return counting


def _is_whole_power(ufunc: np.ufunc, inputs: tuple[Any, ...]) -> bool:
    """Whether it is x^n with one whole n: products, which are not counted."""
    if ufunc.__name__ not in ("power", "float_power") or np.ndim(inputs[1]):
        return False
    return float(np.real(inputs[1])).is_integer()


def _plain(value: Any) -> Any:
    """The same with plain arrays, inside tuples, lists and dicts too."""
    if isinstance(value, CountedArray):
        return value.view(np.ndarray)
    if isinstance(value, tuple | list):
        return type(value)(_plain(item) for item in value)
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    return value


def _counted(value: Any, tally: Counter[str] | None) -> Any:
    """The same with counted arrays."""
    if isinstance(value, tuple | list):
        return type(value)(_counted(item, tally) for item in value)
    if not isinstance(value, np.ndarray):
        return value
    array = value.view(CountedArray)
    array.tally = tally
    return array


def _tally_of(value: Any) -> Counter[str] | None:
    """The tally of the first counted array, inside tuples, lists and dicts too."""
    return next(
        (leaf.tally for leaf in _leaves(value) if isinstance(leaf, CountedArray) and leaf.tally is not None), None
    )


def _note_widening(tally: Counter[str] | None, inputs: Any, result: Any) -> None:
    """Tally where double precision comes from single."""
    if tally is not None and _holds(inputs, "fF") and _holds(result, "dD"):
        tally[WIDENED] += 1


def _holds(value: Any, kinds: str) -> bool:
    """Whether there is an array of these kinds, by NumPy's characters of real and complex ones."""
    return any(isinstance(leaf, np.ndarray) and leaf.dtype.char in kinds for leaf in _leaves(value))


def _leaves(value: Any) -> Iterator[Any]:
    """What tuples, lists and dicts hold, at any depth."""
    if isinstance(value, tuple | list | dict):
        for item in value.values() if isinstance(value, dict) else value:
            yield from _leaves(item)
    else:
        yield value
