"""The tuned quadrature on segments and phase functions that it was not tuned on, in float64 and in float32."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from exact_airlight import cornette_shanks, henyey_greenstein, oracle, relative_error, tabulated

from analytic import kinks, phase
from analytic.models.quadrature import quadrature
from analytic.models.quadrature_float32 import TOLERANCES, nodes_needed, quadrature_float32
from analytic.models.rational_map import RationalMap, lobe_ratio
from analytic.models.rational_rules import RULES
from analytic.segments import Segments
from experiments.quadrature.thresholds import draw_lit_pieces, draw_pieces_across, draw_pieces_behind
from experiments.quadrature.tuning import draw_segments

PHASES = [
    phase("isotropic"),
    phase("rayleigh"),
    *(phase("hg", g=g) for g in (-0.9, -0.35, 0.75, 0.9)),
    *(phase("schlick", k=k) for k in (-0.9, 0.4, 0.9)),
    # the worst of all in steps of 0.1
    *(phase("cornette_shanks", g=g) for g in (-0.9, -0.8, -0.3, -0.2, -0.1, 0.8, 0.9)),
    phase("tabulated", values=(0.5, 1.0, 1.5, 2.0, 5.0)),
]
# some fall to 0 forwards, backwards or between
TABLES = [phase("tabulated", values=v) for v in ((1, 0), (0, 1), (1, 0, 1), (0.001, 2, 1.5), (0, 0, 0, 1, 0))]
DRAWN = draw_segments(3000, 2024)
EXACT = [quadrature(DRAWN, function) for function in PHASES]


def worst(value, exact):
    return float(np.max(np.abs(value / exact - 1)))


@pytest.mark.parametrize(
    ("nodes", "bound"),
    # measured on 30,000 segments: 7.0e-3, 2.1e-3, 1.1e-3, 5.1e-4, 6.1e-5, 1.8e-5, 3.1e-6, 2.3e-6, 5.3e-7
    [(5, 8e-3), (6, 2.4e-3), (7, 1.3e-3), (8, 6e-4), (10, 7e-5), (12, 2.1e-5), (14, 3.7e-6), (16, 3e-6), (24, 7e-7)],
)
def test_the_rule_over_the_domain(nodes, bound):
    errors = [
        worst(quadrature_float32(DRAWN, function, nodes=nodes), exact)
        for function, exact in zip(PHASES, EXACT, strict=True)
    ]
    assert max(errors) < bound, errors


def float32_segments(count, seed):
    """Visible segments rounded to float32, and the same numbers in float64, the end following from the length."""
    drawn = draw_segments(count, seed)
    single = drawn[drawn.sigma_t * drawn.d_a <= 12].astype(np.float32)
    return single, single.astype(np.float64)


@pytest.mark.parametrize(("nodes", "bound"), [(12, 1e-4), (24, 2e-6)])
@pytest.mark.parametrize("function", PHASES, ids=lambda function: f"{function.name}")
def test_float32(nodes, bound, function):
    single, double = float32_segments(4000, 77)
    value = quadrature_float32(single, function, nodes=nodes)
    assert value.dtype == np.float32
    # measured on 50,000: 1.9e-5 and 1.01e-6
    assert worst(value, quadrature(double, function)) < bound


def test_float32_where_the_rounded_exponent_cost_most():
    # the light at an optical depth of 11.65: 2.0e-6 without what its exponent's rounding leaves out
    one = [np.float32([value]) for value in (1.41142, -11.56817, 0.388664, 1.0)]
    single = Segments(one[0], one[1], one[1] + one[2], one[2], one[3])
    exact = quadrature(single.astype(np.float64), PHASES[0])
    assert worst(quadrature_float32(single, PHASES[0]), exact) < 1e-6  # measured: 3.5e-7


def test_against_the_oracle():
    hg = henyey_greenstein(0.6)
    for h, x_a, x_b, sigma_t in ((1.0, -2.0, 3.0, 0.2), (0.01, -4.0, 5.0, 1.0), (0.3, 0.5, 90.0, 0.7)):
        ends = (np.array([value]) for value in (h, x_a, x_b, sigma_t))
        value = quadrature_float32(Segments.between(*ends), phase("hg", g=0.6))
        # measured: 8.6e-8, 1.1e-7, 1.0e-7 at 24 nodes
        assert relative_error(value[0], oracle(h, x_a, x_b, sigma_t, hg)) < 3e-7


def test_short_pieces_keep_their_digits():
    # far from the light and shorter than float32 resolves: x_a + length is x_a, and the length alone says how much
    ones = np.ones(3, dtype=np.float32)
    length = np.float32([1e-9, 1e-6, 1e-3])
    single = Segments(0.1 * ones, 40 * ones, 40 * ones + length, length, 0.2 * ones)
    double = single.astype(np.float64)
    assert single.x_b[0] == single.x_a[0]
    for function in PHASES:
        assert worst(quadrature_float32(single, function), quadrature(double, function)) < 3e-6  # measured: 1.1e-6


def test_short_pieces_across_a_kink_keep_their_length():
    # cos theta = -1/2 lies at x = h / sqrt(3); float32 places differ by 6e-8 there, lengths by far less
    length = np.float32([1e-6, 1e-4, 1e-2])
    ones = np.ones(3, dtype=np.float32)
    x_a = np.float32(3**-0.5) - length / 3
    single = Segments(ones, x_a, x_a + length, length, np.float32(0.2) * ones)
    value, exact = quadrature_float32(single, PHASES[-1]), quadrature(single.astype(np.float64), PHASES[-1])
    assert worst(value, exact) < 1e-6  # measured: 2.8e-7; 1.3e-2 if lengths were differences of places


def test_limits_of_the_medium():
    # clear, almost clear, and infinite where nothing absorbs: the angle that is subtended
    ones = np.ones(4)
    h, x_a, infinite = np.float64([1, 1e-4, 3, 0.2]), np.float64([-2, -5, 0, 1]), np.inf * ones
    for dtype, bound in ((np.float64, 1e-6), (np.float32, 1e-6)):  # measured: 1.5e-7 and 1.2e-7
        for sigma_t in (0.0, 1e-30, 1e-12):
            clear = Segments(h, x_a, infinite, infinite, sigma_t * ones).astype(dtype)
            exact = np.arctan2(h, x_a) / (4 * np.pi * h)
            assert worst(quadrature_float32(clear, PHASES[0]), exact) < bound
    # opaque and infinite: e^{-2 sigma_t u} ahead of everything else
    thick = Segments(ones, x_a, infinite, infinite, 40 * ones)
    assert worst(quadrature_float32(thick, PHASES[0]), quadrature(thick, PHASES[0])) < 1e-6  # measured: 1.3e-7


@pytest.mark.parametrize("tolerance", sorted(TOLERANCES))
def test_tolerance_is_kept(tolerance):
    sets = [draw(2000, 99) for draw in (draw_lit_pieces, draw_pieces_behind, draw_pieces_across)]
    for function, exact in zip(PHASES, EXACT, strict=True):
        assert worst(quadrature_float32(DRAWN, function, tolerance=tolerance), exact) < tolerance
    # measured on sets of 8,000 and by a climb from the worst: 0.70, 0.51, 0.64 and 0.77 of the tolerance
    for part in (*sets, DRAWN[:1000]):
        for function in (*PHASES, *TABLES):
            exact = quadrature(part, function)
            reached = exact > 0  # a table may be 0 all along
            assert worst(quadrature_float32(part, function, tolerance=tolerance)[reached], exact[reached]) < tolerance


@pytest.mark.parametrize(
    ("tolerance", "function", "exact", "h", "x_a", "length"),
    [
        (1e-6, phase("hg", g=0.9), henyey_greenstein(0.9), 1.0322e-4, 0.0099899, 0.46583),
        (1e-4, phase("hg", g=0.9), henyey_greenstein(0.9), 1.0943e-4, 0.0165176, 0.684604),
        (1e-3, phase("cornette_shanks", g=-0.8), cornette_shanks(-0.8), 1.00971e-4, -0.194914, 0.765337),
        (1e-4, phase("tabulated", values=(1, 0)), tabulated((1, 0)), 0.5, -40.0, 0.02),
    ],
)
def test_tolerance_is_kept_where_it_was_hardest(tolerance, function, exact, h, x_a, length):
    # narrow in Y and thick: the depth must count by the ratio of the ends; and a table next to its zero
    value = quadrature_float32(
        Segments.between(*(np.array([a]) for a in (h, x_a, x_a + length, 1.0))), function, tolerance=tolerance
    )
    # measured: 1e-3, 3e-3, 0.03 and 7e-12 of the tolerance
    assert relative_error(value[0], oracle(h, x_a, x_a + length, 1.0, exact)) < tolerance


def test_fine_tables_in_chunks(monkeypatch):
    # a table of 181 values is a sum of its pieces, however many are held at once
    table = phase("tabulated", values=phase("hg", g=0.9).evaluate(np.linspace(-1, 1, 181)))
    some = DRAWN[:200]
    whole = quadrature_float32(some, table)
    assert worst(whole, quadrature(some, table)) < 1e-6  # measured: 1.6e-7
    monkeypatch.setattr(kinks, "PIECES", 50)
    np.testing.assert_array_equal(quadrature_float32(some, table), whole)
    assert quadrature_float32(some[:0], table).size == 0
    single = some[some.d_a <= 12].astype(np.float32)
    exact = quadrature(single.astype(np.float64), table)
    assert worst(quadrature_float32(single, table), exact) < 4e-6  # measured on 7,600: 1.9e-6


@pytest.mark.parametrize(("dtype", "heights"), [(np.float32, (1e-38, 1e-20, 1e-13)), (np.float64, (1e-307, 1e-200))])
def test_almost_through_the_light(dtype, heights):
    # no overflow and no NaN; beside the light h means nothing any more, and around it L h does not depend on it
    for h in heights:
        for x_a, x_b in ((-1, 2), (1, 2), (-3, -2), (1, np.inf), (-1, np.inf)):
            ends = (np.array([value], dtype) for value in (h, x_a, x_b, x_b - x_a, 1.0))
            height = 1e-15 if x_a < 0 < x_b else h
            near = Segments.between(*(np.array([value]) for value in (max(height, 1e-15), x_a, x_b, 1.0)))
            given = Segments(*ends)
            for function in (PHASES[0], PHASES[2], TABLES[2], PHASES[-1]):
                exact = quadrature(near, function) * (1e-15 / h if x_a < 0 < x_b else 1)
                with np.errstate(all="raise", under="ignore"):
                    value = quadrature_float32(given, function).astype(np.float64)
                assert worst(value, exact) < 3e-6, (h, x_a, x_b, function)


def test_a_table_has_no_lobe():
    # (1, 0) is 0 forwards: a quotient of its ends would be no scale at all
    assert lobe_ratio(TABLES[0]) == lobe_ratio(TABLES[1]) == 1
    assert lobe_ratio(phase("hg", g=0.9)) == pytest.approx(19**-0.75)


def test_tolerance_in_float32_and_for_sharper_lobes():
    given = quadrature_float32(DRAWN[:50], PHASES[0], tolerance=np.float32(1e-3))
    np.testing.assert_array_equal(given, quadrature_float32(DRAWN[:50], PHASES[0], tolerance=1e-3))
    for function in (phase("hg", g=0.95), phase("schlick", k=-0.95), phase("cornette_shanks", g=0.99)):
        with pytest.raises(ValueError, match=r"^tolerance must be left out"):
            quadrature_float32(DRAWN[:2], function, tolerance=1e-3)


@pytest.mark.parametrize(
    ("function", "nodes", "bound"),
    # measured on 30,000: 1.2e-5, 1.2e-4, 1.8e-3, 1.4e-6, 7.1e-5
    [
        (phase("hg", g=0.99), 12, 2e-5),
        (phase("hg", g=-0.99), 12, 1.5e-4),
        (phase("cornette_shanks", g=-0.99), 12, 2.2e-3),
        (phase("hg", g=-0.99), 24, 2e-6),
        (phase("cornette_shanks", g=-0.99), 24, 1e-4),
    ],
)
def test_sharper_lobes(function, nodes, bound):
    assert worst(quadrature_float32(DRAWN, function, nodes=nodes), quadrature(DRAWN, function)) < bound


def test_tolerance_spends_fewer_nodes_on_lit_pieces():
    pieces = draw_lit_pieces(4000, 99)
    mean = [nodes_needed(pieces, phase("hg", g=0.9), tolerance).mean() for tolerance in (1e-2, 1e-3, 1e-4, 1e-6)]
    # measured: 2.06, 2.63, 3.08, 4.89
    np.testing.assert_array_less(mean, [2.2, 3.0, 3.3, 5.4])
    counted = nodes_needed(pieces, PHASES[0], 1e-4)
    assert set(counted) <= {1, 2, 3, 4, 6, 8, 10}


def test_infinite_pieces_need_the_tuned_rule():
    ones = np.ones(1)
    whole = Segments(0.3 * ones, -3 * ones, np.inf * ones, np.inf * ones, ones)
    for tolerance, (most, _, _) in TOLERANCES.items():
        assert nodes_needed(whole, PHASES[0], tolerance) == most


def test_the_map():
    # v - v_a and its derivative at a node, by 30 digits of the definition v = q (X^2 - 1), Y = 1 / X
    v_a, span, q = 0.37, 2.1e3, 0.8
    mapping = RationalMap.of(np.array([v_a]), np.array([span]), np.array([1e-3]), q, 10.0)
    with mpmath.workdps(30):
        y_a, y_b = (1 / mpmath.sqrt(1 + mpmath.mpf(v) / q) for v in (v_a, v_a + span))

        def past(node):
            return q * (1 / (y_a - (y_a - y_b) * node) ** 2 - 1) - v_a

        for node in (0.0, 0.2, 0.9, 1.0):
            value, slope = mapping.at(node)
            assert abs(float(value[0] - past(node))) < 1e-12 * span
            assert relative_error(slope[0], mpmath.diff(past, node)) < 1e-11
    # nothing is left of e^{-H (v - v_a)} beyond clip / H
    assert RationalMap.of(np.array([v_a]), np.array([span]), np.array([0.1]), q, 10.0).span == 100


def test_rules_are_rules():
    for count, rule in RULES.items():
        assert len(rule.nodes) == len(rule.weights) == count
        assert np.all(np.diff([0, *rule.nodes, 1]) > 0)
        assert np.min(rule.weights) > 0


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("nodes", {"nodes": 11}),
        ("tolerance", {"tolerance": 0.5}),
        ("nodes", {"nodes": 12, "tolerance": 1e-3}),
    ],
)
def test_bad_options_are_named(name, options):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        quadrature_float32(DRAWN[:2], PHASES[0], **options)
