"""The plugin `single_scattering` in a plain Mitsuba script: what it gives, and what it refuses."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from oracles import SphereScene

from reference import estimators, integrator
from reference.integrator import mi
from scenes.errors import InputError
from scenes.loader import load


def test_the_plugin_serves_plain_mitsuba() -> None:
    scene = load("sphere", size=(24, 24))
    made = estimators.instantiate(scene).scene
    plugin = mi.load_dict({"type": "single_scattering", "distance_samples": 4})
    assert plugin.aov_names() == ["surface.R", "surface.G", "surface.B", "scattering.R", "scattering.G", "scattering.B"]
    image = np.array(mi.render(made, integrator=plugin, spp=64))
    aovs = image[..., -6:]
    assert image.shape[:2] == (24, 24)
    assert image[..., :3] == pytest.approx(aovs[..., :3] + aovs[..., 3:], rel=2e-3, abs=1e-4)
    # the film's filter blurs edges, the means stay: measured 1.0 % and 0.1 % apart
    exact = SphereScene(scene)
    assert aovs[..., :3].mean() == pytest.approx(exact.surface().mean(), rel=0.02)
    assert aovs[..., 3:].mean() == pytest.approx(exact.scattering().mean(), rel=0.01)


FOG: dict = {"type": "homogeneous", "sigma_t": 0.1}
THICK_FOG: dict = {"type": "homogeneous", "sigma_t": 2.0}
NULL: dict = {"type": "null"}
INSIDE: dict = {"medium": {"type": "ref", "id": "fog"}}
HELD: dict = {"interior": {"type": "ref", "id": "fog"}}
SURROUNDED: dict = {"exterior": {"type": "ref", "id": "fog"}}
UNEVEN: dict = {"type": "heterogeneous", "sigma_t": {"type": "gridvolume", "grid": None}}


def plain_scene(eye: dict, *shapes: dict, fog: dict = FOG):
    """A scene of a plain Mitsuba script: what its camera names, and cubes with what they name."""
    if fog is UNEVEN:
        fog = fog | {"sigma_t": fog["sigma_t"] | {"grid": mi.VolumeGrid(np.ones((2, 2, 2, 1), np.float32))}}
    film = {"type": "hdrfilm", "width": 4, "height": 4}
    return mi.load_dict(
        {
            "type": "scene",
            "fog": fog,
            "eye": {"type": "perspective", "film": film, **eye},
            "lamp": {"type": "point", "position": [1.0, 0.0, 3.0]},
            **{f"cube{number}": {"type": "cube", **shape} for number, shape in enumerate(shapes)},
        }
    )


REFUSED: dict[str, tuple[str, dict, list[dict], dict]] = {
    "two boxes of fog": (
        "one medium, and the shape cube. has another than .*: refer to",
        {},
        [{"bsdf": NULL} | HELD, {"bsdf": NULL, "interior": THICK_FOG}],
        FOG,
    ),
    "a box of fog in fog": (
        "one medium, and the shape cube0 has another",
        INSIDE,
        [{"bsdf": NULL, "interior": THICK_FOG}],
        FOG,
    ),
    "other fog around": (
        "one medium, and the shape cube0 has another",
        INSIDE,
        [{"exterior": THICK_FOG}],
        FOG,
    ),
    "uneven fog": ("type homogeneous, and fog is not: make", INSIDE, [], UNEVEN),
    "a mask": (
        "null or lets no light pass, and that of the shape cube0 does both: make",
        INSIDE,
        [{"bsdf": {"type": "mask", "opacity": 0.5, "inner": {"type": "diffuse"}}}],
        FOG,
    ),
    "a pane": ("that of the shape cube0 does both", INSIDE, [{"bsdf": {"type": "thindielectric"}}], FOG),
    "a hollow": ("cube0 bounds another place: name", INSIDE, [{"bsdf": NULL} | SURROUNDED], FOG),
    "a boundary of nothing": ("cube0 bounds another place", INSIDE, [{"bsdf": NULL}], FOG),
    "fog on both sides": ("cube0 bounds another place", INSIDE, [{"bsdf": NULL} | HELD | SURROUNDED], FOG),
    "fog in what is opaque": ("has no medium: its camera is in none", {}, [HELD], FOG),
    "no fog": ("has no medium", {}, [], FOG),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_plain_scene_outside_the_subset_is_refused(name: str) -> None:
    told, eye, shapes, fog = REFUSED[name]
    with pytest.raises(InputError, match=told):
        mi.load_dict({"type": "single_scattering"}).render(plain_scene(eye, *shapes, fog=fog), seed=0, spp=1)


def test_plain_scenes_of_the_subset_are_not_refused() -> None:
    plugin = mi.load_dict({"type": "single_scattering"})
    boxes = plain_scene(
        {}, {"bsdf": NULL} | HELD, {"bsdf": NULL} | HELD | {"to_world": mi.ScalarTransform4f().translate(4)}, SURROUNDED
    )
    for scene in (plain_scene(INSIDE), plain_scene(INSIDE, SURROUNDED, {}), boxes):
        assert np.isfinite(np.array(mi.render(scene, integrator=plugin, spp=1))).all()


@pytest.mark.parametrize("strata", [1, 3, 100])
def test_strata_do_not_change_the_mean(strata: int) -> None:
    scene = load("sphere", size=(24, 24))
    made = estimators.instantiate(scene).scene
    plugin = mi.load_dict({"type": "single_scattering", "distance_samples": strata})
    image = np.array(mi.render(made, integrator=plugin, spp=1024 // strata))
    assert image[..., -3:].mean() == pytest.approx(SphereScene(scene).scattering().mean(), rel=0.01)


@pytest.mark.parametrize("parameters", [{"distance_samples": 0}, {"light_share": 1.5}, {"distances": 3}], ids=str)
def test_parameters_of_the_plugin_are_checked(parameters: dict) -> None:
    with pytest.raises(RuntimeError, match=next(iter(parameters))):
        mi.load_dict({"type": "single_scattering", **parameters})


def test_a_light_with_an_extent_is_refused() -> None:
    lit_by = mi.load_dict({"type": "scene", "sky": {"type": "constant"}})
    with pytest.raises(InputError, match="samples point, spot and directional lights"):
        integrator.delta_emitters(lit_by)
    with pytest.raises(InputError, match="has no light"):
        integrator.delta_emitters(mi.load_dict({"type": "scene", "ball": {"type": "sphere"}}))


@pytest.mark.parametrize("variant", ["llvm_ad_rgb", "scalar_rgb", "scalar_spectral"])
def test_a_script_that_chose_its_variant_keeps_it(variant: str) -> None:
    script = f"""
import mitsuba as mi
mi.set_variant({variant!r})
import reference.integrator
film = {{"type": "hdrfilm", "width": 4, "height": 4, "component_format": "float32"}}
fog = {{"type": "homogeneous", "sigma_t": 0.1}}
scene = mi.load_dict({{
    "type": "scene",
    "fog": fog,
    "eye": {{"type": "perspective", "film": film, "medium": {{"type": "ref", "id": "fog"}}}},
    "lamp": {{"type": "point", "position": [1.0, 0.0, 3.0]}},
}})
image = mi.render(scene, integrator=mi.load_dict({{"type": "single_scattering", "distance_samples": 4}}), spp=4)
print(mi.variant(), float(mi.TensorXf(image).array[0]) > 0)
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    if variant == "llvm_ad_rgb":
        assert (run.returncode, run.stdout.strip()) == (0, "llvm_ad_rgb True"), run.stderr
    else:
        reasons = {
            "scalar_rgb": "single_scattering needs an LLVM or CUDA variant",
            "scalar_spectral": "Mitsuba's variant is scalar_spectral; set one of cuda_ad_rgb, llvm_ad_rgb, scalar_rgb.",
        }
        assert run.returncode == 1
        assert reasons[variant] in run.stderr
