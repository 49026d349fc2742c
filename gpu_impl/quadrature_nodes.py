"""The nodes of airlight/quadrature.glsl and airlight/part_of_the_leg.glsl, as GLSL constants."""

from __future__ import annotations

from collections.abc import Iterable

from analytic.gauss_legendre import gauss_legendre
from analytic.models.rational_rules import RULES

__all__ = ["gauss_legendre_glsl", "rational_rule_glsl"]


def rational_rule_glsl(nodes: int) -> str:
    """A tuned rule on [0, 1] with the clip and the scale of the map that it goes with.

    Parameters
    ----------
    nodes : int  a key of `analytic.models.rational_rules.RULES`
    """
    rule = RULES[nodes]
    head = f"const int RULE_NODES = {nodes};\nconst float CLIP = {rule.clip};\nconst float Q = {rule.q};\n"
    return head + _array("RULE_NODE", rule.nodes) + _array("RULE_WEIGHT", rule.weights)


def gauss_legendre_glsl(nodes: int) -> str:
    """Gauss-Legendre nodes and weights on [0, 1]."""
    x, weights = gauss_legendre(nodes)
    return f"const int NODES = {nodes};\n" + _array("NODE", x) + _array("WEIGHT", weights)


def _array(name: str, values: Iterable[float]) -> str:
    texts = [f"{value:.9e}" for value in values]
    return f"const float {name}[{len(texts)}] = float[]({', '.join(texts)});\n"
