"""A picture is drawn again from its file's metadata, and whatever is not as it was is said."""

from __future__ import annotations

import json
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scene_files import POINT, write_scene

import airlight
from experiments.again import Again, draw_again
from experiments.exr import read_exr, write_exr
from experiments.provenance import TECHNIQUE_KEYS, describe_files, describe_frame, describe_reference, describe_scene
from gpu_impl.techniques import Technique
from scenes.errors import InputError
from scenes.mitsuba_setup import mitsuba
from scenes.model import Scene

# none of them a technique's own, so that what is not kept shows
SETTINGS: dict[str, Any] = {
    "steps": 37,
    "shadow_map": 96,
    "lattice": "grid",
    "downsample": 2,
    "upsample": "nearest_depth",
    "surface_shadows": "soft",
    "shadow_storage": "buffer",
    "shadow_source": "rays",
    "composition": "printed",
}
MESHES = """<default name='mesh' value='wall.obj'/>
  <shape type='obj'><string name='filename' value='$mesh'/></shape>"""

PAINTED = """<shape type='rectangle'><bsdf type='diffuse'>
  <texture type='bitmap' name='reflectance'><string name='filename' value='paint.exr'/></texture></bsdf></shape>"""

TRIANGLE = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n-1 0 -1\n1 0 -1\n0 1 -1\n3 0 1 2\n"
)


def wall(path: Path, height: float = 1.0) -> None:
    path.write_text(f"v -1 0 -1\nv 1 0 -1\nv 0 {height} -1\nf 1 2 3\n")


def own_scene(folder: Path, **parameters: str) -> Scene:
    """A scene file of one's own, with a mesh beside it."""
    folder.mkdir(exist_ok=True)
    if not (folder / "wall.obj").exists():
        wall(folder / "wall.obj")
    path = write_scene(folder, emitters=POINT, shapes=MESHES).path
    return airlight.load(path, size=(12, 8), **parameters)


def drawn(path: Path, scene: Scene, technique: str = "Weng2010", **settings: int) -> Path:
    airlight.save(path, scene, airlight.render(scene, technique, **settings))
    return path


def rewritten(path: Path, pixel: float | None = None, **metadata: str | None) -> None:
    """Change what a file holds: one value of its scattering, or entries of its metadata (None: gone)."""
    layers, texts = read_exr(path)
    if pixel is not None:
        layers["scattering"][3, 2, 1] += pixel
    changed = texts | metadata
    write_exr(path, layers, {key: text for key, text in changed.items() if text is not None})


def same(again: Again) -> bool:
    return not again.differing and again.is_expected


def test_each_field_of_a_technique_is_kept_under_a_key_of_its_own(tmp_path: Path) -> None:
    settings = {field.name for field in fields(Technique) if field.default is not MISSING}
    assert settings == SETTINGS.keys(), "a new setting has to be drawn again too: add it here"
    scene = own_scene(tmp_path)
    frame, truth = airlight.render(scene, **SETTINGS), airlight.reference(scene, rel_error=0.5)
    parts = [describe_scene(scene), describe_files(scene), describe_frame(frame), describe_reference(truth)]
    assert sum(map(len, parts)) == len({key for part in parts for key in part})
    assert {TECHNIQUE_KEYS.get(field.name, field.name) for field in fields(Technique)} <= parts[2].keys()


@pytest.mark.parametrize(
    ("technique", "changed"),
    [("Weng2010", {}), ("uniform_march+quadrature", {"lattice": "epipolar"}), ("Chen2011", {"lattice": "epipolar"})],
)
def test_a_shipped_scene_is_drawn_again(tmp_path: Path, technique: str, changed: dict[str, str]) -> None:
    scene = airlight.load("sphere", size=(13, 9), sigma_t=0.3, phase="isotropic")
    frame = airlight.render(scene, technique, **SETTINGS | changed)
    airlight.save(tmp_path / "f.exr", scene, frame)
    assert read_exr(tmp_path / "f.exr")[1]["scene_file"] == "sphere"
    again = draw_again(tmp_path / "f.exr")
    assert same(again)
    assert again.frame.technique == frame.technique
    assert again.scene.digest == scene.digest
    # not because every picture is the same
    other = drawn(tmp_path / "other.exr", scene, technique)
    assert (read_exr(other)[0]["scattering"] != again.frame.scattering).any()


def test_a_scene_of_ones_own_is_drawn_again_wherever_one_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    own_scene(tmp_path)
    path = drawn(tmp_path / "f.exr", airlight.load("scene.xml", size=(12, 8)))
    assert read_exr(path)[1]["scene_file"] == str(tmp_path / "scene.xml")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    # a file that happens to have a shipped scene's name here is not what was drawn
    Path("sphere").write_text("no scene")
    assert same(draw_again(path))
    assert same(draw_again(drawn(tmp_path / "s.exr", airlight.load("sphere.xml", size=(4, 4)))))


def test_values_with_spaces_and_equals_signs_survive(tmp_path: Path) -> None:
    name = "a = 'b', \"c\".obj"
    wall(tmp_path / name, height=2.0)
    scene = own_scene(tmp_path, mesh=name)
    path = drawn(tmp_path / "f.exr", scene)
    again = draw_again(path)
    assert same(again)
    assert again.scene.parameters == {"mesh": name}
    assert json.loads(read_exr(path)[1]["files"])[0].startswith(f"{name}:")


def test_a_suites_case_is_drawn_again(tmp_path: Path) -> None:
    scene = own_scene(tmp_path)
    frame, truth = airlight.render(scene, **SETTINGS), airlight.reference(scene, rel_error=0.5)
    airlight.save(tmp_path / "case.exr", scene, frame, truth)
    assert same(draw_again(tmp_path / "case.exr"))


def test_a_scene_that_has_moved_is_given_anew(tmp_path: Path) -> None:
    path = drawn(tmp_path / "f.exr", own_scene(tmp_path / "before"))
    (tmp_path / "before").rename(tmp_path / "after")
    with pytest.raises(InputError, match=r"before/scene\.xml, which is not there; say where it is now"):
        draw_again(path)
    assert same(draw_again(path, str(tmp_path / "after" / "scene.xml")))


def test_a_changed_scene_is_named(tmp_path: Path) -> None:
    scene = own_scene(tmp_path)
    path = drawn(tmp_path / "f.exr", scene)
    scene.path.write_text(scene.path.read_text().replace("value='0.1'", "value='0.11'"))
    with pytest.raises(InputError, match=r"was not drawn from .*scene\.xml as it is now"):
        draw_again(path)
    with pytest.raises(InputError, match=r"was not drawn from .*empty\.xml as it is now"):
        draw_again(path, "empty")


def test_a_changed_mesh_is_named(tmp_path: Path) -> None:
    path = drawn(tmp_path / "f.exr", own_scene(tmp_path))
    (was,) = json.loads(read_exr(path)[1]["files"])
    wall(tmp_path / "wall.obj", height=1.5)
    with pytest.raises(InputError, match=r"another wall\.obj than .*wall\.obj: put the one whose SHA-256 is") as caught:
        draw_again(path)
    assert was.removeprefix("wall.obj:") in str(caught.value)
    # a real mesh where a stand-in served
    rewritten(path, stand_ins="wall.obj")
    with pytest.raises(InputError, match=r"stand-in for wall\.obj, and the scene now finds"):
        draw_again(path)


def test_a_changed_picture_is_named(tmp_path: Path) -> None:
    def paint(value: float) -> None:
        mitsuba().Bitmap(np.full((2, 2, 3), value, np.float32)).write(str(tmp_path / "paint.exr"))

    paint(0.5)
    path = drawn(tmp_path / "f.exr", write_scene(tmp_path, shapes=PAINTED, size=(12, 8)))
    assert same(draw_again(path))
    paint(0.6)
    with pytest.raises(InputError, match=r"another paint\.exr than .*paint\.exr: put the one whose SHA-256 is"):
        draw_again(path)


def test_other_pixels_are_counted_and_explained_where_they_can_be(tmp_path: Path) -> None:
    path = drawn(tmp_path / "f.exr", own_scene(tmp_path))
    rewritten(path, pixel=0.5)
    again = draw_again(path)
    assert (again.differing, again.layers) == (1, ("scattering",))
    assert again.largest == pytest.approx(0.5, rel=1e-5)
    assert not again.is_expected
    assert "1 of 96 pixels differ" in again.report(path)
    rewritten(path, numpy="1.0.0", gl_renderer="a card")
    again = draw_again(path)
    assert again.is_expected
    assert again.changed.keys() == {"numpy", "gl_renderer"}
    assert "numpy was 1.0.0 and is" in again.report(path)


def test_the_smallest_difference_counts(tmp_path: Path) -> None:
    path = drawn(tmp_path / "f.exr", own_scene(tmp_path))
    layers, texts = read_exr(path)
    layers["surface"][0, 0, 0] = -0.0
    layers["depth"][7, 11] = np.nextafter(layers["depth"][7, 11], np.float32(np.inf))
    write_exr(path, layers, texts)
    again = draw_again(path)
    assert (again.differing, set(again.layers)) == (2, {"surface", "depth"})


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_values_that_are_not_finite_differ_by_no_number(tmp_path: Path, value: float) -> None:
    path = drawn(tmp_path / "f.exr", own_scene(tmp_path))
    rewritten(path, pixel=value)
    again = draw_again(path)
    assert again.differing == 1
    assert "1 of 96 pixels differ from" in again.report(path)
    assert "which holds values that are not finite, in scattering" in again.report(path)
    assert "at most" not in again.report(path)


@pytest.mark.parametrize("key", ["technique", "visibility", "steps", "size", "parameters", "scene_file", "numpy"])
def test_metadata_of_any_length_make_a_sentence(tmp_path: Path, key: str) -> None:
    path = drawn(tmp_path / "f.exr", own_scene(tmp_path))
    rewritten(path, pixel=0.5, **{key: "x" * 100_000})
    try:
        said = draw_again(path).report(path)
    except InputError as error:
        said = str(error)
    assert "xxx ... xxx" in said or key == "technique"
    assert len(said) < 1000


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"technique": None}, "does not say how it was drawn"),
        ({"technique": None, "estimator": "equiangular 1"}, "is a reference, which no technique drew"),
        ({"scene_file": None}, "lacks 'scene_file' in its metadata"),
        ({"steps": None}, "lacks 'steps' in its metadata"),
        ({"airlight_model": None}, "lacks 'airlight_model' in its metadata"),
        ({"scene_digest": None}, "lacks 'scene_digest' in its metadata"),
        ({"steps": "many"}, "says steps = 'many' in its metadata"),
        ({"steps": "0"}, "steps is 0; use 1 to"),
        ({"visibility": "guesses"}, "There is no visibility 'guesses'"),
        ({"parameters": "sigma_t=0.2"}, "says parameters = 'sigma_t=0.2' in its metadata"),
        ({"parameters": "[3]"}, "says parameters = "),
        ({"parameters": "[" * 100_000}, "says parameters = '[[[["),
        ({"parameters": '{"size": "3"}'}, "says parameters = "),
        ({"parameters": '{"nobody": "3"}'}, "no use for the parameter"),
        ({"size": "3"}, "says size = '3' in its metadata"),
        ({"size": "3 0"}, "An image of 3 x 0 pixels cannot be made"),
        ({"scene_file": "nowhere"}, "drawn from the scene nowhere, which is not there"),
        ({"scene_file": "a\nb" * 300}, "which is not there"),
    ],
)
def test_metadata_that_do_not_say_it_are_refused(tmp_path: Path, changes: dict[str, str | None], words: str) -> None:
    path = drawn(tmp_path / "f.exr", own_scene(tmp_path))
    rewritten(path, **changes)
    with pytest.raises(InputError) as caught:
        draw_again(path)
    assert words in str(caught.value)


def test_a_file_without_a_layer_is_refused(tmp_path: Path) -> None:
    path = drawn(tmp_path / "f.exr", own_scene(tmp_path))
    layers, texts = read_exr(path)
    del layers["depth"]
    write_exr(path, layers, texts)
    with pytest.raises(InputError, match="has no layer 'depth' of 12 x 8 pixels"):
        draw_again(path)


def test_metadata_give_credit_where_the_meshes_terms_ask_for_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "meshes").mkdir()
    monkeypatch.setenv("AIRLIGHT_MESH_DIR", str(tmp_path / "meshes"))
    (tmp_path / "meshes" / "teapot.ply").write_text(TRIANGLE)
    teapot = "<shape type='ply'><string name='filename' value='teapot.ply'/></shape>"
    assert "Martin Newell" in describe_files(write_scene(tmp_path, shapes=teapot))["credits"]
    assert describe_files(own_scene(tmp_path))["credits"] == ""


def test_tables_name_no_folder_of_this_machine(tmp_path: Path) -> None:
    scene = own_scene(tmp_path)
    row = describe_scene(scene) | describe_frame(airlight.render(scene))
    assert str(tmp_path) not in json.dumps(row)
    assert str(tmp_path) in json.dumps(describe_files(scene))
