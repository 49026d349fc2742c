r"""Chapter 3 of Weng 2010, Eqs. 1 to 12: absorption, scattering out of a ray and into it.

`beta` is a coefficient [1 / scene unit], or a function of the position where the medium varies. Eqs. 3, 6 and 11 print
`beta x' dx'` where beta(x') dx' is meant. Two readings are kept: the product of beta(x') and x', and of beta(x), the
coefficient at the end, and x'.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpmath import mp, mpf

from analytic.thesis.segment import integrate

Coefficient = Callable[[Any], Any]

# panels of Eqs. 7 and 8 halve this often towards either end, where lobes are
HALVINGS = 6


def along(function: Callable[[Any], Any], start: Any, end: Any) -> Any:
    """Integral of a smooth function of the position."""
    return integrate(function, [start, end])


def eq_1(beta: Any, dx: Any, area: Any = 1) -> Any:
    """-dL / L of a box of the face `area`, by absorption; Eq. 4 says the same of scattering out of the ray."""
    return beta * area * dx / area


eq_4 = eq_1


def eq_2(L_0: Any, beta: Any, x: Any) -> Any:
    """Radiance after x of a constant coefficient; Eq. 5 says the same of scattering."""
    return L_0 * mp.exp(-beta * x)


eq_5 = eq_2


def eq_3_printed_product(L_0: Any, beta: Coefficient, x: Any) -> Any:
    """L_0 e^{-int beta(x') x' dx'}: the argument of beta left out, x' a factor. Eq. 6 alike."""
    return L_0 * mp.exp(-along(lambda s: beta(s) * s, mpf(0), x))


def eq_3_printed_at_the_end(L_0: Any, beta: Coefficient, x: Any) -> Any:
    """L_0 e^{-beta(x) int x' dx'}: as the symbols stand, beta does not depend on x'. Eq. 6 alike."""
    return L_0 * mp.exp(-along(lambda s: beta(x) * s, mpf(0), x))


def eq_3_repaired(L_0: Any, beta: Coefficient, x: Any) -> Any:
    """L_0 e^{-int beta(x') dx'}."""
    return L_0 * mp.exp(-along(beta, mpf(0), x))


eq_6_printed_product, eq_6_printed_at_the_end, eq_6_repaired = (
    eq_3_printed_product,
    eq_3_printed_at_the_end,
    eq_3_repaired,
)


def eq_7(phase: Callable[[Any], Any]) -> Any:
    """Integral of the phase function of the scattering angle's cosine over the sphere, which is to be 1."""
    return eq_8(lambda cosine: 1, phase)


def eq_8(L_i: Callable[[Any], Any], phase: Callable[[Any], Any]) -> Any:
    """Integral of L_i Phi over the sphere, L_i a function of the same cosine."""
    ends = {mpf(-1), mpf(1)} | {sign * (1 - mpf(2) ** -k) for k in range(HALVINGS + 1) for sign in (-1, 1)}
    return 2 * mp.pi * integrate(lambda cosine: L_i(cosine) * phase(cosine), sorted(ends))


def eq_9(beta_sc: Any, dx: Any, inscattered: Any) -> Any:
    """Radiance that scattering into the ray adds along dx; `inscattered` is Eq. 8's integral."""
    return beta_sc * dx * inscattered


def eq_10(beta_ex: Any, beta_sc: Any, L: Any, inscattered: Any) -> Any:
    """Change of the radiance, dL / dx."""
    return -beta_ex * L + beta_sc * inscattered


def _eq_11(L_0: Any, depth: Callable[[Any, Any], Any], beta_sc: Coefficient, inscattered: Coefficient, x: Any) -> Any:
    added = along(lambda s: mp.exp(-depth(s, x)) * beta_sc(s) * inscattered(s), mpf(0), x)
    return eq_12(L_0, mp.exp(-depth(mpf(0), x)), added)


def eq_11_printed_product(
    L_0: Any, beta_ex: Coefficient, beta_sc: Coefficient, inscattered: Coefficient, x: Any
) -> Any:
    """The solution of Eq. 10 with Eq. 3's slip in both exponents, as the product beta(x') x'."""
    return _eq_11(L_0, lambda low, high: along(lambda s: beta_ex(s) * s, low, high), beta_sc, inscattered, x)


def eq_11_printed_at_the_end(
    L_0: Any, beta_ex: Coefficient, beta_sc: Coefficient, inscattered: Coefficient, x: Any
) -> Any:
    """The same with beta(x), and with beta_sc and L_i at x too: the print gives none of them an argument."""
    depth = lambda low, high: along(lambda s: beta_ex(x) * s, low, high)  # noqa: E731
    return _eq_11(L_0, depth, lambda s: beta_sc(x), lambda s: inscattered(x), x)


def eq_11_repaired(L_0: Any, beta_ex: Coefficient, beta_sc: Coefficient, inscattered: Coefficient, x: Any) -> Any:
    """L_0 e^{-int beta_ex(x') dx'} + int e^{-int_{x'}^x beta_ex(x'') dx''} beta_sc(x') int L_i Phi d omega dx'."""
    return _eq_11(L_0, lambda low, high: along(beta_ex, low, high), beta_sc, inscattered, x)


def eq_12(L_0: Any, part_extinction: Any, part_inscattering: Any) -> Any:
    """L_0 Part_extinction + Part_inscattering."""
    return L_0 * part_extinction + part_inscattering
