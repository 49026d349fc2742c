"""Nodes and weights of `analytic.models.quadrature_float32`, tuned for their worst error over a whole domain.

`python -m experiments.quadrature.tuning 8 10 12` prints the rules with so many nodes, as `RULES` in
`analytic/models/rational_rules.py` lists them; some ten seconds each.

A Gauss-Legendre rule is the best one for polynomials. The airlight is no polynomial: it is one family of functions, of
H, the segment and the phase function, and 2 n + 2 numbers (nodes, weights, clip and scale of the map) are free to serve
that family. Starting from Gauss-Legendre, Levenberg-Marquardt steps lower the 4th, 8th, 16th and at last the 30th power
mean of the relative error over drawn segments, the worst of a larger pool being added after each round.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from analytic import phase
from analytic.models.quadrature import quadrature
from analytic.models.rational_map import RationalMap, RationalRule, lobe_ratio
from analytic.phase import Phase
from analytic.segments import Segments

PHASES = (
    phase("isotropic"),
    phase("rayleigh"),
    *(phase("hg", g=g) for g in (-0.9, -0.5, 0.5, 0.9)),
    *(phase("schlick", k=k) for k in (-0.9, -0.5, 0.9)),
    *(phase("cornette_shanks", g=g) for g in (-0.9, -0.6, 0.5, 0.9)),
)
# starting points that Levenberg-Marquardt leads to the same error within a few per cent: depth at which the map is cut
CLIPS = {5: 7.5, 6: 8.2, 7: 9.3, 8: 9.6, 9: 10.7, 10: 11.8, 12: 13.2, 14: 14.8, 16: 15.5, 24: 17.5}
POWERS = (4, 8, 16, 30)
ROUNDS = 10
STEPS = 15


def draw_segments(count: int, seed: int) -> Segments:
    """Segments of the whole domain, in optical units (sigma_t = 1).

    H is log-uniform from 1e-4 to 50, positions lie in -50 .. 50: uniform, or log-uniform in H or in the position, on
    either side; lengths are log-uniform from 1e-7, four in ten of them in multiples of the larger of H and a part of
    |x_a|; one in ten is infinite.
    """
    random = np.random.default_rng(seed)
    h = 10 ** random.uniform(-4, np.log10(50), count)
    side = np.where(random.random(count) < 0.5, -1.0, 1.0)
    x_a = np.choose(
        random.integers(0, 4, count),
        [
            random.uniform(-50, 50, count),
            side * h * 10 ** random.uniform(-2, 3, count),
            -(10 ** random.uniform(-4, 1.7, count)),
            side * 10 ** random.uniform(-4, 1.7, count),
        ],
    )
    x_a = np.clip(x_a, -50, 49)
    scale = np.maximum(h, np.abs(x_a) * random.random(count))
    many = random.random(count) < 0.4
    length = np.where(many, 10 ** random.uniform(-2, 2.5, count) * scale, 10 ** random.uniform(-7, 2, count))
    length = np.where(random.random(count) < 0.1, np.inf, length)
    length = np.where(np.isfinite(length), np.minimum(length, 50 - x_a), np.inf)
    return Segments(h, x_a, x_a + length, length, np.ones(count))


class _Pool:
    """Pairs of a segment and a phase function, with the integral that the rule has to meet."""

    def __init__(self, segments: Segments, phases: Sequence[Phase]) -> None:
        self.phases = phases
        self.v_a, self.h = np.tile(segments.v_a, len(phases)), np.tile(segments.optical_h, len(phases))
        self.span = np.tile(segments.difference_of_v, len(phases))
        self.which = np.repeat(np.arange(len(phases)), len(segments))
        self.ratio = np.array([lobe_ratio(phase) for phase in phases])[self.which]
        bare = segments.h * np.exp(segments.sigma_t * segments.d_a)
        self.exact = np.concatenate([quadrature(segments, phase) * bare for phase in phases])

    def part(self, chosen: NDArray[np.intp]) -> _Pool:
        part = object.__new__(_Pool)
        part.phases = self.phases
        for name in ("v_a", "h", "span", "which", "ratio", "exact"):
            setattr(part, name, getattr(self, name)[chosen])
        return part

    def terms(self, nodes: NDArray[np.float64], clip: float, q: float) -> NDArray[np.float64]:
        """Integrand at each node over the exact integral, (nodes, pairs): weights @ terms - 1 is the relative error."""
        mapping = RationalMap.of(self.v_a, self.span, self.h, q * self.ratio, clip)
        values = []
        for node in nodes:
            beyond, slope = mapping.at(node)
            v = self.v_a + beyond
            cos2 = 1 / (1 + v * v)
            sin2 = v * (v * cos2)
            value = np.empty_like(v)
            for number, function in enumerate(self.phases):
                mine = self.which == number
                value[mine] = function.of_half_angle(cos2[mine], sin2[mine])
            values.append(np.exp(-self.h * beyond) * value * slope * 2 * cos2 / self.exact)
        return np.array(values)

    def errors(self, parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        nodes, weights, clip, q = _unpack(parameters)
        return weights @ self.terms(nodes, clip, q) - 1


def _unpack(parameters: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], float, float]:
    count = (parameters.size - 2) // 2
    return parameters[:count], parameters[count:-2], float(parameters[-2]), float(np.exp(parameters[-1]))


def _jacobian(pool: _Pool, parameters: NDArray[np.float64]) -> NDArray[np.float64]:
    """Derivatives of the errors, (pairs, parameters): exact in the weights, by central differences in the rest."""
    nodes, weights, clip, q = _unpack(parameters)
    small = 1e-5
    forward, backward = (pool.terms(nodes + step, clip, q) for step in (small, -small))
    columns = [*(weights[:, None] * (forward - backward) / (2 * small)), *pool.terms(nodes, clip, q)]
    for index in (-2, -1):
        step = np.zeros_like(parameters)
        step[index] = 1e-4
        columns.append((pool.errors(parameters + step) - pool.errors(parameters - step)) / 2e-4)
    return np.array(columns).T


def _descend(pool: _Pool, parameters: NDArray[np.float64], power: int) -> NDArray[np.float64]:
    """Levenberg-Marquardt on the power mean of the errors, as least squares reweighted by |error|^(power/2 - 1)."""

    def mean(errors: NDArray[np.float64]) -> float:
        worst = np.abs(errors).max()
        return float(worst * np.mean((np.abs(errors) / worst) ** power) ** (1 / power))

    damping, errors = 1e-3, pool.errors(parameters)
    for _ in range(STEPS):
        before, jacobian = mean(errors), _jacobian(pool, parameters)
        emphasis = (np.abs(errors) / np.abs(errors).max()) ** ((power - 2) / 2)
        jacobian *= emphasis[:, None]
        normal, gradient = jacobian.T @ jacobian, jacobian.T @ (emphasis * errors)
        for _ in range(10):
            step = -np.linalg.solve(normal + damping * np.diag(np.diag(normal)), gradient)
            # the full step of least squares overshoots for a high power, by the factor power - 1
            for share in (1, 1 / (power - 1)):
                trial = parameters + share * step
                nodes = _unpack(trial)[0]
                if nodes[0] > 0 and nodes[-1] < 1 and np.all(np.diff(nodes) > 0):
                    trial_errors = pool.errors(trial)
                    if mean(trial_errors) < before:
                        break
            else:
                damping *= 5
                continue
            parameters, errors, damping = trial, trial_errors, max(damping / 5, 1e-10)
            break
        else:
            break
        if mean(errors) > before * (1 - 1e-4):
            break
    return parameters


def tune(
    nodes: int, segments: int = 9000, seed: int = 3, report: Callable[[str], None] = lambda line: None
) -> RationalRule:
    """The rule with so many nodes, from Gauss-Legendre.

    Parameters
    ----------
    nodes : int     a key of `CLIPS`
    segments, seed  of the pool that it is tuned on, every segment with each of `PHASES`
    report : callable, takes a line after each round
    """
    x, weights = np.polynomial.legendre.leggauss(nodes)
    parameters = np.concatenate([(x + 1) / 2, weights / 2, [CLIPS[nodes], 0.2]])
    pool = _Pool(draw_segments(segments, seed), PHASES)
    errors = np.abs(pool.errors(parameters))
    random = np.random.default_rng(0)
    chosen = np.unique(np.concatenate([np.argsort(-errors)[:1500], random.integers(0, errors.size, 4000)]))
    best = (np.inf, parameters)
    for round_ in range(ROUNDS):
        parameters = _descend(pool.part(chosen), parameters, POWERS[min(round_, len(POWERS) - 1)])
        errors = np.abs(pool.errors(parameters))
        best = min(best, (float(errors.max()), parameters), key=lambda pair: pair[0])
        chosen = np.union1d(chosen, np.argsort(-errors)[:400])
        report(f"{nodes} nodes, round {round_ + 1}: worst {errors.max():.2e}")
    tuned, weights, clip, q = _unpack(best[1])
    return RationalRule(tuple(tuned.tolist()), tuple(weights.tolist()), clip, q)


def _text(rule: RationalRule) -> str:
    def row(values: Sequence[float]) -> str:
        return ", ".join(f"{value:.10g}" for value in values)

    return (
        f"    {len(rule.nodes)}: RationalRule(\n        nodes=({row(rule.nodes)}),\n"
        f"        weights=({row(rule.weights)}),\n        clip={rule.clip:.6g},\n        q={rule.q:.6g},\n    ),"
    )


if __name__ == "__main__":
    for wanted in sys.argv[1:]:
        print(_text(tune(int(wanted), report=lambda line: print(line, file=sys.stderr))), flush=True)
