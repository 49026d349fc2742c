"""How many exponentials the airlight needs: the rules of `quadrature_float32` beside Gauss-Legendre.

`airlight quadrature --out results/quadrature` writes the page; half a minute.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from analytic import phase
from analytic.models.equiangular import equiangular
from analytic.models.quadrature import quadrature
from analytic.models.quadrature_float32 import TOLERANCES, gauss_legendre, nodes_needed, pieces, quadrature_float32
from analytic.models.rational_map import RationalRule, lobe_ratio
from analytic.models.rational_rules import RULES
from analytic.phase import Phase
from analytic.segments import Segments
from experiments.pages import made_by, prepare_page
from experiments.quadrature.thresholds import draw_lit_pieces
from experiments.quadrature.tuning import draw_segments
from scenes.replacing import replacing

TITLE = "How many exponentials the airlight needs"
SEGMENTS, SEED = 8000, 4711  # held out: the tuning draws other seeds
# up to +-0.9, and beside the values of the tuning
PHASES = (
    phase("isotropic"),
    phase("rayleigh"),
    *(phase("hg", g=g) for g in (-0.9, 0.75, 0.9)),
    *(phase("schlick", k=k) for k in (-0.9, 0.4, 0.9)),
    *(phase("cornette_shanks", g=g) for g in (-0.9, -0.75, 0.9)),
)
# nodes -> (clip, q) for Gauss-Legendre under the first map, and under that of the tuned rules, each from a search
FIRST_MAP = {8: (8.0, 1.0), 10: (10.0, 1.4), 12: (10.0, 1.4), 16: (12.0, 2.0), 24: (16.0, 3.0)}
SAME_MAP = {6: (10.76, 0.84), 8: (9.74, 0.72), 12: (11.69, 1.06), 16: (13.14, 1.47), 24: (15.09, 2.47)}
EXPLORED = """
## What else was tried

Tuned and judged as above on pools of 6,000 to 20,000 segments, with 8 nodes unless said; these trials are not kept.

| trial | worst error |
|---|---|
| best q of each segment by itself, Gauss-Legendre (a bound on any choice of q) | 1.7e-3 |
| tuned nodes and weights, map X^2 - X, clip 9 and q as they were | 8.1e-4 |
| tuned nodes, weights, clip, and v = q (X - 1) (X + k) with k free | 2.9e-4 (k = 1 is as good) |
| v = q (X^b - 1) with b free: 4.6, one power a node more | 2.6e-4 |
| q, or a shift of X, free to depend on H, on the depth and on v_a (11 parameters) | 2.5e-4 |
| a soft minimum of span and clip / H | 3.0e-4 |
| q free for every phase function | 2.7e-4 |
| **q = Q (p(-1) / p(1))^(1/4), k = 1: kept** | 2.8e-4 |
| nodes for the isotropic function alone: 5 / 6 / 8 | 5.0e-4 / 1.4e-4 / 1.6e-5 |
| nodes for isotropic and Rayleigh: 5 / 6 / 8 | 1.6e-3 / 6.4e-4 / 5.8e-5 |
| nodes for HG from -0.2 to -0.9: 5 / 6 / 8 | 1.8e-3 / 6.1e-4 / 6.4e-5 |

Maps, warps and their dependence on the segment move the error little: with nodes free, 16 numbers are what the family
of functions needs for 2.5e-4. What is left to gain is a set of nodes for each phase function, 8 instead of 10 for 1e-4.
"""


def first_map(drawn: Segments, function: Phase, nodes: int) -> NDArray[np.float64]:
    """The airlight by Gauss-Legendre in Y = 1 / X, v = q (X^2 - X), q by the square root of the lobe's width."""
    clip, q = FIRST_MAP[nodes]
    q *= lobe_ratio(function) ** (1 / 2 if function.name == "schlick" else 2 / 3)
    v_a, h = drawn.v_a, drawn.optical_h
    span = np.minimum(drawn.difference_of_v, clip / h)
    x_a, x_b = ((1 + np.sqrt(1 + 4 * v / q)) / 2 for v in (v_a, v_a + span))
    dy = span / (q * (x_a + x_b - 1)) / (x_a * x_b)
    total = np.zeros_like(v_a)
    for node, weight in zip(*gauss_legendre(nodes), strict=True):
        x = 1 / (1 / x_a - dy * node)
        past = q * dy * node * x * x_a * (x + x_a - 1)
        v = v_a + past
        cos2 = 1 / (1 + v * v)
        value = function.of_half_angle(cos2, v * v * cos2)
        total += weight * np.exp(-h * past) * value * (2 * x - 1) * x * x * cos2
    return 2 * q * dy * total / drawn.h * np.exp(-drawn.sigma_t * drawn.d_a)


def same_map(drawn: Segments, function: Phase, nodes: int) -> NDArray[np.float64]:
    """The airlight by Gauss-Legendre under the map of the tuned rules, with its own clip and scale."""
    rule = RationalRule(*gauss_legendre(nodes), *SAME_MAP[nodes])
    ((_, _, mapping),) = pieces(drawn, function, rule)
    return mapping.integral(function, rule) / drawn.h * np.exp(-drawn.sigma_t * drawn.d_a)


def page() -> str:
    """The study as Markdown."""
    drawn, lit = draw_segments(SEGMENTS, SEED), draw_lit_pieces(SEGMENTS, SEED)
    exact = {function: quadrature(drawn, function) for function in PHASES}
    visible = drawn.sigma_t * drawn.d_a <= 12

    def worst(model: Callable[[Segments, Phase], NDArray[np.floating]]) -> str:
        return f"{max(np.max(np.abs(model(drawn, function) / exact[function] - 1)) for function in PHASES):.1e}"

    lines = [
        f"# {TITLE}",
        "",
        made_by("airlight quadrature --out results/quadrature", "numpy"),
        "",
        f"Worst relative error in float64 over {SEGMENTS:,} held-out segments and {len(PHASES)} phase functions up to "
        "+-0.9, against `quadrature`. `draw_segments` says how they are drawn: H 1e-4 .. 50, optical positions "
        "-50 .. 50, lengths from 1e-7 to infinite. One exponential, two divisions and one value of the phase function "
        "a node.",
        "",
        "| nodes | Gauss-Legendre, v = q (X^2 - X) | Gauss-Legendre, v = q (X^2 - 1) | tuned | equiangular (visible) |",
        "|---|---|---|---|---|",
    ]
    for nodes in RULES:
        first = worst(lambda s, p, n=nodes: first_map(s, p, n)) if nodes in FIRST_MAP else ""  # type: ignore[misc]
        same = worst(lambda s, p, n=nodes: same_map(s, p, n)) if nodes in SAME_MAP else ""  # type: ignore[misc]
        tuned = worst(lambda s, p, n=nodes: quadrature_float32(s, p, nodes=n))  # type: ignore[misc]
        angle = max(np.max(np.abs(equiangular(drawn[visible], p, nodes=nodes) / exact[p][visible] - 1)) for p in PHASES)
        lines.append(f"| {nodes} | {first} | {same} | {tuned} | {angle:.1e} |")
    lines += [
        "",
        "## Nodes chosen for each segment",
        "",
        "| tolerance | worst error, domain | worst error, lit pieces | mean nodes, domain | mean nodes, lit pieces |",
        "|---|---|---|---|---|",
    ]
    for tolerance in TOLERANCES:
        kept, kept_lit, mean, mean_lit = [], [], [], []
        for function in PHASES:
            value = quadrature_float32(drawn, function, tolerance=tolerance)
            kept.append(np.max(np.abs(value / exact[function] - 1)))
            value = quadrature_float32(lit, function, tolerance=tolerance)
            kept_lit.append(np.max(np.abs(value / quadrature(lit, function) - 1)))
            mean.append(nodes_needed(drawn, function, tolerance).mean())
            mean_lit.append(nodes_needed(lit, function, tolerance).mean())
        lines.append(
            f"| {tolerance:g} | {max(kept):.1e} | {max(kept_lit):.1e} | {np.mean(mean):.2f} | {np.mean(mean_lit):.2f} |"
        )
    return "\n".join(lines) + "\n" + EXPLORED


def write_study(folder: Path) -> None:
    """Write README.md into a folder, made if need be.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    prepare_page(folder, TITLE)
    with replacing(folder / "README.md") as beside:
        beside.write_text(page(), encoding="utf-8")
