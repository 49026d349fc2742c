"""Shapley values: what each part of a whole is charged with, whatever the order in which parts are replaced.

Replace the parts one after the other, in every order; a part's value is what its replacement takes away, averaged over
the orders (Shapley 1953, A value for n-person games). The values add up to what replacing all of them takes away,
a part that never changes anything gets 0, and two parts that change the same get the same. No other rule that is linear
in the worth has these three properties.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from math import factorial
from typing import TypeVar

from numpy.typing import NDArray

# the parts that are replaced
Coalition = frozenset[str]
Worth = TypeVar("Worth", float, NDArray)


def coalitions(parts: Sequence[str]) -> list[Coalition]:
    """Every set of parts, 2^n, from the empty one to all of them."""
    return [Coalition(chosen) for size in range(len(parts) + 1) for chosen in combinations(parts, size)]


def shapley(parts: Sequence[str], worth: Mapping[Coalition, Worth]) -> dict[str, Worth]:
    """What each part is charged with.

    Parameters
    ----------
    parts : n names, no two the same
    worth : mapping    what is left when a coalition is replaced, numbers or arrays of one shape, for all `coalitions`

    Returns
    -------
    dict
        Part to value, of the worth's shape; together they are worth[nothing] - worth[all].

    Raises
    ------
    ValueError
        `parts` has a name twice, or `worth` lacks a coalition.
    """
    if len(set(parts)) != len(parts):
        raise ValueError(f"parts must be different: {', '.join(parts)}")
    missing = [chosen for chosen in coalitions(parts) if chosen not in worth]
    if missing:
        raise ValueError(f"worth must have every coalition, and lacks {sorted(missing[0]) or 'the empty one'}")
    n = len(parts)
    values: dict[str, Worth] = {}
    for part in parts:
        others = [other for other in parts if other != part]
        # of n! orders, so many have these before the part and the rest behind it
        charged = [
            (worth[before] - worth[before | {part}]) * (factorial(len(before)) * factorial(n - 1 - len(before)))
            for before in coalitions(others)
        ]
        values[part] = sum(charged[1:], start=charged[0]) / factorial(n)
    return values
