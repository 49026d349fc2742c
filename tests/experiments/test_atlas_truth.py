"""The atlas's truth against mpmath, on segments drawn from its grid."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from exact_airlight import henyey_greenstein, isotropic, oracle, rayleigh, relative_error

from analytic import MODELS
from experiments.atlas.atlas import PHASES
from experiments.atlas.errors import make_case, phase_label
from experiments.atlas.grid import make_grid
from experiments.atlas.truth import worst_of_truth

GRID = make_grid()
EXACT = {
    "isotropic": isotropic,
    "rayleigh": rayleigh,
    "hg_0.6": henyey_greenstein(0.6),
    "hg_0.9": henyey_greenstein(0.9),
}


@pytest.mark.parametrize("phase", PHASES, ids=phase_label)
def test_truth_on_random_segments(phase):
    case = make_case(GRID, phase, "float32")
    s = case.segments.astype(np.float64)
    # x_a and the length are float32 numbers: their sum is exact
    assert np.array_equal(s.x_b - s.x_a, s.length)
    assert np.array_equal(s.x_b - s.length, s.x_a)
    for i in np.random.default_rng(2026).choice(len(s), 10, replace=False):
        exact_value = oracle(s.h[i], s.x_a[i], s.x_b[i], s.sigma_t[i], EXACT[phase_label(phase)])
        assert relative_error(case.truth[i], exact_value) < 1e-13  # measured: 4.8e-15 on 160 segments


def test_what_the_page_says_of_the_truth(monkeypatch):
    """Found by the oracle; a truth that is wrong by 1e-9 is found out."""
    hg = PHASES[3]
    assert 0 < worst_of_truth(GRID, hg, 5) < 1e-13  # measured: 1.8e-15
    truth = MODELS["quadrature"]
    wrong = dataclasses.replace(truth, function=lambda segments, phase: truth.function(segments, phase) * (1 + 1e-9))
    monkeypatch.setitem(MODELS, "quadrature", wrong)
    assert worst_of_truth(GRID, hg, 5) == pytest.approx(1e-9, rel=1e-4)
