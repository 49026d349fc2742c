"""The main estimator agrees with `volpath`, and what is wrong with it on purpose does not.

`volpath` takes 32 passes of 16 samples: on sphere.xml at 64 x 64 its image mean is then known to 0.11 %.
"""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable

import numpy as np
import pytest

from reference import integrator
from reference.agreement import LARGEST_Z, MeanTest, check_against_volpath, image_mean_test
from reference.convergence import Estimate, converge
from reference.estimators import Equiangular, Volpath
from reference.goal import Goal
from reference.integrator import SingleScattering, mi
from scenes.loader import load
from scenes.model import Scene

# the fewest passes, however fast the machine is: the test's power must not depend on it
SHORT = Goal(rel_error=0.999)


def sphere(**parameters: object) -> Scene:
    return load("sphere", size=(64, 64), **parameters)


def main_estimate(scene: Scene, change: Callable[[Equiangular], object] = lambda _: None) -> Estimate:
    # under volpath's convention, as check_against_volpath does it
    estimator = Equiangular(scene, light_share=1 - mi.math.ShadowEpsilon)
    change(estimator)
    return converge(estimator, SHORT)


@pytest.fixture(scope="module")
def isotropic() -> Estimate:
    return converge(Volpath(sphere()), SHORT)


@pytest.fixture(scope="module")
def henyey_greenstein() -> Estimate:
    return converge(Volpath(sphere(phase="hg", g=0.6)), SHORT)


def test_agreement(isotropic: Estimate) -> None:
    test = image_mean_test(main_estimate(sphere()), isotropic)
    assert test.agrees
    assert abs(test.z) < LARGEST_Z
    assert test.standard_error < 0.003


def test_agreement_under_an_anisotropic_phase_function(henyey_greenstein: Estimate) -> None:
    test = image_mean_test(main_estimate(sphere(phase="hg", g=0.6)), henyey_greenstein)
    assert test.agrees
    assert test.standard_error < 0.003


# +2 % would move the mean by only 0.4 %, for thicker fog scatters more and lets less through
@pytest.mark.parametrize(
    "parameters", [{"sigma_t": 0.105}, {"albedo": 0.91}, {"intensity": 30.5}, {"phase": "hg"}], ids=str
)
def test_another_scene_does_not_agree(parameters: dict, isotropic: Estimate) -> None:
    # measured z: 9.3, -7.0, -16, -134
    assert not image_mean_test(main_estimate(sphere(**parameters)), isotropic).agrees


def test_the_sign_of_g_matters(henyey_greenstein: Estimate) -> None:
    assert not image_mean_test(main_estimate(sphere(phase="hg", g=-0.6)), henyey_greenstein).agrees


def test_a_moved_light_does_not_agree(isotropic: Estimate) -> None:
    def move(estimator: Equiangular) -> None:
        parameters = mi.traverse(estimator.mitsuba.scene)
        (key,) = [key for key in parameters.keys() if key.endswith(".position")]  # noqa: SIM118
        parameters[key] = parameters[key] + mi.Vector3f(0, 0.05, 0)
        parameters.update()

    # measured z: 27
    assert not image_mean_test(main_estimate(sphere(), move), isotropic).agrees


def test_light_that_reaches_the_fog_unattenuated_does_not_agree(isotropic: Estimate) -> None:
    def drop(estimator: Equiangular) -> None:
        estimator.integrator.light_share = 0.0

    assert not image_mean_test(main_estimate(sphere(), drop), isotropic).agrees


SEES = "active & sees(scene, ds, margin, active)"


@pytest.mark.parametrize(
    ("method", "right", "wrong"),
    [
        ("scattering", "through_fog + leg", "leg"),  # the eye's leg is not attenuated
        ("_leg", SEES, f"({SEES} if margin == SURFACE_MARGIN else mi.Bool(active))"),  # no shadows in fog
        ("scattering", "* inverse_pdf", "* path.fog_length"),  # as if distances were uniform
        ("surface", "path.fog_length + leg", "leg"),
        ("_leg", SEES, f"({SEES} if margin == FOG_MARGIN else mi.Bool(active))"),  # no shadows on surfaces
        ("surface", "+= value", "+= value / dr.maximum(si.to_local(ds.d).z, 0.01)"),  # no cosine
    ],
)
def test_a_mistake_in_the_integrator_does_not_agree(
    method: str, right: str, wrong: str, isotropic: Estimate, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = textwrap.dedent(inspect.getsource(getattr(SingleScattering, method)))
    assert source.count(right) == 1
    made: dict[str, Callable] = {}
    exec(source.replace(right, wrong), vars(integrator), made)
    monkeypatch.setattr(SingleScattering, method, made[method])
    assert not image_mean_test(main_estimate(sphere()), isotropic).agrees


def test_the_check_of_the_command_line() -> None:
    check = check_against_volpath(load("sphere", size=(32, 32)), SHORT)
    assert check.test.agrees
    # stopping short of the light brightens by e^(sigma_t d ShadowEpsilon) - 1: measured 3.1e-4
    assert 1e-4 < check.shift < 1e-3


def synthetic(layers: dict[str, tuple[float, float]]) -> Estimate:
    """An estimate of these image means and their errors."""
    return Estimate(
        mean={},
        standard_error={},
        image_mean={layer: np.full(3, mean) for layer, (mean, _) in layers.items()},
        image_error={layer: np.full(3, error) for layer, (_, error) in layers.items()},
        passes=32,
        rel_error=0.1,
        reached=True,
        seconds=1.0,
    )


def test_the_arithmetic_of_the_test() -> None:
    ours = synthetic({"scattering": (1.5, 0.03), "surface": (0.5, 0.0)})
    test = image_mean_test(ours, synthetic({"composite": (2.1, 0.04)}))
    assert test.difference == pytest.approx(0.05)
    assert test.standard_error == pytest.approx(0.025)
    assert test.z == pytest.approx(2)
    assert test.agrees
    assert not MeanTest(difference=-0.1, standard_error=0.02).agrees
