"""The airlight against 30-digit quadrature of the defining integral, its limits, and its refusals."""

from __future__ import annotations

import subprocess
import sys

import mpmath
import numpy as np
import pytest
from exact_airlight import (
    cornette_shanks,
    henyey_greenstein,
    isotropic,
    oracle,
    rayleigh,
    relative_error,
    schlick,
    tabulated,
)

from analytic import MODELS, Medium, airlight, phase, transmittance
from analytic.segments import Segments

ISOTROPIC = phase("isotropic")
FOG = Medium(0.15, 0.2)
# tables, the forward value last: a few values, and a peak that 181 of them resolve
FIVE = (0.5, 1.0, 1.5, 2.0, 5.0)
FINE = tuple(phase("hg", g=0.9).evaluate(np.linspace(-1, 1, 181)).tolist())

HARD = [  # h, x_a, x_b, sigma_t
    (1.0, -2.0, 3.0, 0.2),  # an ordinary segment around the light's projection
    (1.0, -8.0, -2.0, 0.3),  # before it
    (0.7, 1.0, 6.0, 1.5),  # behind it
    (1e-6, -5.0, 5.0, 0.1),  # almost through the light
    (1e-6, -1e6, 1e6, 1e-7),  # the same, 12 orders of magnitude of u on both sides
    (1e-6, 3.0, 4.0, 50.0),
    (100.0, -50.0, 80.0, 0.5),  # sigma_t h = 50
    (100.0, -1e-6, 0.0, 0.5),  # 1e-6 long
    (0.3, 7.0, 7.0 + 1e-6, 0.4),
    (0.3, -7.0 - 1e-6, -7.0, 0.4),
    (2.0, -1.0, 1e6, 1e-9),  # all but clear
    (2.0, -1.0, 1e6, 25.0),  # opaque
    (0.05, -3.0, np.inf, 0.7),
]
PHASES = [
    pytest.param(ISOTROPIC, isotropic, id="isotropic"),
    pytest.param(phase("rayleigh"), rayleigh, id="rayleigh"),
    pytest.param(phase("hg", g=0.95), henyey_greenstein(0.95), id="hg 0.95"),
    pytest.param(phase("hg", g=-0.8), henyey_greenstein(-0.8), id="hg -0.8"),
    pytest.param(phase("schlick", k=0.9), schlick(0.9), id="schlick 0.9"),
    pytest.param(phase("schlick", k=-0.6), schlick(-0.6), id="schlick -0.6"),
    pytest.param(phase("cornette_shanks", g=0.9), cornette_shanks(0.9), id="cornette_shanks 0.9"),
    pytest.param(phase("tabulated", values=FIVE), tabulated(FIVE), id="tabulated 5"),
]


@pytest.mark.parametrize(("function", "exact"), PHASES)
def test_quadrature_on_the_hard_corners(function, exact):
    for h, x_a, x_b, sigma_t in HARD:
        value = airlight(h, x_a, x_b, Medium(sigma_t, sigma_t), function, intensity=1 / sigma_t)
        # measured: 3e-14 at worst
        assert relative_error(value, oracle(h, x_a, x_b, sigma_t, exact)) < 1e-12, (h, x_a, x_b, sigma_t)


def test_quadrature_of_a_fine_table():
    # the oracle stops at every one of the 179 kinks, which takes its time
    exact = tabulated(FINE)
    for h, x_a, x_b, sigma_t in (HARD[0], HARD[6], HARD[9]):
        value = airlight(h, x_a, x_b, Medium(sigma_t, sigma_t), phase("tabulated", values=FINE), intensity=1 / sigma_t)
        assert relative_error(value, oracle(h, x_a, x_b, sigma_t, exact)) < 1e-12, (h, x_a, x_b, sigma_t)


def test_segments_with_and_without_kinks_keep_apart():
    # many segments at once are cut into different numbers of pieces, and give what each gives by itself
    random = np.random.default_rng(5)
    h, x_a = 10 ** random.uniform(-2, 1, 300), random.uniform(-9, 3, 300)
    x_b = x_a + 10 ** random.uniform(-3, 2, 300)
    table = phase("tabulated", values=FINE)
    alone = [float(airlight(*segment, FOG, table)) for segment in zip(h, x_a, x_b, strict=True)]
    np.testing.assert_allclose(airlight(h, x_a, x_b, FOG, table), alone, rtol=1e-13)
    halves = airlight(h, x_a, 0.5 * (x_a + x_b), FOG, table)
    assert np.all(halves < alone)


def test_quadrature_on_drawn_segments():
    random = np.random.default_rng(20)
    functions = [(ISOTROPIC, isotropic), (phase("hg", g=0.6), henyey_greenstein(0.6))]
    for n in range(24):
        h, length = 10 ** random.uniform(-6, 2), 10 ** random.uniform(-6, 6)
        sigma_t = 10 ** random.uniform(-8, np.log10(50)) / h
        x_a = -random.uniform(0, 1) * min(length, 30 / sigma_t) if n % 2 else h * random.uniform(-5, 5)
        function, exact = functions[n % 4 // 2]
        value = airlight(h, x_a, x_a + length, Medium(sigma_t, sigma_t), function, intensity=1 / sigma_t)
        # measured: 7e-14 at worst over 476 such segments with every phase function
        assert relative_error(value, oracle(h, x_a, x_a + length, sigma_t, exact)) < 1e-12, (h, x_a, length, sigma_t)


def eq_21(h, x_a, x_b, sigma_t, repaired):
    """Eq. 21 by mpmath's Ei: as printed, e^{k_t (x_a - x_b)} before the integral; repaired, e^{k_t (x_a - x_h)}."""
    with mpmath.workdps(40):
        h, x_a, x_b, k = (mpmath.mpf(value) for value in (h, x_a, x_b, sigma_t))

        def i_0(a, v):  # Eq. 20; mpmath's Ei has the branch that is continuous for constant Im z < 0
            z = mpmath.ei(a * v + 1j * a)
            return mpmath.sin(a) * z.real - mpmath.cos(a) * z.imag

        def v(x):
            return x / h + mpmath.sqrt(1 + (x / h) ** 2)

        prefactor = mpmath.exp(k * x_a) if repaired else mpmath.exp(k * (x_a - x_b))
        return prefactor / h * 2 / (4 * mpmath.pi) * (i_0(-k * h, v(x_b)) - i_0(-k * h, v(x_a)))


@pytest.mark.parametrize("x_a", [-2.0, 0.5])
def test_the_printed_prefactor_is_rejected_where_the_repaired_one_is_accepted(x_a):
    truth = oracle(1.0, x_a, 3.0, 0.2, isotropic)
    assert relative_error(eq_21(1.0, x_a, 3.0, 0.2, repaired=True), truth) < 1e-12
    # measured: 6e-17 repaired; the printed prefactor is off by 0.45
    assert relative_error(eq_21(1.0, x_a, 3.0, 0.2, repaired=False), truth) > 0.1
    for model in ("quadrature", "weng2010"):
        value = airlight(1.0, x_a, 3.0, Medium(0.2, 0.2), ISOTROPIC, 5.0, model)
        assert relative_error(value, truth) < 1e-12


def test_the_sign_of_g_matters():
    truth = oracle(1.0, -2.0, 3.0, 0.2, henyey_greenstein(0.6))
    medium = Medium(0.2, 0.2)
    assert relative_error(airlight(1.0, -2.0, 3.0, medium, phase("hg", g=0.6), 5.0), truth) < 1e-12
    assert relative_error(airlight(1.0, -2.0, 3.0, medium, phase("hg", g=-0.6), 5.0), truth) > 0.1


def test_weng2010_where_it_is_well_conditioned():
    # segments that contain the light's projection; measured over 20,000 of them: 3e-15 at worst
    random = np.random.default_rng(3)
    h = 10 ** random.uniform(-2, 1, 20_000)
    x_a, x_b = -h * 10 ** random.uniform(-1, 2, h.size), h * 10 ** random.uniform(-1, 2, h.size)
    sigma_t = 10 ** random.uniform(-4, 0.5, h.size) / h
    segments = Segments.between(h, x_a, x_b, sigma_t)
    exact = MODELS["quadrature"].function(segments, ISOTROPIC)
    closed = MODELS["weng2010"].function(segments, ISOTROPIC)
    bright = exact > 1e-300
    assert np.max(np.abs(closed[bright] / exact[bright] - 1)) < 2e-14


def test_riemann_converges_at_second_order():
    exact = float(airlight(1.0, -4.0, 5.0, FOG, phase("hg", g=0.5)))
    errors = [
        float(airlight(1.0, -4.0, 5.0, FOG, phase("hg", g=0.5), model="riemann", steps=n)) / exact - 1
        for n in (200, 400)
    ]
    assert abs(errors[0]) < 2e-4
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.01)


def test_clear_medium_is_the_angle_subtended():
    # sigma_t -> 0: L = I sigma_s / (4 pi h) (theta_b - theta_a), theta = 2 arctan(v) = pi/2 + arctan(x / h)
    h, x_a, x_b = np.array([0.5, 1e-3, 30.0]), np.array([-2.0, 0.3, -9.0]), np.array([np.inf, 0.7, 1e3])
    exact = (np.arctan(x_b / h) - np.arctan(x_a / h)) / (4 * np.pi * h)
    for model in ("quadrature", "weng2010"):
        value = MODELS[model].function(Segments.between(h, x_a, x_b, np.zeros(3)), ISOTROPIC)
        np.testing.assert_allclose(value, exact, rtol=1e-12)  # measured: 1e-13, from the subtraction of the angles here
    assert airlight(0.5, -2.0, 3.0, Medium(0.0, 0.0), ISOTROPIC) == 0


@pytest.mark.parametrize("model", ["quadrature", "weng2010"])
def test_an_infinite_segment_is_the_limit_of_long_ones(model):
    assert airlight(0.4, -3.0, np.inf, FOG, ISOTROPIC, model=model) == pytest.approx(
        float(airlight(0.4, -3.0, 300.0, FOG, ISOTROPIC, model=model)), rel=1e-13
    )


@pytest.mark.parametrize("model", sorted(MODELS))
@pytest.mark.parametrize(("x_a", "x_b"), [(-3.0, -0.5), (0.5, 4.0)])
def test_through_the_light_beside_the_segment(model, x_a, x_b):
    with mpmath.workdps(30):
        exact = mpmath.quad(lambda x: mpmath.exp(-0.2 * (x - x_a + abs(x))) / x**2, [x_a, x_b]) / (4 * mpmath.pi)
    value = airlight(0.0, x_a, x_b, Medium(0.2, 0.2), ISOTROPIC, 5.0, model)
    # 64 steps of the midpoint rule are off by 1e-3 where 1 / x^2 is steep
    assert relative_error(value, exact) < (3e-3 if model == "riemann" else 1e-13)


def test_through_the_light_uses_forward_and_backward_scattering():
    for x_a, x_b, cosine in ((-3.0, -0.5, 1.0), (0.5, 4.0, -1.0)):
        ratio = airlight(0, x_a, x_b, FOG, phase("hg", g=0.5)) / airlight(0, x_a, x_b, FOG, ISOTROPIC)
        assert ratio == pytest.approx(4 * np.pi * phase("hg", g=0.5).evaluate(cosine), rel=1e-13)


@pytest.mark.parametrize("model", sorted(MODELS))
@pytest.mark.parametrize(("x_a", "x_b"), [(-3.0, -0.5), (0.5, 4.0)])
def test_heights_too_small_to_matter_give_the_limit(model, x_a, x_b):
    limit = float(airlight(0.0, x_a, x_b, FOG, ISOTROPIC, model=model))
    assert airlight(1e-200, x_a, x_b, FOG, ISOTROPIC, model=model) == pytest.approx(limit, rel=1e-14)


@pytest.mark.parametrize("model", sorted(MODELS))
def test_the_light_itself(model):
    values = airlight(0.0, [-1.0, 0.0, -2.0, 0.0], [1.0, 1.0, 0.0, 0.0], FOG, ISOTROPIC, model=model)
    np.testing.assert_array_equal(values, [np.inf, np.inf, np.inf, 0.0])
    assert airlight(0.0, -1.0, 1.0, Medium(0.0, 0.2), ISOTROPIC, model=model) == 0
    assert airlight(0.3, 1.0, 1.0, FOG, ISOTROPIC, model=model) == 0


def test_broadcasting_and_channels():
    rgb = Medium([0.1, 0.2, 0.3], [0.2, 0.2, 0.4])
    h, x_b = np.linspace(0.1, 2, 4)[:, None], np.linspace(1, 3, 5)
    values = airlight(h, -1.0, x_b, rgb, ISOTROPIC, intensity=[1.0, 2.0, 3.0])
    assert values.shape == (4, 5, 3)
    one = airlight(h[2], -1.0, x_b[3], Medium(0.3, 0.4), ISOTROPIC, intensity=3.0)
    assert values[2, 3, 2] == pytest.approx(float(one[0]), rel=1e-15)
    assert airlight(0.5, -1.0, 1.0, FOG, ISOTROPIC).shape == ()
    assert airlight(np.ones((0, 2)), -1.0, 1.0, rgb, ISOTROPIC).shape == (0, 2, 3)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("h", {"h": -1e-9}),
        ("h", {"h": np.nan}),
        ("x_a", {"x_a": -np.inf}),
        ("x_a", {"x_a": np.nan}),
        ("x_b", {"x_b": -5.0}),
        ("x_b", {"x_b": np.nan}),
        ("intensity", {"intensity": -1.0}),
        ("intensity", {"intensity": np.nan}),
        ("model", {"model": "weng"}),
        ("phase", {"model": "weng2010", "phase": phase("rayleigh")}),
        ("steps", {"model": "riemann", "steps": 0}),
        ("x_b", {"model": "riemann", "x_b": np.inf}),
    ],
)
def test_bad_values_are_named(name, change):
    arguments = {"h": 1.0, "x_a": -1.0, "x_b": 1.0, "medium": FOG, "phase": ISOTROPIC, **change}
    with pytest.raises(ValueError, match=rf"^{name} must"):
        airlight(**arguments)


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("sigma_s", (-0.1, 0.2)),
        ("sigma_t", (0.1, np.nan)),
        ("sigma_t", (0.1, np.inf)),
        ("sigma_s", (0.3, 0.2)),
        ("sigma_s", ([0.1, 0.1, 0.3], 0.2)),
        ("sigma_t", (0.1, [0.2, 0.3])),
    ],
)
def test_bad_media_are_named(name, arguments):
    with pytest.raises(ValueError, match=f"^{name} must"):
        Medium(*arguments)


def test_media():
    medium = Medium.from_albedo([0.5, 1.0, 0.0], 0.4)
    np.testing.assert_array_equal(medium.sigma_s, [0.2, 0.4, 0.0])
    np.testing.assert_array_equal(medium.albedo, [0.5, 1.0, 0.0])
    assert Medium(0, 0).albedo == 0
    with pytest.raises(ValueError, match=r"^albedo must"):
        Medium.from_albedo(1.1, 0.4)
    np.testing.assert_allclose(transmittance([0.0, 0.5, 2.0], [np.inf, 2.0, np.inf]), [1, np.exp(-1), 0])
    with pytest.raises(ValueError, match=r"^distance must"):
        transmittance(0.1, -1.0)


def test_models_are_described():
    assert {"quadrature", "riemann", "weng2010"} <= set(MODELS)
    for model in MODELS.values():
        assert model.citation
        assert model.domain
        assert model.cost


def test_importing_is_light():
    # numpy and scipy alone, with what they bring
    code = (
        "import sys, numpy, scipy.special, scipy.interpolate; before = set(sys.modules); import analytic; "
        "print({name.split('.')[0] for name in set(sys.modules) - before} - set(sys.stdlib_module_names))"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() in ("{'analytic'}", "{'analytic', 'scipy'}", "{'scipy', 'analytic'}")


def test_a_model_computes_in_the_type_that_is_asked_for():
    h, x_b = np.linspace(0.1, 2, 200), np.linspace(1, 30, 200)
    double = airlight(h, -1.0, x_b, FOG, ISOTROPIC, model="weng2010")
    single = airlight(h, -1.0, x_b, FOG, ISOTROPIC, model="weng2010", dtype=np.float32)
    error = np.abs(single / double - 1)
    # measured: 4.9e-7 at worst; float64 would leave no trace
    assert 1e-8 < np.max(error) < 5e-6
    assert single.dtype == np.float64
    with pytest.raises(ValueError, match=r"^dtype must"):
        airlight(1.0, -1.0, 1.0, FOG, ISOTROPIC, dtype=np.float16)
