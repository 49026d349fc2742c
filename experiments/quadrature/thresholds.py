"""Thresholds from which `quadrature_float32` chooses the number of nodes for a tolerance.

`python -m experiments.quadrature.thresholds` prints `TOLERANCES` of `quadrature_float32`; two and a half minutes.

A Gauss-Legendre rule of few nodes may serve every segment less difficult than the least difficult one that it fails:
difficulty is measured before, from dY and the optical depth. `MARGIN` of the tolerance is what counts as failed, over
segments of the whole domain, pieces between shadows, behind the light and across it, with every phase function in steps
of 0.1 of g. Tables have thresholds of their own. Between two kinks a table is a sum of two functions that are linear
in cos theta and 0 at one end, with no negative share of either: what is kept for both is kept for every table.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from analytic import phase
from analytic.gauss_legendre import gauss_legendre
from analytic.models.quadrature import quadrature
from analytic.models.rational_map import RationalMap, RationalRule, lobe_ratio
from analytic.models.rational_rules import RULES
from analytic.phase import Phase
from analytic.segments import Segments
from experiments.quadrature.tuning import draw_segments

# tolerance -> nodes of the tuned rule that keeps it over the whole domain
TUNED = {1e-2: 5, 1e-3: 8, 1e-4: 10, 1e-6: 24}
COUNTS = (1, 2, 3, 4, 6, 8, 12)
MARGIN = 0.4
STEPS = tuple(round(0.1 * step, 1) for step in range(-9, 10) if step)
PHASES = (
    phase("isotropic"),
    phase("rayleigh"),
    *(phase("hg", g=g) for g in STEPS),
    *(phase("schlick", k=k) for k in STEPS),
    *(phase("cornette_shanks", g=g) for g in STEPS),
)
TABLE_SIZES = (2, 3, 5, 19, 181)


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


def draw_pieces_behind(count: int, seed: int) -> Segments:
    """Pieces of which three in four begin behind the light, half of them far behind it in units of h (sigma_t = 1).

    There a piece is narrow in Y, however long, and its optical depth alone makes it hard.
    """
    random = np.random.default_rng(seed)
    h = 10 ** np.where(random.random(count) < 0.5, random.uniform(-4, -2, count), random.uniform(-4, 1, count))
    x_a = np.where(random.random(count) < 0.25, -1, 1) * 10 ** random.uniform(-4, 1.69, count)
    length = np.minimum(10 ** random.uniform(-3, 1.7, count), 50 - x_a)
    return Segments(h, x_a, x_a + length, length, np.ones(count))


def draw_pieces_across(count: int, seed: int) -> Segments:
    """Pieces from before the light to within 0.01 to 100 h behind its projection, where a backward lobe begins."""
    random = np.random.default_rng(seed)
    h, before = 10 ** random.uniform(-4, 1, count), 10 ** random.uniform(-4, 1.69, count)
    length = before + np.minimum(h * 10 ** random.uniform(-2, 2, count), 50)
    return Segments(h, -before, length - before, length, np.ones(count))


def hats(size: int) -> Iterator[tuple[Phase, float, float]]:
    """Tables of one value beside zeros, and the ends u = x / h of an interval that they rise or fall over."""
    edges = np.linspace(-1, 1, size)
    with np.errstate(divide="ignore"):
        places = np.sort(-edges / np.sqrt((1 - edges) * (1 + edges)))
    for forward in sorted({0, 1, (size - 1) // 2, size - 3, size - 2} & set(range(size - 1))):
        # the interval `forward` steps behind the forward end, between two of the table's cosines
        for high in (forward, forward + 1):
            values = [0.0] * size
            values[size - 1 - high] = 1.0
            yield phase("tabulated", values=values), float(places[forward]), float(places[forward + 1])


def clipped(drawn: Segments, low: float, high: float) -> Segments:
    """The parts of the segments between two places u = x / h."""
    x_a, x_b = np.maximum(drawn.x_a, low * drawn.h), np.minimum(drawn.x_b, high * drawn.h)
    whole = (x_a == drawn.x_a) & (x_b == drawn.x_b)
    parts = Segments(drawn.h, x_a, x_b, np.where(whole, drawn.length, x_b - x_a), drawn.sigma_t)
    return parts[parts.length > 1e-9 * np.abs(parts.x_a)]


def failing(drawn: Segments, function: Phase, tolerance: float, counts: Iterable[int]) -> dict[int, float]:
    """Least difficulty of the segments that a Gauss-Legendre rule of so many nodes fails; none has a kink inside."""
    tuned = RULES[TUNED[tolerance]]
    exact = quadrature(drawn, function) * drawn.h * np.exp(drawn.sigma_t * drawn.d_a)
    scale = tuned.q * lobe_ratio(function)
    mapping = RationalMap.of(drawn.v_a, drawn.difference_of_v, drawn.optical_h, scale, tuned.clip)
    least = {}
    for count in counts:
        rule = RationalRule(*gauss_legendre(count), tuned.clip, tuned.q)
        errors = np.abs(mapping.integral(function, rule) / exact - 1)
        least[count] = float(mapping.difficulty[errors > MARGIN * tolerance].min(initial=np.inf))
    return least


def thresholds(tolerance: float, segments: int = 20_000, seed: int = 7) -> tuple[dict[int, float], dict[int, float]]:
    """Largest difficulty that a Gauss-Legendre rule of so many nodes serves within the tolerance: smooth, and tables.

    One node serves no table: it is wrong by a quarter next to the zero of one that falls to 0 forwards.
    """
    draws = (draw_segments, draw_lit_pieces, draw_pieces_behind, draw_pieces_across)
    drawn = joined(draw(segments, seed) for draw in draws)
    counts = [count for count in COUNTS if count < TUNED[tolerance]]
    smooth = [failing(drawn, function, tolerance, counts) for function in PHASES]
    linear = [
        failing(clipped(drawn, low, high), function, tolerance, counts[1:])
        for size in TABLE_SIZES
        for function, low, high in hats(size)
    ]
    return _least(smooth), _least(linear)


def joined(parts: Iterable[Segments]) -> Segments:
    """Several sets of segments as one."""
    columns = zip(*((s.h, s.x_a, s.x_b, s.length, s.sigma_t) for s in parts), strict=True)
    return Segments(*(np.concatenate(column) for column in columns))


def _least(found: list[dict[int, float]]) -> dict[int, float]:
    """For each count the least of all, below what would round to it; a rule serves no more than those of more nodes."""
    least = {count: min(each[count] for each in found) for count in found[0]}
    least = {count: min(value for more, value in least.items() if more >= count) for count in least}
    return {count: float(f"{0.995 * value:.3g}") for count, value in least.items()}


if __name__ == "__main__":
    for wanted, nodes in TUNED.items():
        smooth_table, linear_table = thresholds(wanted)
        print(f"    {wanted:g}: ({nodes}, {smooth_table}, {linear_table}),")
