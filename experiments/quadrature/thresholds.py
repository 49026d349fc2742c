"""Thresholds from which `quadrature_float32` chooses the number of nodes for a tolerance.

`python -m experiments.quadrature.thresholds` prints `TOLERANCES` of `quadrature_float32`; a minute.

A Gauss-Legendre rule of few nodes may serve every segment less difficult than the least difficult one that it fails:
difficulty is measured before, from dY and the optical depth. `MARGIN` of the tolerance is what counts as failed, over
segments of the whole domain and pieces between shadows with the phase functions of the tuning and a few more.
"""

from __future__ import annotations

import numpy as np

from analytic import phase
from analytic.models.quadrature import quadrature
from analytic.models.quadrature_float32 import gauss_legendre, pieces
from analytic.models.rational_map import RationalRule
from analytic.models.rational_rules import RULES
from analytic.segments import Segments
from experiments.quadrature.tuning import PHASES as TUNING_PHASES
from experiments.quadrature.tuning import draw_segments

# tolerance -> nodes of the tuned rule that keeps it over the whole domain
TUNED = {1e-2: 5, 1e-3: 7, 1e-4: 10, 1e-6: 24}
COUNTS = (1, 2, 3, 4, 6, 8, 12)
MARGIN = 0.5
# beside those of the tuning
PHASES = (*TUNING_PHASES, phase("hg", g=0.75), *(phase("cornette_shanks", g=g) for g in (-0.75, 0.75)))


def draw_lit_pieces(count: int, seed: int) -> Segments:
    """One lit piece a ray, as between shadows, in optical units (sigma_t = 1).

    Light 0.01 to 2 from the ray, the eye 4 before its projection to 1 behind it, the ray 2 long on average
    (exponential) and cut at eight places at random, of which the piece joins two neighbours.
    """
    random = np.random.default_rng(seed)
    h, first = 10 ** random.uniform(-2, 0.3, count), random.uniform(-4, 1, count)
    ray = random.exponential(2, count)
    cuts = np.sort(random.random((count, 8)), axis=1)
    which, rows = random.integers(0, 7, count), np.arange(count)
    x_a, length = first + ray * cuts[rows, which], ray * (cuts[rows, which + 1] - cuts[rows, which])
    return Segments(h, x_a, x_a + length, length, np.ones(count))


def thresholds(tolerance: float, segments: int = 40_000, seed: int = 7) -> dict[int, float]:
    """Largest difficulty that a Gauss-Legendre rule of so many nodes serves within the tolerance."""
    tuned = RULES[TUNED[tolerance]]
    least: dict[int, float] = {count: np.inf for count in COUNTS if count < TUNED[tolerance]}
    for drawn in (draw_segments(segments, seed), draw_lit_pieces(segments // 4, seed)):
        bare = drawn.h * np.exp(drawn.sigma_t * drawn.d_a)
        for function in PHASES:
            exact = quadrature(drawn, function) * bare
            ((_, _, mapping),) = pieces(drawn, function, tuned)
            for count in least:
                rule = RationalRule(*gauss_legendre(count), tuned.clip, tuned.q)
                errors = np.abs(mapping.integral(function, rule) / exact - 1)
                failed = mapping.difficulty[errors > MARGIN * tolerance]
                least[count] = min(least[count], float(failed.min(initial=np.inf)))
    return {count: float(f"{0.995 * value:.3g}") for count, value in least.items()}


if __name__ == "__main__":
    for wanted, nodes in TUNED.items():
        print(f"    {wanted:g}: ({nodes}, {thresholds(wanted)}),")
