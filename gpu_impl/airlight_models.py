"""The registry of airlight models in GLSL. A new one is a file under `shaders/airlight` and a line here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from gpu_impl.quadrature_nodes import gauss_legendre_glsl, rational_rule_glsl

QUADRATURE_NODES = 24


@dataclass(frozen=True)
class AirlightShader:
    """How much light one lit piece of a ray sends to the eye."""

    source: str
    what: str
    phases: tuple[str, ...] | None = None  # the phase functions it takes; None for all
    any_light: bool = True  # whether it takes directional lights, and lights outside a bounded medium
    generated: Mapping[str, str] = field(default_factory=dict)  # texts of includes that are computed


AIRLIGHT_MODELS = {
    "riemann": AirlightShader("airlight/riemann.glsl", "one point sample a piece (Nishita 1987)"),
    "weng2010": AirlightShader(
        "airlight/weng2010.glsl", "isotropic closed form, repaired", phases=("isotropic",), any_light=False
    ),
    "quadrature": AirlightShader(
        "airlight/quadrature.glsl",
        f"{QUADRATURE_NODES} tuned nodes under a rational map",
        generated={
            "<rational-rule>": rational_rule_glsl(QUADRATURE_NODES),
            "<gauss-legendre>": gauss_legendre_glsl(QUADRATURE_NODES),
        },
    ),
}
