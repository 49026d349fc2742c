"""The airlight models on the GPU against float64 where nothing occludes, on the rays of scenes.model.Camera.

Worst relative errors are those measured on llvmpipe (LLVM 15, 256 bits); other processors round reciprocals and square
roots differently, so a tolerance is about three times its measurement.
"""

from __future__ import annotations

import numpy as np
import pytest
from closed_form_moduli import rounding_unit
from oracles import soft_spot_airlight, spot_airlight, whole_ray_airlight
from scene_files import COLLINEAR, point, spot, write_scene
from shaded_pieces import brightness

from analytic import MODELS
from analytic.segments import Segments
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from scenes.loader import load
from scenes.model import Scene

QUADRATURE = "lit_intervals+quadrature"
# nothing is in the map, and an unoccluded ray is one lit interval whatever the steps
QUICK = {"steps": 4, "shadow_map": 8}
PHASES = [
    {"phase": "isotropic"},
    {"phase": "rayleigh"},
    {"phase": "hg", "g": 0.6},
    {"phase": "hg", "g": -0.5},
    {"phase": "hg", "g": 0.9},
    {"phase": "schlick", "k": 0.8},
    {"phase": "cornette_shanks", "g": 0.8},
    {"phase": "tabphase"},
]
# each closed form with one of each phase function that it takes
CLOSED_FORMS = [
    pytest.param(name, {"phase": kind} | parameters, id=f"{name} {kind}")
    for kind, parameters in {
        "isotropic": {},
        "rayleigh": {},
        "hg": {"g": 0.6},
        "schlick": {"k": 0.8},
        "cornette_shanks": {"g": -0.5},
    }.items()
    for name, model in AIRLIGHT_MODELS.items()
    if not model.any_light and kind in (model.phases or ())
]
HARD_SPOTS = {
    "down": spot("0.3, 3.5, 0", "0, 0, 0", 24, 24),
    "towards the eye": spot("0.2, 0.5, -3", "0, 0.2, 5", 30, 30),
    "away from the eye": spot("0.4, 0.6, 5.5", "0, 0, -3", 20, 20),
    # beyond 60 degrees a spot has a cube map
    "wide": spot("0.3, 2, 0", "0, 0, 0.5", 75, 75),
}
SOFT_SPOTS = [
    spot("0.3, 3.5, 0", "0, 0, 0", 24, 12),
    spot("0.3, 3.5, 0", "0, 0, 0", 30, 0),
    spot("0.2, 0.5, -3", "0, 0.2, 5", 30, 10),
]


def worst(image: np.ndarray, exact: np.ndarray) -> float:
    return float((np.abs(image - exact) / exact).max())


def unlike(image: np.ndarray, exact: np.ndarray) -> float:
    """Largest error relative to the brightest pixel."""
    return float(np.abs(image - exact).max() / exact.max())


@pytest.mark.parametrize("parameters", PHASES, ids=str)
def test_quadrature(parameters: dict, draw) -> None:
    scene = load("empty", size=(64, 64), **parameters)
    # measured 7.3e-7, 7.6e-7, 8.0e-7, 8.0e-7, 1.2e-6, 7.9e-7, 1.0e-6 and 8.9e-7
    assert worst(draw(scene, QUADRATURE, **QUICK).scattering, whole_ray_airlight(scene)) < 4e-6


@pytest.mark.parametrize("parameters", PHASES, ids=str)
def test_many_steps_of_riemann(parameters: dict, draw) -> None:
    scene = load("empty", size=(64, 64), **parameters)
    exact = whole_ray_airlight(scene)
    # the sum of 2,048 float32 terms: measured 3.2e-6 to 1.0e-5
    assert worst(draw(scene, "uniform_march+riemann", steps=2048, shadow_map=8).scattering, exact) < 3e-5
    # midpoint rule: four times the steps, a sixteenth of the error, until rounding is reached
    coarse, fine = (draw(scene, "uniform_march+riemann", steps=n, shadow_map=8).scattering for n in (16, 64))
    assert np.abs(fine - exact).mean() < np.abs(coarse - exact).mean() / 8


@pytest.mark.parametrize("sigma_t", [1e-4, 0.1, 2.0])
def test_weng2010(sigma_t: float, draw) -> None:
    scene = load("empty", size=(64, 64), sigma_t=sigma_t)
    # measured 5.1e-7, 6.4e-7 and 3.7e-6: the driver's exp() of an optical depth up to 16 decides
    assert worst(draw(scene, "Weng2010", **QUICK).scattering, whole_ray_airlight(scene)) < 1e-5


def whole_rays(scene: Scene) -> Segments:
    """The pixels' rays as the driver cuts them, 16 mean free paths behind the light's projection, float64."""
    origin, direction, t_max = scene.camera.rays()
    to_light = scene.lights[0].position - origin
    t_h = np.einsum("hwi,hwi->hw", to_light, direction).ravel()
    h = np.linalg.norm(np.cross(to_light, direction), axis=-1).ravel()
    sigma_t = np.full_like(h, np.ravel(scene.medium.sigma_t)[0])
    return Segments.between(h, -t_h, np.minimum(t_max.ravel(), np.maximum(t_h, 0) + 16 / sigma_t) - t_h, sigma_t)


@pytest.mark.parametrize("sigma_t", [0.02, 0.1, 2.0])
@pytest.mark.parametrize(("name", "parameters"), CLOSED_FORMS)
def test_closed_forms(name: str, parameters: dict, sigma_t: float, draw) -> None:
    scene = load("empty", size=(32, 32), sigma_t=sigma_t, **parameters)
    image = draw(scene, f"lit_intervals+{name}", **QUICK).scattering[..., 0].ravel()
    rays = whole_rays(scene)
    unit = np.ravel(scene.medium.sigma_s)[0] * scene.lights[0].intensity[0] * brightness(name, scene.phase)
    # the form's own value in float64, right or wrong
    form = MODELS[name].function(rays, scene.phase) * unit
    allowed = 2e-6 + 4 * 2**-24 * (1 + rays.sigma_t * rays.d_a)
    beyond = np.abs(image - form) - allowed * np.abs(form)
    # measured: the forms of two terms stay within what any shader is allowed; beyond it the print is off by 0.02 units
    # of its conditioning at most, the others by 1.7
    limit = {"weng2010": 0.0, "one_ei": 0.0, "weng2010:printed": 0.06}.get(name, 2.5)
    assert np.max(beyond / (unit * rounding_unit(name, scene.phase, rays))) < limit


@pytest.mark.parametrize(("sigma_t", "tolerance"), [(1e-4, 3e-6), (2.0, 1e-5)])
def test_quadrature_in_thin_and_thick_fog(sigma_t: float, tolerance: float, draw) -> None:
    for parameters in PHASES:
        scene = load("empty", size=(64, 64), sigma_t=sigma_t, **parameters)
        # measured at most 1.2e-6 thin and 3.7e-6 thick
        assert worst(draw(scene, QUADRATURE, **QUICK).scattering, whole_ray_airlight(scene)) < tolerance


@pytest.mark.parametrize("technique", [QUADRATURE, "Weng2010", "lit_intervals+one_ei"])
def test_coloured_fog(technique: str, tmp_path, draw) -> None:
    scene = write_scene(tmp_path, sigma_t="<rgb name='sigma_t' value='0.05, 0.1, 0.4'/>")
    exact = whole_ray_airlight(scene)
    assert np.ptp(exact / exact[..., :1], axis=-1).min() > 0.1
    # measured 1.1e-6
    assert worst(draw(scene, technique, **QUICK).scattering, exact) < 4e-6


def test_two_lights_add_up(tmp_path, draw) -> None:
    first, second = point(0.3, 2.6, 0), point(-1, -0.5, 1, "<rgb name='intensity' value='3, 5, 1'/>")
    apart = [draw(write_scene(tmp_path, light), QUADRATURE, **QUICK) for light in (first, second)]
    scene = write_scene(tmp_path, first + second)
    both = draw(scene, QUADRATURE, **QUICK)
    # additive blending rounds once
    assert worst(both.scattering, np.float64(apart[0].scattering) + apart[1].scattering) <= 2**-23
    assert (both.lit_intervals == 2).all()
    # measured 2.4e-6, where a ray passes close to the second light
    assert worst(both.scattering, whole_ray_airlight(scene)) < 8e-6


@pytest.mark.parametrize("name", HARD_SPOTS)
@pytest.mark.parametrize("technique", [QUADRATURE, "Weng2010"])
def test_hard_spot(name: str, technique: str, tmp_path, draw) -> None:
    scene = write_scene(tmp_path, HARD_SPOTS[name])
    exact = spot_airlight(scene)
    image = draw(scene, technique, **QUICK).scattering
    assert ((image > 0) == (exact > 0)).mean() > 0.999
    lit = (exact > 0) & (image > 0)
    relative = np.abs(image - exact)[lit] / exact[lit]
    # Where a ray only grazes the cone, float32 knows the piece's ends but not its length: measured 2.6e-3 in a single
    # pixel, 4.0e-5 at the 99th percentile, 8.9e-6 at the 95th, 3.2e-5 of the brightest pixel, 3.6e-7 in the mean.
    assert np.percentile(relative, [95, 99]) == pytest.approx([0, 0], abs=1e-4)
    assert np.percentile(relative, 50) < 2e-6
    assert unlike(image, exact) < 1e-4
    assert image.mean() == pytest.approx(exact.mean(), rel=1e-6)


@pytest.mark.parametrize("name", HARD_SPOTS)
def test_hard_spot_by_many_steps_of_riemann(name: str, tmp_path, draw) -> None:
    scene = write_scene(tmp_path, HARD_SPOTS[name])
    exact = spot_airlight(scene)
    errors = [
        np.abs(draw(scene, "uniform_march+riemann", steps=n, shadow_map=8).scattering - exact).mean() / exact.mean()
        for n in (64, 512, 4096)
    ]
    # first order, for a step at the cone's edge is lit wholly or not at all; measured at most 1.6e-3 in the end
    assert errors[2] < 3e-3
    assert errors[0] > 3 * errors[1] > 9 * errors[2]


@pytest.mark.parametrize("light", SOFT_SPOTS)
def test_soft_spot(light: str, tmp_path, draw) -> None:
    scene = write_scene(tmp_path, light, size=(32, 32))
    exact = soft_spot_airlight(scene)
    # point samples see the falloff as it is: measured 6.9e-5 of the brightest pixel at most, 5.6e-6 in the mean
    samples = draw(scene, "uniform_march+riemann", steps=4096, shadow_map=8).scattering
    assert unlike(samples, exact) < 2e-4
    assert samples.mean() == pytest.approx(exact.mean(), rel=2e-5)
    # 24 nodes pass over the kinks at the edge of the beam: measured 1.0e-3 of the brightest pixel, 1.2e-4 in the mean
    nodes = draw(scene, QUADRATURE, **QUICK).scattering
    assert unlike(nodes, exact) < 3e-3
    assert nodes.mean() == pytest.approx(exact.mean(), rel=4e-4)


@pytest.mark.parametrize("size", [(40, 24), (24, 40)])
@pytest.mark.parametrize("eye", ["3, 2, 5", "-1, 4, 0.5"])
def test_rays_of_any_camera(size: tuple[int, int], eye: str, tmp_path, draw) -> None:
    """An error of a camera ray by a hundredth of a pixel, or of the near or far plane, would show."""
    scene = write_scene(tmp_path, point(1.2, 0.4, 0.9), size=size, eye=eye, far=6)
    exact = whole_ray_airlight(scene)
    # measured 6.2e-6, where a ray passes the light at a hundredth of its distance
    assert worst(draw(scene, QUADRATURE, **QUICK).scattering, exact) < 2e-5


@pytest.mark.parametrize("settings", COLLINEAR.values(), ids=COLLINEAR.keys())
def test_rays_that_point_at_the_light_or_away_from_it(settings: dict, tmp_path, draw) -> None:
    scene = write_scene(tmp_path, **settings)
    exact = whole_ray_airlight(scene)
    # measured 2.4e-5 with the light at the eye, where the near plane is a hundredth away and float32 places it to 2e-5
    assert worst(draw(scene, QUADRATURE, **QUICK).scattering, exact) < 1e-4
