"""Many integrals at once, each halved where it has not settled: Gauss and Kronrod's rules of 7 and 15 nodes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]

# Nodes from the end of [-1, 1] to its middle with Kronrod's weights, and Gauss's for every second of them (Kronrod
# 1965; the digits are those of QUADPACK's QK15, Piessens et al. 1983).
_NODES = (
    0.991455371120812639206854697526329,
    0.949107912342758524526189684047851,
    0.864864423359769072789712788640926,
    0.741531185599394439863864773280788,
    0.586087235467691130294144691693,
    0.405845151377397166906606412076961,
    0.207784955007898467600689403773245,
    0.0,
)
_KRONROD = (
    0.022935322010529224963732008058970,
    0.063092092629978553290700663189204,
    0.104790010322250183839876322541518,
    0.140653259715525918745189590510238,
    0.169004726639267902826583426598550,
    0.190350578064785409913256402421014,
    0.204432940075298892414161999234649,
    0.209482141084727828012999174891714,
)
_GAUSS = (
    0.129484966168869693270611432679082,
    0.279705391489276667901467771423780,
    0.381830050505118944950369775488975,
    0.417959183673469387755102040816327,
)

# on [0, 1]
NODES = (1 + np.array([-x for x in _NODES] + list(_NODES[-2::-1]))) / 2
KRONROD = np.array(_KRONROD + _KRONROD[-2::-1]) / 2
GAUSS = np.zeros(15)
GAUSS[1::2] = np.array(_GAUSS + _GAUSS[-2::-1]) / 2

RELATIVE = 1e-10
# parts held at once, 15 places each: some tens of MB an array
CHUNK = 1 << 14
# after so many halvings of [0, 1] float64 tells hardly any places apart, and what is left counts as error
MOST_HALVINGS = 44


def integrate(
    function: Callable[[Index, Array], Array], owner: Index, owners: int, relative: float = RELATIVE
) -> tuple[Array, Array]:
    """Integrals over [0, 1], summed by owner.

    A part is halved until its two rules differ by no more than a share of its owner's whole sum, in each channel.

    Parameters
    ----------
    function : (k,), (k, 15) -> (k, 15, 3)    values of the integrals of these numbers at these places
    owner : (n,) int                          of each integral, below `owners`
    relative : float                          the share

    Returns
    -------
    value : (owners, 3)
    error : (owners, 3)    sum of what the two rules differ by: far more than the error of the better one
    """
    value, error = np.zeros((owners, 3)), np.zeros((owners, 3))
    number, begin, width = np.arange(owner.size), np.zeros(owner.size), 1.0
    for halvings in range(MOST_HALVINGS + 1):
        if not number.size:
            break
        better, difference = _both_rules(function, number, begin, width)
        # where there is much to come, a part is small against it and not against what is settled
        so_far = value + _summed(owner[number], np.abs(better), owners)
        settled = (difference <= relative * so_far[owner[number]]).all(-1) | (halvings == MOST_HALVINGS)
        value += _summed(owner[number[settled]], better[settled], owners)
        error += _summed(owner[number[settled]], difference[settled], owners)
        width /= 2
        number, begin = np.repeat(number[~settled], 2), np.repeat(begin[~settled], 2)
        begin[1::2] += width
    return value, error


def _both_rules(
    function: Callable[[Index, Array], Array], number: Index, begin: Array, width: float
) -> tuple[Array, Array]:
    """Kronrod's value of each part, and by how much Gauss's differs, (n, 3) each."""
    better, difference = np.empty((number.size, 3)), np.empty((number.size, 3))
    for first in range(0, number.size, CHUNK):
        part = slice(first, first + CHUNK)
        values = width * function(number[part], begin[part, None] + width * NODES)
        better[part] = np.einsum("kic,i->kc", values, KRONROD)
        difference[part] = np.abs(np.einsum("kic,i->kc", values, KRONROD - GAUSS))
    return better, difference


def _summed(owner: Index, values: Array, owners: int) -> Array:
    return np.stack([np.bincount(owner, values[:, channel], owners) for channel in range(3)], axis=-1)
