"""The nodes of airlight/quadrature.glsl."""

from __future__ import annotations

import numpy as np

# nodes -> (CLIP, Q) of the shader's map; the worst errors are 4.2e-3, 3.6e-4, 3.0e-4, 4.3e-5, 1.2e-6
# (results/quadrature, which has a better map and better nodes: analytic/models/rational_rules.py)
TUNED = {8: (8.0, 1.0), 10: (10.0, 1.4), 12: (10.0, 1.4), 16: (12.0, 2.0), 24: (16.0, 3.0)}


def gauss_legendre_glsl(nodes: int) -> str:
    """Gauss-Legendre nodes and weights on [0, 1] as GLSL constants.

    Parameters
    ----------
    nodes : one of `TUNED`
    """
    x, weights = np.polynomial.legendre.leggauss(nodes)
    clip, q = TUNED[nodes]

    def array(name: str, values: np.ndarray) -> str:
        return f"const float {name}[NODES] = float[]({', '.join(f'{value:.9e}' for value in values)});\n"

    head = f"const int NODES = {nodes};\nconst float CLIP = {clip};\nconst float Q = {q};\n"
    return head + array("NODE", (x + 1) / 2) + array("WEIGHT", weights / 2)
