"""Whatever is handed in is a number, or is refused by the name of its argument; without a warning."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from analytic import MODELS, Medium, airlight, phase, transmittance
from analytic.models import AirlightModel
from analytic.models.model import by_name

ISOTROPIC = phase("isotropic")
FOG = Medium(0.15, 0.2)
SEGMENT = {"h": 1.0, "x_a": -1.0, "x_b": 1.0, "medium": FOG, "phase": ISOTROPIC}
NO_NUMBERS = ["abc", "1.0", {}, None, 1j, np.array([1 + 5j]), [[1.0, 2.0], [3.0]], 10**400, np.datetime64("2010-06-01")]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", NO_NUMBERS, ids=lambda value: str(value)[:20])
@pytest.mark.parametrize("name", ["h", "x_a", "x_b", "intensity"])
def test_what_is_no_number_is_refused_by_name(name, value):
    with pytest.raises(ValueError, match=f"^{name} must"):
        airlight(**SEGMENT | {name: value})


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", NO_NUMBERS, ids=lambda value: str(value)[:20])
def test_media_and_phase_functions_refuse_it_too(value):
    with pytest.raises(ValueError, match=r"^sigma_s must"):
        Medium(value, 0.2)
    with pytest.raises(ValueError, match=r"^sigma_t must"):
        Medium(0.1, value)
    with pytest.raises(ValueError, match=r"^albedo must"):
        Medium.from_albedo(value, 0.2)
    with pytest.raises(ValueError, match=r"^distance must"):
        transmittance(0.1, value)
    with pytest.raises(ValueError, match=r"^g must"):
        phase("hg", g=value)
    with pytest.raises(ValueError, match=r"^k must"):
        phase("schlick", k=value)
    with pytest.raises(ValueError, match=r"^values must"):
        phase("tabulated", values=value)
    with pytest.raises(ValueError, match=r"^cos_theta must"):
        ISOTROPIC.evaluate(value)


def test_integers_and_booleans_are_numbers():
    assert airlight(1, -1, 1, Medium(1, True), ISOTROPIC) == airlight(1.0, -1.0, 1.0, Medium(1.0, 1.0), ISOTROPIC)
    assert airlight(np.float32(1), [-1], (1,), FOG, ISOTROPIC).shape == (1,)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("h, x_a and x_b", {"h": [1.0, 2.0], "x_a": [-1.0, -2.0, -3.0]}),
        ("intensity", {"intensity": [1.0, 2.0, 3.0, 4.0], "medium": Medium([0.1, 0.2, 0.3], 0.4)}),
        ("model", {"model": []}),
        ("model", {"model": None}),
        ("steps", {"model": "riemann", "steps": 2.5}),
        ("steps", {"model": "riemann", "steps": True}),
        ("terms", {"model": "weng2010:minimax", "terms": "a"}),
        ("terms", {"model": "weng2010:taylor", "terms": 101}),
        ("nodes", {"model": "equiangular", "nodes": 0}),
        ("nodes", {"model": "quadrature_float32", "nodes": 11}),
        ("nodes", {"model": "quadrature_float32", "nodes": []}),
        ("tolerance", {"model": "quadrature_float32", "tolerance": 0.5}),
        ("tolerance", {"model": "quadrature_float32", "tolerance": []}),
        ("error", {"model": "sun2005:sized", "error": 0.0}),
        ("error", {"model": "sun2005:sized", "error": float("nan")}),
    ],
)
def test_shapes_and_options_are_refused_by_name(name, change):
    with pytest.raises(ValueError, match=rf"^{name} must"):
        airlight(**SEGMENT | change)


def test_objects_of_other_kinds():
    with pytest.raises(TypeError, match=r"^medium must"):
        airlight(**SEGMENT | {"medium": 0.2})
    for other in (type(ISOTROPIC), "isotropic", None):
        with pytest.raises(TypeError, match=r"^phase must"):
            airlight(**SEGMENT | {"phase": other})
    with pytest.raises(ValueError, match=r"^name must"):
        phase([])


@pytest.mark.parametrize(
    "function", [ISOTROPIC, phase("rayleigh"), phase("hg", g=0.7), phase("tabulated", values=(1, 2))]
)
def test_cosines_beyond_the_ends(function):
    assert function.evaluate(1 + 1e-7) == function.evaluate(1.0)
    for cosine in (1.5, -1.001, np.nan, np.inf):
        with pytest.raises(ValueError, match=r"^cos_theta must"):
            function.evaluate([0.0, cosine])


def test_what_float64_cannot_hold_is_infinite_without_a_warning():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert airlight(1e-200, -1.0, 1.0, FOG, ISOTROPIC, intensity=1e200) == np.inf
        assert transmittance(0.0, np.inf) == 1
    with pytest.raises(ValueError, match=r"^sigma_t must"):
        transmittance(np.inf, 0.0)


def test_media_are_equal_by_their_coefficients():
    assert Medium(0.1, 0.2) == Medium(0.1, 0.2)
    assert Medium(0.1, 0.2) != Medium(0.1, 0.3)
    assert Medium(0.1, 0.2) != Medium([0.1] * 3, 0.2)
    assert Medium(0.1, 0.2) != "fog"
    assert len({Medium(0.1, 0.2), Medium(0.1, 0.2), Medium(0.1, [0.2, 0.2, 0.3])}) == 2


def test_a_parameter_of_numpy_does_not_widen_float32():
    half = np.float32(0.5)
    for function in (phase("hg", g=np.float64(0.3)), phase("schlick", k=np.float64(0.3))):
        assert function.of_half_angle(half, half).dtype == np.float32


def test_the_record_of_a_model():
    record = MODELS["weng2010"]
    assert str(record).splitlines()[0] == "weng2010 (isotropic)"
    with pytest.raises(TypeError, match=r"^phases must"):
        AirlightModel("x", record.function, "c", "d", "e", phases="isotropic")
    with pytest.raises(ValueError, match="one name"):
        by_name(record, MODELS["riemann"], record)
