"""The checks of the audit are checks: an equation, or a truth, that is off by 1e-12 is noticed by its own entry."""

from __future__ import annotations

import inspect
import re
from types import ModuleType

import pytest
from mpmath import mp, mpf

from analytic.thesis import absorption_and_scattering, combined, first_formulation, second_formulation, transport
from analytic.thesis.audit import LARGEST_RIGHT, audit
from analytic.thesis.checks import chapter_3, formulations
from analytic.thesis.checks import combined as combined_checks
from analytic.thesis.checks import transport as transport_checks
from analytic.thesis.checks.parameters import INSIDE, SEGMENTS, with_phases
from analytic.thesis.checks.sampling import RAYS
from analytic.thesis.sampling import algorithm_4_2_repaired

SMALL = 1 + mpf("1e-12")
MODULES = [absorption_and_scattering, transport, first_formulation, second_formulation, combined]
# by name alone it is not told which entry they belong to
OTHERS = [
    (transport, "eq_14_source", "14"),
    (first_formulation, "i_0", "20"),
    (first_formulation, "i_1", "23"),
    (second_formulation, "j_0", "26"),
    (second_formulation, "j_1", "26"),
    (first_formulation, "closed_form_in_v", "24"),
    (second_formulation, "closed_form_in_w_repaired", "29"),
    (combined, "figure_4_11_repaired", "Fig. 4.11"),
    # what `combined_airlight` is beside: the truths of its parts and of "two are enough"
    (combined, "figure_4_9", "Fig. 4.11"),
    (first_formulation, "eq_21_repaired", "Fig. 4.11"),
    (first_formulation, "eq_21_repaired", "30"),
    (absorption_and_scattering, "eq_12", "11"),
    (absorption_and_scattering, "eq_8", "7"),
    (absorption_and_scattering, "eq_8", "13"),
    (transport, "eq_15", "14"),
]


def found_in(module: ModuleType):
    """Each function of a module that is an equation, with the number that it has in its name."""
    for name, function in vars(module).items():
        number = re.fullmatch(r"eq_(\d+)(_repaired)?", name)
        if number and inspect.isfunction(function):
            yield module, name, number[1]


JUDGED = [*(found for module in MODULES for found in found_in(module)), *OTHERS]


def scale(monkeypatch, module, name):
    function = getattr(module, name)
    monkeypatch.setattr(module, name, lambda *arguments: function(*arguments) * SMALL)


@pytest.fixture
def few(monkeypatch):
    """Six of the 39 segments, two at each place, and no word of the series: what is off is off on these."""
    segments = SEGMENTS[15:21]
    for checks in (transport_checks, formulations, combined_checks):
        monkeypatch.setattr(checks, "SEGMENTS", segments)
    for checks in (transport_checks, formulations):
        monkeypatch.setattr(checks, "with_phases", lambda: with_phases(segments))
    monkeypatch.setattr(combined_checks, "INSIDE", [segment for segment in segments if segment in INSIDE])
    for series in ("what_the_series_does", "in_short"):
        monkeypatch.setattr(formulations, series, lambda: "")


def test_every_equation_has_a_function_that_is_scaled():
    assert {number for _, _, number in JUDGED} == {*map(str, range(1, 33)), "Fig. 4.11"}


@pytest.mark.parametrize(("module", "name", "equation"), JUDGED, ids=[f"{n} in {e}" for _, n, e in JUDGED])
def test_an_equation_off_by_1e_12_is_wrong(few, monkeypatch, module, name, equation):
    scale(monkeypatch, module, name)
    (entry,) = audit([equation])
    # where nothing is repaired, both residuals are one
    assert entry.residual_repaired > LARGEST_RIGHT
    assert entry.verdict.startswith("wrong: ")


@pytest.mark.parametrize(
    ("checks", "truth", "equations"),
    [
        (chapter_3, "particles", ("1", "2", "4", "5", "10")),
        (chapter_3, "slabs", ("3", "9", "11")),
        (transport_checks, "slabs", ("13",)),
        (transport_checks, "lamp", ("14", "15")),
        (transport_checks, "airlight", ("16", "17")),
        (combined_checks, "airlight", ("30", "Fig. 4.11")),
    ],
)
def test_a_truth_off_by_1e_12_is_noticed(few, monkeypatch, checks, truth, equations):
    scale(monkeypatch, checks, truth)
    for entry in audit(equations):
        assert entry.residual_repaired > LARGEST_RIGHT, entry


READINGS = [
    (absorption_and_scattering, "3", ("eq_3_printed_product", "eq_3_printed_at_the_end"), "eq_3_repaired"),
    (absorption_and_scattering, "6", ("eq_6_printed_product", "eq_6_printed_at_the_end"), "eq_6_repaired"),
    (absorption_and_scattering, "11", ("eq_11_printed_product", "eq_11_printed_at_the_end"), "eq_11_repaired"),
    (combined, "30", ("eq_30_printed_sum", "eq_30_printed_difference"), "eq_30_repaired"),
]


@pytest.mark.parametrize(("module", "equation", "readings", "repaired"), READINGS, ids=[r[1] for r in READINGS])
@pytest.mark.parametrize("which", [0, 1])
def test_the_best_reading_counts(few, monkeypatch, module, equation, readings, repaired, which):
    """Were either of both right, the equation would be."""
    monkeypatch.setattr(module, readings[which], getattr(module, repaired))
    (entry,) = audit([equation])
    assert entry.verdict == "right"


@pytest.mark.parametrize(
    ("equation", "quoted"),
    [
        ("11", ("0.19 with beta(x') x'", "0.16 with every coefficient taken at x")),
        ("13", ("off by 0.23",)),
        ("16", ("off by up to 63",)),
        ("27", ("off by up to 1.3e+38", "off by up to 4.3e+44")),
        ("30", ("the sum is off by up to 4e+10", "the difference by up to 4.9e+08")),
        ("Alg. 4.1", ("0.011 with 64, 0.011 with 256, 0.0016 with 1024 steps", "the first dark one")),
        ("Alg. 4.2", ("the eye inside without a polygon 1", "GLSL refuses it")),
        (
            "Fig. 4.11",
            (
                "needs 4 complex Ei (and 2 real) by Figure 4.9 and 3 (and 2 real)",
                "needs 3 by Figure 4.11 and 2 by Eq. 21",
            ),
        ),
    ],
)
def test_what_findings_quote(equation, quoted):
    (entry,) = audit([equation])
    for text in quoted:
        assert text.lower() in entry.finding.lower(), entry


def test_the_readings_of_eq_3_are_two():
    """They differ where the coefficient does: 0.7 e^{-x / 2} over a depth of 2, by hand."""
    with mp.workdps(45):
        beta, x = chapter_3.VARYING[0], mpf(2)
        # int_0^2 0.7 x e^{-x/2} dx = 2.8 (1 - 2 / e) and 0.7 e^{-1} 2
        for reading, exponent in (
            (absorption_and_scattering.eq_3_printed_product, mpf("2.8") * (1 - 2 / mp.e)),
            (absorption_and_scattering.eq_3_printed_at_the_end, mpf("1.4") / mp.e),
            (absorption_and_scattering.eq_3_repaired, mpf("1.4") * (1 - 1 / mp.e)),
        ):
            # measured: 1e-45
            assert abs(reading(1, beta, x) / mp.exp(-exponent) - 1) < mpf(10) ** -40


def test_the_reading_of_eq_11_at_the_end_by_hand():
    with mp.workdps(45):
        x = mpf(2)
        # beta_ex = s, beta_sc = 1 / 2, glow = 1 + s: the exponent x int_s^x s' ds', the source (1 + x) / 2
        value = absorption_and_scattering.eq_11_printed_at_the_end(
            3, lambda s: s, lambda s: mpf(1) / 2, lambda s: 1 + s, x
        )
        depth = lambda s: x * (x**2 - s**2) / 2  # noqa: E731
        exact = 3 * mp.exp(-depth(0)) + mp.quad(lambda s: mp.exp(-depth(s)) * (1 + x) / 2, [0, 1, 2])
        # measured: 1e-45
        assert abs(value / exact - 1) < mpf(10) ** -40


def test_the_segments_lie_before_around_and_behind_the_projection():
    before = [s for s in SEGMENTS if s.x_b < s.x_h]
    behind = [s for s in SEGMENTS if s.x_h < s.x_a]
    assert len(before) == len(behind) == len(INSIDE) == len(SEGMENTS) / 3 == 13
    assert len(set(SEGMENTS)) == 39


def test_the_three_ei_form_is_not_two(monkeypatch):
    """Were Eq. 21 the form with the terms of v_h = 1, the count would say so."""
    terms = (1 / (4 * mp.pi),)

    def three(segment):
        return combined.combined_airlight(segment, terms, terms, combined.figure_4_11_repaired)

    monkeypatch.setattr(first_formulation, "eq_21_repaired", three)
    (entry,) = audit(["Fig. 4.11"])
    assert "needs 3 by Figure 4.11 and 3 by Eq. 21" in entry.finding


def test_an_eye_inside_a_volume_without_a_polygon_sees_no_light():
    ray = RAYS["the eye inside without a polygon"]
    assert ray.front is None
    assert ray.final is None
    assert all(start == end for start, end in algorithm_4_2_repaired(ray))
