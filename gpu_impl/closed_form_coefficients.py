"""A phase function's numbers in the closed forms, as GLSL constants."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from analytic.phase import Phase
from analytic.phases.schlick import Schlick

__all__ = ["partial_fractions_glsl", "polynomials_glsl"]


def polynomials_glsl(front: Sequence[float], back: Sequence[float]) -> str:
    """The coefficients of airlight/parts/polynomial_sums.glsl.

    Parameters
    ----------
    front : (n,) of float   c_n, in powers of v before the light's projection [1/sr]
    back : (n,) of float    d_n, in powers of w behind it [1/sr]

    Source: Weng 2010, Eqs. 22 and 29.
    """
    # the isotropic function is its first coefficient: what goes with the others is not evaluated at all
    level = not any(front[1:]) and not any(back[1:])
    terms = 1 if level else len(front)
    return (
        f"const int TERMS = {terms};\nconst bool LEVEL = {str(level).lower()};\n"
        f"const float FRONT[TERMS] = float[]({_numbers(front[:terms])});\n"
        f"const float BACK[TERMS] = float[]({_numbers(back[:terms])});\n"
    )


def partial_fractions_glsl(phase: Phase) -> str:
    """The pole q and the conjugate residues conj(g_1), conj(g_2) ... of airlight/one_ei.glsl.

    The phase function p times 2 / (1 + v^2) is Im sum_n g_n / (v - iq)^n, v = tan(theta / 2).

    Parameters
    ----------
    phase : Phase  isotropic, Rayleigh or Schlick

    Source: the derivation stands in analytic.models.one_ei.closed_form.
    """
    residues: list[complex]
    if isinstance(phase, Schlick):
        k = phase.k
        pole = math.sqrt((1 - k) / (1 + k))
        residues = [1 / (2 * math.pi * math.sqrt((1 - k) * (1 + k))), -1j * k / (2 * math.pi * (1 + k))]
    elif phase.name == "rayleigh":
        pole, residues = 1.0, [9 / (16 * math.pi), 3j / (16 * math.pi), -3 / (8 * math.pi)]
    else:
        pole, residues = 1.0, [1 / (2 * math.pi)]
    count = len(residues)
    # GLSL compiles what it does not run: it wants all three to be there
    conjugates = [complex(g).conjugate() for g in residues] + [0j] * (3 - count)
    values = ", ".join(f"vec2({_numbers([g.real, g.imag])})" for g in conjugates)
    return (
        f"const int ORDERS = {count};\nconst float POLE = {_numbers([pole])};\n"
        f"const vec2 RESIDUE[3] = vec2[]({values});\n"
    )


def _numbers(values: Iterable[float]) -> str:
    return ", ".join(f"{value:.9e}" for value in values)
