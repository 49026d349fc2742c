"""The Python plugins: sampled as they are evaluated, equal to float64's phase functions, and at work in `volpath`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import mitsuba.chi2 as chi2
import numpy as np
import pytest

import reference.plugins  # noqa: F401  (registers them)
from analytic import phase
from reference.integrator import mi
from reference.plugins.phong import DIFFUSE, GLOSSY

# isort: split
import drjit as dr

PHASES = [
    *({"type": "schlick", "k": k} for k in (-0.9, -0.4, 0.0, 0.6, 0.95)),
    *({"type": "cornette_shanks", "g": g} for g in (-0.8, -0.3, 0.0, 0.5, 0.9)),
]
PHONGS = [
    {},
    {"exponent": 0.0},
    {"exponent": 4.5, "specular_reflectance": 0.7},
    {"exponent": 120.0, "diffuse_reflectance": 0.0},
    {"exponent": 10.0, "specular_reflectance": 0.0},
]
DIRECTIONS = [[0.0, 0.0, 1.0], [0.48, 0.6, 0.64], [-0.96, 0.0, 0.28]]


def exact(settings: dict):
    return phase(settings["type"], **{name: value for name, value in settings.items() if name != "type"})


def interaction(wi: object):
    mei = dr.zeros(mi.MediumInteraction3f)
    mei.wi = dr.normalize(mi.Vector3f(wi))
    mei.sh_frame = mi.Frame3f(mei.wi)
    return mei


def evaluated(settings: dict, cos_theta: np.ndarray) -> np.ndarray:
    """Values for light that arrives along -wi and leaves along wo."""
    mei, angle = interaction([0.0, 0.6, 0.8]), mi.Float64(np.arccos(cos_theta))
    wo = mi.Frame3f(-mei.wi).to_world(mi.Vector3f(dr.sin(angle), 0, dr.cos(angle)))
    value, pdf = mi.load_dict(settings).eval_pdf(mi.PhaseFunctionContext(None), mei, wo)
    assert np.array_equal(np.array(value)[0], np.array(pdf))
    return np.array(pdf)


@pytest.mark.parametrize("settings", PHASES, ids=str)
def test_a_phase_function_is_the_analytic_one(settings: dict) -> None:
    cosines = np.linspace(-1, 1, 201)
    # measured 6e-7 at worst
    np.testing.assert_allclose(evaluated(settings, cosines), exact(settings).evaluate(cosines), rtol=3e-6)


def test_the_sign_is_that_of_hg() -> None:
    cosines = np.linspace(-1, 1, 41)
    hg = evaluated({"type": "hg", "g": 0.8}, cosines)
    assert hg[-1] > 100 * hg[0]
    np.testing.assert_allclose(hg, phase("hg", g=0.8).evaluate(cosines), rtol=1e-5)


def test_the_order_of_tabphase_is_ours() -> None:
    cosines, values = np.linspace(-1, 1, 41), (0.5, 1.0, 1.5, 2.0, 5.0)
    theirs = evaluated({"type": "tabphase", "values": "0.5, 1, 1.5, 2, 5"}, cosines)
    np.testing.assert_allclose(theirs, phase("tabulated", values=values).evaluate(cosines), rtol=3e-6)


@pytest.mark.parametrize("settings", PHASES, ids=str)
@pytest.mark.parametrize("wi", DIRECTIONS[:2], ids=str)
def test_a_phase_function_is_sampled_as_it_is_evaluated(settings: dict, wi: list[float]) -> None:
    sample, pdf = chi2.PhaseFunctionAdapter(settings["type"], settings, wi=wi)
    test = chi2.ChiSquareTest(chi2.SphericalDomain(), sample, pdf, sample_dim=3, sample_count=200_000, res=51, ires=16)
    assert test.run(test_count=2 * len(PHASES), quiet=True), test.messages


@pytest.mark.parametrize("settings", PHASES, ids=str)
def test_a_phase_sample_has_its_own_density_and_the_right_distribution(settings: dict) -> None:
    mei, u = interaction([0.48, 0.6, 0.64]), (np.arange(20_000) + 0.5) / 20_000
    plugin, context = mi.load_dict(settings), mi.PhaseFunctionContext(None)
    wo, weight, pdf = plugin.sample(context, mei, mi.Float(0.5), mi.Point2f(mi.Float(u), mi.Float(u * 977 % 1)))
    assert np.all(np.array(weight) == 1)
    # measured 1e-6 at worst
    np.testing.assert_allclose(np.array(pdf), np.array(plugin.eval_pdf(context, mei, wo)[1]), rtol=4e-6)
    # equal steps of the first number are equal shares of the light; measured 7e-8
    cosines = -np.array(dr.dot(mi.Vector3d(wo), mi.Vector3d(mei.wi)))
    assert cosines.mean() == pytest.approx(exact(settings).mean_cosine, abs=3e-7)


@pytest.mark.parametrize("settings", PHONGS, ids=str)
@pytest.mark.parametrize("wi", DIRECTIONS, ids=str)
def test_phong_is_sampled_as_it_is_evaluated(settings: dict, wi: list[float]) -> None:
    sample, pdf = chi2.BSDFAdapter("phong", {"type": "phong", **settings}, wi=wi)
    test = chi2.ChiSquareTest(chi2.SphericalDomain(), sample, pdf, sample_dim=3, sample_count=200_000, res=51, ires=16)
    assert test.run(test_count=len(PHONGS) * len(DIRECTIONS), quiet=True), test.messages


def surface(wi: object):
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(wi)
    return si


def upper_hemisphere(count: int = 128):
    """Directions and the solid angles they stand for: Gauss-Legendre in z, equal steps around."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    z, angle = (grid.ravel() for grid in np.meshgrid((1 + nodes) / 2, 2 * np.pi * (np.arange(count) + 0.5) / count))
    sine = np.sqrt((1 - z) * (1 + z))
    return mi.Vector3f(sine * np.cos(angle), sine * np.sin(angle), z), np.tile(weights * np.pi / count, count)


def albedo(plugin, wi: list[float]) -> np.ndarray:
    wo, solid_angle = upper_hemisphere()
    return np.array(plugin.eval(mi.BSDFContext(), surface(wi), wo), dtype=np.float64) @ solid_angle


@pytest.mark.parametrize("settings", PHONGS, ids=str)
@pytest.mark.parametrize("component", [0xFFFFFFFF, GLOSSY, DIFFUSE])
def test_a_phong_sample_weighs_value_over_density(settings: dict, component: int) -> None:
    plugin, context, si = mi.load_dict({"type": "phong", **settings}), mi.BSDFContext(), surface(DIRECTIONS[1])
    context.component = component
    u = np.random.default_rng(4).random((3, 2000))
    bs, weight = plugin.sample(context, si, mi.Float(u[0]), mi.Point2f(u[1], u[2]))
    value, pdf = plugin.eval_pdf(context, si, bs.wo)
    assert np.array_equal(np.array(bs.pdf), np.array(pdf))
    sampled = np.array(pdf) > 0
    assert sampled.mean() > 0.5
    assert np.all(np.array(bs.wo.z)[sampled] > 0)
    assert not np.array(weight)[:, ~sampled].any()
    expected = np.array(value)[:, sampled] / np.array(pdf)[sampled]
    np.testing.assert_allclose(np.array(weight)[:, sampled], expected, rtol=1e-6)


@pytest.mark.parametrize("exponent", [0.0, 5.0, 80.0])
@pytest.mark.parametrize("wi", DIRECTIONS, ids=str)
def test_phong_reflects_no_more_than_it_receives(exponent: float, wi: list[float]) -> None:
    plugin = mi.load_dict(
        {"type": "phong", "diffuse_reflectance": 0.4, "specular_reflectance": 0.6, "exponent": exponent}
    )
    # the whole of kd and ks at normal incidence, measured to 2e-7; at a grazing angle a part of the lobe is below
    assert np.all(albedo(plugin, wi) < 1 + 1e-6)
    if wi == DIRECTIONS[0]:
        np.testing.assert_allclose(albedo(plugin, wi), 1, atol=1e-6)


def test_phong_is_reciprocal_and_black_from_behind() -> None:
    plugin, context = mi.load_dict({"type": "phong"}), mi.BSDFContext()
    one, _ = upper_hemisphere(32)
    order = mi.UInt32(np.random.default_rng(1).permutation(1024).astype(np.uint32))
    other = dr.gather(mi.Vector3f, one, order)
    there = np.array(plugin.eval(context, surface(one), other) / other.z)
    back = np.array(plugin.eval(context, surface(other), one) / one.z)
    # measured 2.4e-7
    np.testing.assert_allclose(there, back, rtol=1e-6)
    assert there.max() > 2 * there.min()
    assert not np.array(plugin.eval(context, surface(-one), -other)).any()
    assert not np.array(plugin.pdf(context, surface(one), -other)).any()
    both = mi.load_dict({"type": "twosided", "bsdf": {"type": "phong"}})
    # `twosided` mirrors both directions at the surface
    flip = mi.Vector3f(1, 1, -1)
    behind = np.array(both.eval(context, surface(one * flip), other * flip))
    np.testing.assert_allclose(behind, there * np.array(other.z), rtol=1e-6)


def test_a_sum_above_one_is_computed_as_it_stands() -> None:
    # the plugin knows textures, whose maxima may lie at different places; whoever loads a scene may refuse it
    plugin = mi.load_dict({"type": "phong", "diffuse_reflectance": 0.9, "specular_reflectance": 0.9})
    assert albedo(plugin, DIRECTIONS[0]) == pytest.approx(1.8, abs=2e-6)


def test_parameters_are_read_and_set_through_traverse() -> None:
    for settings, key in (({"type": "schlick", "k": 0.2}, "k"), ({"type": "cornette_shanks", "g": 0.2}, "g")):
        plugin = mi.load_dict(settings)
        parameters = mi.traverse(plugin)
        parameters[key] = -0.6
        parameters.update()
        mei = interaction([0.0, 0.0, 1.0])
        _, pdf = plugin.eval_pdf(mi.PhaseFunctionContext(None), mei, mei.wi)
        assert pdf[0] == pytest.approx(float(phase(settings["type"], **{key: -0.6}).evaluate(-1)), rel=1e-5)
        assert f"{key} = [-0.6]" in str(plugin)
    plugin = mi.load_dict({"type": "phong"})
    parameters = mi.traverse(plugin)
    parameters["specular_reflectance.value"] = 1.5
    parameters["exponent"] = 4.0
    parameters.update()
    # 0.5 / pi + 1.5 (4 + 2) / (2 pi)
    value = plugin.eval(mi.BSDFContext(), surface(DIRECTIONS[0]), mi.Vector3f(0, 0, 1))
    assert np.array(value).ravel() == pytest.approx(5 / np.pi, rel=1e-6)
    assert plugin.glossy_share[0] == pytest.approx(0.75)


@pytest.mark.parametrize(
    ("settings", "name"),
    [
        ({"type": "schlick", "k": 1.0}, "k must"),
        ({"type": "cornette_shanks", "g": -1.5}, "g must"),
        ({"type": "phong", "exponent": -1.0}, "exponent must"),
        ({"type": "phong", "shininess": 3.0}, "shininess"),
    ],
)
def test_bad_parameters_are_named(settings: dict, name: str) -> None:
    with pytest.raises(RuntimeError, match=name):
        mi.load_dict(settings)


# a sphere with a highlight in fog; the check runs in whichever variant it is given
FOG = """
import numpy as np
import reference.plugins
from reference.plugins.phong import mi

def fog(settings, integrator, side):
    medium = {"type": "homogeneous", "sigma_t": 0.2, "albedo": 0.9, "phase": settings, "sample_emitters": True}
    shine = {"type": "phong", "diffuse_reflectance": {"type": "rgb", "value": [0.4, 0.3, 0.2]}, "exponent": 12.0}
    film = {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}, "component_format": "float32"}
    view = mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0])
    light = {"type": "point", "position": [1.5, 2.0, 1.0], "intensity": {"type": "rgb", "value": 10.0}}
    ball = {"type": "sphere", "radius": 0.8, "bsdf": {"type": "twosided", "bsdf": shine}}
    return mi.load_dict({
        "type": "scene", "integrator": integrator, "fog": medium, "light": light, "ball": ball,
        "sensor": {"type": "perspective", "fov": 45.0, "far_clip": 12.0, "film": film, "to_world": view,
                   "medium": {"type": "ref", "id": "fog"}},
    })

def image_mean(settings, integrator, side, spp, passes):
    scene = fog(settings, integrator, side)
    means = [np.array(mi.render(scene, spp=spp, seed=n))[..., :3].mean() for n in range(passes)]
    return np.mean(means), np.std(means, ddof=1) / np.sqrt(passes)
"""
made: dict = {}
exec(FOG, made)


@pytest.mark.parametrize("settings", [{"type": "schlick", "k": 0.7}, {"type": "cornette_shanks", "g": -0.6}], ids=str)
def test_volpath_agrees_with_our_integrator(settings: dict) -> None:
    ours, error = made["image_mean"](settings, {"type": "single_scattering"}, 24, 64, 8)
    theirs, noise = made["image_mean"](settings, {"type": "volpath", "max_depth": 2}, 24, 256, 16)
    # measured: volpath's mean to 0.2 %, ours to 0.4 %, 0.04 and -0.3 sigma apart
    assert np.hypot(error, noise) < 0.01 * ours
    assert abs(ours - theirs) < 4 * np.hypot(error, noise)
    name = "k" if "k" in settings else "g"
    other, _ = made["image_mean"](settings | {name: -settings[name]}, {"type": "single_scattering"}, 24, 64, 2)
    assert abs(other - theirs) > 10 * noise


SCALAR = (
    FOG
    + """
for settings in ({"type": "schlick", "k": 0.7}, {"type": "cornette_shanks", "g": -0.6}):
    print(*image_mean(settings, {"type": "volpath", "max_depth": 2}, 8, 16, 8))
assert mi.variant() == "scalar_rgb"
"""
)


def test_the_same_plugins_serve_scalar_rgb(tmp_path: Path) -> None:
    environment = os.environ | {"AIRLIGHT_MITSUBA_VARIANT": "scalar_rgb", "XDG_CACHE_HOME": str(tmp_path)}
    run = subprocess.run(
        [sys.executable, "-c", SCALAR], env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert run.returncode == 0, run.stderr
    lines = [[float(number) for number in line.split()] for line in run.stdout.splitlines()]
    for settings, (mean, error) in zip(
        ({"type": "schlick", "k": 0.7}, {"type": "cornette_shanks", "g": -0.6}), lines, strict=True
    ):
        truth, _ = made["image_mean"](settings, {"type": "single_scattering"}, 24, 64, 8)
        assert error < 0.05 * truth
        assert abs(mean - truth) < 4 * error
