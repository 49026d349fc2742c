"""Every equation of the thesis against an independent truth.

>>> from analytic.thesis.audit import audit
>>> [entry.verdict for entry in audit(["2", "17"])]
['right', 'right']

A verdict follows from the residual of the print; the residual of a repair is measured beside it. `checks` holds what
each is compared with, `checks.parameters` on what.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from mpmath import mp

from analytic.thesis.checks import chapter_3, combined, formulations, sampling, transport
from analytic.thesis.checks.entry import INTEGRAL_DIGITS, LARGEST_RIGHT, Entry

__all__ = ["EQUATIONS", "LARGEST_RIGHT", "Entry", "audit", "audit_one_by_one"]

_CHECKS = (*chapter_3.CHECKS, *transport.CHECKS, *formulations.CHECKS, *combined.CHECKS, *sampling.CHECKS)
EQUATIONS = (*map(str, range(1, 33)), "Fig. 4.11", "Alg. 4.1", "Alg. 4.2")
_CHECK_OF: dict[str, Callable[[], Entry]] = dict(zip(EQUATIONS, _CHECKS, strict=True))


def audit_one_by_one(equations: Sequence[str] = EQUATIONS) -> Iterator[Entry]:
    """The entries in the order asked for, each as soon as it is known.

    Raises
    ------
    ValueError
        If there is no such equation.
    """
    for equation in equations:
        if equation not in _CHECK_OF:
            raise ValueError(f"equations must be of {', '.join(EQUATIONS)}: {equation!r}")
    for equation in equations:
        with mp.workdps(INTEGRAL_DIGITS):
            yield _CHECK_OF[equation]()


def audit(equations: Sequence[str] = EQUATIONS) -> list[Entry]:
    """All 35 entries in the thesis's order, or those asked for; raises as `audit_one_by_one` does.

    Source: Weng 2010, Eqs. 1 to 32, Figure 4.11, Algorithms 4.1 and 4.2, section 4.4.
    """
    return list(audit_one_by_one(equations))
