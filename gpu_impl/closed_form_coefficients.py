"""A phase function's numbers in the closed forms, as GLSL constants."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from analytic.models.one_ei.closed_form import partial_fractions
from analytic.phase import Phase

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
    pole, residues = partial_fractions(phase)
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
