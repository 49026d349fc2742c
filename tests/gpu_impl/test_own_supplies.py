"""Copies of registered parts, with `supply`: they draw the same bits and refuse the same things."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from registries import restored_registries
from scene_files import sphere, write_scene

from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.lattices import LATTICES
from gpu_impl.own_technique import load_technique
from gpu_impl.renderer import Renderer
from gpu_impl.shader_source import SHADERS
from gpu_impl.techniques import Technique, find_technique
from gpu_impl.visibilities import VISIBILITIES
from scenes.errors import InputError
from scenes.model import Scene

BOX = (
    "<shape type='cube'><transform name='to_world'><scale value='1.5'/></transform><bsdf type='null'/>"
    "<ref name='interior' id='fog'/></shape>"
)
SUN = (
    "<emitter type='directional'><vector name='direction' x='0.3' y='-1' z='-0.2'/>"
    "<rgb name='irradiance' value='3'/></emitter>"
)


@pytest.fixture(autouse=True)
def _registries() -> Iterator[None]:
    with restored_registries():
        yield


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    return write_scene(tmp_path_factory.mktemp("scene"), shapes=sphere(0.2, 0.3, 0, 0.6), size=(40, 24))


def copied(folder: Path, source: str | None) -> str:
    """A copy of a registered shader, under a name that no include of it has; its name."""
    assert source
    name = f"my_{Path(source).name}"
    (folder / name).write_text((SHADERS / source).read_text())
    return name


def copy_of_visibility(folder: Path, name: str, says: str = "") -> Technique:
    file = copied(folder, VISIBILITIES[name].source)
    (folder / "mine.toml").write_text(
        f'name = "Mine"\nvisibility = {{ file = "{file}", supply = "{name}"{says} }}\nairlight = "quadrature"\n'
    )
    return load_technique(folder / "mine.toml")


def copy_of_model(folder: Path, name: str, says: str = "") -> Technique:
    file = copied(folder, AIRLIGHT_MODELS[name].source)
    (folder / "mine.toml").write_text(
        f'name = "Mine"\nvisibility = "uniform_march"\nairlight = {{ file = "{file}", supply = "{name}"{says} }}\n'
    )
    return load_technique(folder / "mine.toml")


@pytest.mark.parametrize("position", [(0.4, 1.5, 0.0), (0.3, 0.4, 7.0)], ids=["before the eye", "behind it"])
def test_a_copied_lattice_of_planes_has_the_rows_of_min_max(tmp_path: Path, position: tuple[float, ...]) -> None:
    x, y, z = position
    light = f"<emitter type='point'><point name='position' x='{x}' y='{y}' z='{z}'/></emitter>"
    scene = write_scene(tmp_path, emitters=light, shapes=sphere(0.2, 0.3, 0, 0.6), size=(40, 24))
    kind = LATTICES["epipolar"]
    (tmp_path / "mine.toml").write_text(
        f'name = "Mine"\nvisibility = "min_max"\nairlight = "quadrature"\n'
        f'lattice = {{ file = "{copied(tmp_path, kind.source)}", supply = "epipolar", '
        f'reconstruction = "{copied(tmp_path, kind.reconstruction)}" }}\n[settings]\ndownsample = 4\n'
    )
    with Renderer(scene) as renderer:
        ours = renderer.render(find_technique("Chen2011")).scattering
        np.testing.assert_array_equal(renderer.render(load_technique(tmp_path / "mine.toml")).scattering, ours)
        # between them another number of rows is another picture
        assert (renderer.render(find_technique("min_max+quadrature")).scattering != ours).any()


@pytest.mark.parametrize("name", VISIBILITIES)
def test_a_copied_strategy_is_as_the_registered_one(tmp_path: Path, name: str) -> None:
    ours, technique = VISIBILITIES[name], copy_of_visibility(tmp_path, name)
    mine = VISIBILITIES[technique.visibility]
    for what in ("reads_shadow_map", "asks_points", "given", "grid_only", "airlight_at_corners", "vertex", "check"):
        assert getattr(mine, what) == getattr(ours, what), what
    # and says otherwise where it does
    other = copy_of_visibility(tmp_path, name, f", asks_points = {str(not ours.asks_points).lower()}")
    assert VISIBILITIES[other.visibility].asks_points is not ours.asks_points


@pytest.mark.parametrize("name", ["exact", "shadow_faces", "given"])
def test_rays_do_not_answer_for_a_copy_that_does_not_ask_them(tmp_path: Path, name: str) -> None:
    copy_of_visibility(tmp_path, name)
    with pytest.raises(InputError, match="does not ask about points"):
        find_technique(str(tmp_path / "mine.toml"), shadow_source="rays")


@pytest.mark.parametrize("name", AIRLIGHT_MODELS)
def test_a_copied_model_is_as_the_registered_one(tmp_path: Path, name: str) -> None:
    ours, technique = AIRLIGHT_MODELS[name], copy_of_model(tmp_path, name)
    mine = AIRLIGHT_MODELS[technique.airlight]
    for what in ("phases", "any_light", "generated", "table"):
        assert getattr(mine, what) == getattr(ours, what), what


def test_a_copied_model_refuses_what_the_registered_one_refuses(tmp_path: Path) -> None:
    technique = copy_of_model(tmp_path, "sun2005")
    foggy = write_scene(tmp_path, phase="<phase type='hg'><float name='g' value='0.7'/></phase>", size=(8, 8))
    sunny = write_scene(tmp_path, shapes=BOX, emitters=SUN, inside=False, size=(8, 8))
    for scene, said in ((foggy, "takes the phase function isotropic"), (sunny, "takes point and spot lights inside")):
        with Renderer(scene) as renderer, pytest.raises(InputError, match=said) as caught:
            renderer.render(technique)
        assert "use uniform_march+quadrature" in str(caught.value)
    more = copy_of_model(tmp_path, "sun2005", ', phases = ["isotropic", "tabphase"], any_light = true')
    model = AIRLIGHT_MODELS[more.airlight]
    # as scenes call it, and as `analytic` does
    assert model.phases == ("isotropic", "tabulated")
    assert model.any_light


def test_without_a_supply_all_is_taken(tmp_path: Path) -> None:
    march = copied(tmp_path, "visibility/uniform_march.glsl")
    (tmp_path / "mine.toml").write_text(
        f'name = "Mine"\nvisibility = "{march}"\nairlight = "{copied(tmp_path, "airlight/riemann.glsl")}"\n'
    )
    technique = load_technique(tmp_path / "mine.toml")
    visibility, model = VISIBILITIES[technique.visibility], AIRLIGHT_MODELS[technique.airlight]
    assert visibility.reads_shadow_map
    assert visibility.asks_points
    assert model.phases is None
    assert model.any_light


def test_a_cure_names_what_can_be_asked_for(tmp_path: Path, scene: Scene) -> None:
    """`march.glsl@3fa9c2d1e0b4+quadrature` is known to nobody."""
    (tmp_path / "endless.glsl").write_text("void visibility(Ray ray, Light light) { lit(0.0, ray.t_max, exp(1e9)); }\n")
    for model, cure in (("riemann", "use the airlight model quadrature, or bring"), ("quadrature", "bring")):
        (tmp_path / "mine.toml").write_text(f'name = "Mine"\nvisibility = "endless.glsl"\nairlight = "{model}"\n')
        with Renderer(scene) as renderer, pytest.raises(InputError, match=f"not finite: {cure}"):
            renderer.render(load_technique(tmp_path / "mine.toml"))
    (tmp_path / "mine.toml").write_text('name = "Mine"\nvisibility = "endless.glsl"\nairlight = "sun2005"\n')
    foggy = write_scene(tmp_path, phase="<phase type='rayleigh'/>", size=(8, 8))
    with pytest.raises(InputError, match="use the airlight model quadrature, or set"):
        load_technique(tmp_path / "mine.toml").check_scene(foggy)
