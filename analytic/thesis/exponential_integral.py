"""The complex exponential integral Ei, which branch it has, and how often it is evaluated."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

from mpmath import mp

__all__ = ["ExponentialIntegral", "counted", "ei", "ei_of_a_fixed_sheet"]

ExponentialIntegral = Callable[[Any], Any]

_evaluated: list[Any] = []
_counting = False


def ei(z: Any) -> Any:
    """Ei(z) with the cut along the negative real axis, where it is -E1(-z) + i pi sign(Im z).

    Then Ei(conj z) = conj Ei(z), which Eq. 32 needs, and it is continuous wherever Im z keeps its sign: Im z is a or -a
    in Eqs. 20 and 26, whatever v and w are, so no branch is ever crossed and i pi drops out of every difference.
    """
    if _counting:
        _evaluated.append(z)
    return _ei(z, mp.prec)


@lru_cache(maxsize=4096)
def _ei(z: Any, precision: int) -> Any:
    return mp.ei(z)


def ei_of_a_fixed_sheet(z: Any) -> Any:
    """-E1(-z) + i pi on both sides of the real axis: an antiderivative as good, but not conjugate for conjugate z.

    On the real axis, Ei.
    """
    return -mp.e1(-z) + 1j * mp.pi if mp.im(z) else mp.ei(z)


@contextmanager
def counted() -> Iterator[list[Any]]:
    """The arguments at which `ei` is evaluated inside the block, as a list that grows."""
    global _counting
    _evaluated.clear()
    _counting = True
    try:
        yield _evaluated
    finally:
        _counting = False
