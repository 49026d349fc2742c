"""The registry of airlight models in GLSL. A new one is a file under `shaders/airlight` and a line here."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analytic.models import sun2005
from analytic.models.weng2010.polynomials import POLYNOMIAL_PHASES, near_minimax, taylor
from analytic.phase import Phase
from gpu_impl.closed_form_coefficients import partial_fractions_glsl, polynomials_glsl
from gpu_impl.quadrature_nodes import gauss_legendre_glsl, rational_rule_glsl

QUADRATURE_NODES = 24
POLYNOMIAL_TERMS = 5  # as analytic's defaults


def nothing(phase: Phase) -> Mapping[str, str]:
    """No text is computed."""
    return {}


def _nodes(phase: Phase) -> Mapping[str, str]:
    return {
        "<rational-rule>": rational_rule_glsl(QUADRATURE_NODES),
        "<gauss-legendre>": gauss_legendre_glsl(QUADRATURE_NODES),
    }


def _taylor(phase: Phase) -> Mapping[str, str]:
    return {"<polynomials>": polynomials_glsl(*taylor(phase, POLYNOMIAL_TERMS))}


def _printed(phase: Phase) -> Mapping[str, str]:
    # chapter 5 prints Rayleigh's function as 3/4 (1 + cos^2), which integrates to 4 pi
    scale = 4 * math.pi if phase.name == "rayleigh" else 1.0
    front, back = taylor(phase, POLYNOMIAL_TERMS)
    return {"<polynomials>": polynomials_glsl([scale * c for c in front], [scale * d for d in back])}


def _minimax(phase: Phase) -> Mapping[str, str]:
    return {"<polynomials>": polynomials_glsl(*near_minimax(phase, POLYNOMIAL_TERMS))}


def _fractions(phase: Phase) -> Mapping[str, str]:
    return {"<partial-fractions>": partial_fractions_glsl(phase)}


@dataclass(frozen=True)
class AirlightShader:
    """How much light one lit piece of a ray sends to the eye.

    Attributes
    ----------
    source : str                  the model's file below `shaders/`
    what : str                    for lists
    phases : tuple of str         names of the phase functions that it takes; None for all
    any_light : bool              whether it takes directional lights, and lights outside a bounded medium
    generated : callable          texts of the includes that are computed for a phase function, by name
    table : callable or None      float32 values (rows, columns[, components]) for a phase function, which the shader
                                  reads as `uniform sampler2D airlight_table`: texture() interpolates, and
                                  texelFetch() does not
    point_samples : bool          whether it samples points of a piece, so that it is as accurate as pieces are short
    depth_only : bool             whether it takes the light to be all along the ray as it is at the eye's place, so
                                  that of what a spot sends in each direction nothing counts but where its cone ends
    """

    source: str
    what: str
    phases: tuple[str, ...] | None = None
    any_light: bool = True
    generated: Callable[[Phase], Mapping[str, str]] = nothing
    table: Callable[[Phase], NDArray[np.float32]] | None = None
    point_samples: bool = False
    depth_only: bool = False


def _closed_form(
    source: str, what: str, phases: tuple[str, ...], generated: Callable[[Phase], Mapping[str, str]] = nothing
) -> AirlightShader:
    """A closed form needs all of the light's way to the ray in fog."""
    return AirlightShader(f"airlight/{source}.glsl", what, phases, any_light=False, generated=generated)


ISOTROPIC = ("isotropic",)


def _sun2005(side: int) -> AirlightShader:
    """Sun 2005 with a table of this size."""
    shader = _closed_form("sun2005", f"a table of one function, {side} x {side} samples (Sun 2005)", ISOTROPIC)
    return replace(shader, table=lambda phase: sun2005.published_table(side).values.astype(np.float32))


# names are those of analytic.MODELS where it has the model, all but `quadrature`, which is its `quadrature_float32`
AIRLIGHT_MODELS = {
    "riemann": AirlightShader("airlight/riemann.glsl", "one point sample a piece (Nishita 1987)", point_samples=True),
    "weng2010": _closed_form("weng2010", "closed form, repaired, its exponents merged: two complex Ei", ISOTROPIC),
    "weng2010:printed": _closed_form(
        "weng2010_printed", "sections 4.3 and 4.4 as printed", POLYNOMIAL_PHASES, _printed
    ),
    "weng2010:four-ei": _closed_form("weng2010_four_ei", "Figure 4.9, repaired: four complex Ei", ISOTROPIC),
    "weng2010:three-ei": _closed_form("weng2010_three_ei", "Figure 4.11, repaired: three complex Ei", ISOTROPIC),
    "weng2010:two-ei": _closed_form("weng2010_two_ei", "Eqs. 21 and 32, repaired: two complex Ei", ISOTROPIC),
    "weng2010:taylor": _closed_form(
        "weng2010_polynomial", f"repaired, a Taylor series of {POLYNOMIAL_TERMS} terms", POLYNOMIAL_PHASES, _taylor
    ),
    "weng2010:minimax": _closed_form(
        "weng2010_polynomial", f"repaired, {POLYNOMIAL_TERMS} near-minimax terms", POLYNOMIAL_PHASES, _minimax
    ),
    "one_ei": _closed_form("one_ei", "exact, one complex Ei an end", ("isotropic", "rayleigh", "schlick"), _fractions),
    "sun2005": _sun2005(sun2005.PUBLISHED_SIDE),
    **{f"sun2005:{side}": _sun2005(side) for side in sun2005.SIDES},
    "depth_fog": AirlightShader(
        "airlight/depth_fog.glsl",
        "fog lit all along the ray as it is at the eye's place: only depth counts",
        depth_only=True,
    ),
    "quadrature": AirlightShader(
        "airlight/quadrature.glsl", f"{QUADRATURE_NODES} tuned nodes under a rational map", generated=_nodes
    ),
}
