"""What the oracle is tried on: segments, phase functions and tables."""

from __future__ import annotations

import numpy as np
import pytest
from exact_airlight import cornette_shanks, henyey_greenstein, isotropic, rayleigh, schlick, tabulated
from mpmath import mp, mpf

from analytic import phase
from analytic.oracle import exact_airlight

FIVE = (0.5, 1.0, 1.5, 2.0, 5.0)
HARD = [  # h, x_a, x_b, sigma_t
    (1.0, -2.0, 3.0, 0.2),
    (0.7, 1.0, 6.0, 1.5),
    (1e-6, -5.0, 5.0, 0.1),  # almost through the light
    (1e-6, 3.0, 4.0, 50.0),  # an optical depth of 300 behind the light
    (100.0, -50.0, 80.0, 0.5),
    (0.3, -7.0 - 1e-6, -7.0, 0.4),  # 1e-6 long
    (2.0, -1.0, 1e6, 25.0),  # opaque
    (0.05, -3.0, np.inf, 0.7),
    (1.0, -2.0, np.inf, 0.0),
    (0.0, 0.5, 7.0, 0.3),  # on the light's axis, behind it and before it
    (0.0, -9.0, -0.25, 0.3),
]
PHASES = [
    pytest.param(phase("isotropic"), isotropic, id="isotropic"),
    pytest.param(phase("rayleigh"), rayleigh, id="rayleigh"),
    pytest.param(phase("hg", g=0.95), henyey_greenstein(0.95), id="hg 0.95"),
    pytest.param(phase("hg", g=-0.8), henyey_greenstein(-0.8), id="hg -0.8"),
    pytest.param(phase("schlick", k=0.9), schlick(0.9), id="schlick 0.9"),
    pytest.param(phase("cornette_shanks", g=0.9), cornette_shanks(0.9), id="cornette_shanks 0.9"),
    pytest.param(phase("tabulated", values=FIVE), tabulated(FIVE), id="tabulated 5"),
    pytest.param(phase("tabulated", values=(0.0, 1.0, 0.0)), tabulated((0.0, 1.0, 0.0)), id="tabulated 0 1 0"),
]
FUNCTIONS = [pytest.param(parameter.values[0], id=parameter.id) for parameter in PHASES]
TABLES = [(1.0, 1e-25), (1.0, 1e-9), (1.0, 1.0, 1e-18), (1.0, 1e-25, 1.0), (1.0, 0.0, 1.0), (0.0, 1e-25, 0.0, 1.0)]


def check_twenty_digits(segment, function):
    found, finer = exact_airlight(*segment, function, 20), exact_airlight(*segment, function, 50)
    with mp.workdps(90):
        assert found.bound <= mpf(10) ** -20 * found.value
        assert abs(found.value - finer.value) <= found.bound + finer.bound, segment
