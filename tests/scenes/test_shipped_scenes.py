"""The shipped scenes: each can be loaded, drawn and named, and shows what it is for."""

from __future__ import annotations

import runpy
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles import cone_interval, piece_airlight
from shadow_volumes import SHADOWS, shadowed_airlight

from gpu_impl.frame import Frame
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes import manifest as manifest_module
from scenes.catalogue import FOLDER, shipped
from scenes.errors import InputError
from scenes.loader import load
from scenes.manifest import FrozenMesh, Manifest, frozen_version, manifest
from scenes.meshes.catalogue import MESHES
from scenes.meshes.files import sha256, user_folder
from scenes.meshes.notes import Note, StepRecord, note_path
from scenes.meshes.procedural import RECIPES
from scenes.meshes.triangles import Triangles, ply_bytes
from scenes.model import Scene

SCRIPTS = FOLDER.parent / "scripts"
PHASES = sorted(path.stem for path in (FOLDER / "phase").glob("*.xml"))
# Of the pixels whose rays the light could reach: the least share that gets over 98 % of the light it would without
# occluders, and the least that gets under 80 %. At 32 x 32, with the stand-ins | with the meshes that are meant:
LIT_AND_SHADOWED = {
    "donut_dragon": (0.4, 0.1),  # 0.66, 0.20 | 0.67, 0.20
    "dragon": (0.2, 0.15),  # 0.37, 0.27 | 0.39, 0.34
    "yeahright": (0.1, 0.2),  # 0.18, 0.70 | 0.30, 0.33
    "many_objects": (0.3, 0.1),  # 0.50, 0.29 | 0.58, 0.17
    "wire_mesh": (0.05, 0.5),  # 0.09, 0.90
    "sphere": (0.5, 0.03),  # 0.88, 0.05
    "half_plane": (0.3, 0.2),  # 0.56, 0.42
    "light_behind_eye": (0.2, 0.2),  # 0.40, 0.38
    "eye_in_shadow": (0.0, 0.2),  # 0, 0.39: the eye is in the dark
    "slit": (0.0, 0.5),  # 0, 0.95: so it is here
    "empty": (1.0, 0.0),
}


def drawn(scene: Scene, steps: int = 128) -> Frame:
    with Renderer(scene) as renderer:
        return renderer.render(find_technique("lit_intervals+quadrature", steps=steps))


def numbered(name: str) -> str:
    return f"{name} {manifest().versions[name]}"


def ends(scene: Scene, frame: Frame) -> np.ndarray:
    return np.minimum(frame.depth.astype(np.float64), scene.camera.rays()[2])


# --- what is there ---------------------------------------------------------------------------------------------------


def test_they_are_those_of_the_thesis_and_those_with_known_answers() -> None:
    assert set(shipped()) == set(LIT_AND_SHADOWED)
    pictures = {path.stem: path.stat().st_size for path in (FOLDER / "thumbnails").glob("*.png")}
    assert set(pictures) == set(shipped())
    assert max(pictures.values()) < 60_000


@pytest.mark.parametrize("name", shipped())
def test_a_scene_has_its_parameters_and_is_1024_pixels_on_a_side(name: str) -> None:
    plain = load(name)
    assert (plain.camera.width, plain.camera.height) == (1024, 1024)
    assert plain.phase.name == "isotropic"
    changed = load(name, size=(8, 8), phase="hg", g=0.3, sigma_t=0.25, albedo=0.4, intensity=7)
    assert (changed.phase.name, changed.phase.mean_cosine) == ("hg", pytest.approx(0.3))
    np.testing.assert_allclose(changed.medium.sigma_t, 0.25)
    np.testing.assert_allclose(changed.medium.sigma_s, 0.1)
    np.testing.assert_allclose([light.intensity for light in changed.lights], 7)


@pytest.mark.parametrize("phase", PHASES)
def test_a_phase_function_has_the_mean_cosine_that_its_file_means(phase: str) -> None:
    scene = load("empty", size=(8, 8), phase=phase)
    cosines = np.linspace(-1, 1, 18001)
    density = 2 * np.pi * scene.phase.evaluate(cosines)
    assert np.trapezoid(density, cosines) == pytest.approx(1, abs=1e-5)
    # Cornette and Shanks 1992, Eq. 8: 3 g (4 + g^2) / (5 (2 + g^2)); Schlick's: 1 / k - (1 - k^2) atanh(k) / k^2
    expected = {"hg": 0.6, "schlick": 2 - 3 * np.arctanh(0.5), "cornette_shanks": 0.6651, "tabphase": 0.689}
    assert np.trapezoid(density * cosines, cosines) == pytest.approx(expected.get(phase, 0), abs=1e-3)


def test_many_objects_are_at_least_eight() -> None:
    scene = load("many_objects", size=(8, 8))
    assert len({mesh.file.name for mesh in scene.meshes if mesh.file}) >= 8


# --- what they show --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", shipped())
def test_a_scene_shows_fog_that_is_lit_and_fog_in_shadow(name: str) -> None:
    scene = load(name, size=(32, 32))
    frame = drawn(scene)
    assert np.isfinite(frame.composite).all()
    (light,) = scene.lights
    reach = (np.zeros((32, 32)), ends(scene, frame))
    if light.kind == "spot":
        reach = cone_interval(scene, light.position, light.direction, light.cutoff_angle, reach[1])
    unshadowed = piece_airlight(scene, light, *reach).mean(axis=-1)
    reached = unshadowed > 0.01 * unshadowed.max()
    assert reached.mean() > 0.3  # 0.41 on wire_mesh, the darkest
    share = frame.scattering.mean(axis=-1)[reached] / unshadowed[reached]
    lit, shadowed = LIT_AND_SHADOWED[name]
    assert np.mean(share > 0.98) >= lit
    assert np.mean(share < 0.8) >= shadowed
    assert share.max() < 1.01


def test_the_wire_mesh_interlaces_dark_and_light() -> None:
    lit = drawn(load("wire_mesh", size=(32, 32))).lit_intervals
    assert lit[lit > 0].mean() > 4  # 5.4; the dragon's 1.5
    assert lit.max() >= 10  # 14


@pytest.mark.parametrize("name", SHADOWS)
def test_the_known_answers_are_known(name: str) -> None:
    """The shadow volumes that the scene files speak of, against shadows found in a map."""
    scene = load(name, size=(64, 64))
    frame = drawn(scene, steps=256)
    exact = shadowed_airlight(scene, ends(scene, frame)).mean(axis=-1)
    found = frame.scattering.mean(axis=-1)
    error = np.abs(found - exact) / np.maximum(exact, 0.01 * np.median(exact[exact > 0]))
    # measured: 0.021 and 0.0012 at most, both on slit; an edge moved by 0.05 changes the mean by 0.0048 or more
    assert np.percentile(error, 95) < 0.06
    assert found.mean() == pytest.approx(exact.mean(), rel=0.003)


def test_the_eye_is_in_the_dark_and_the_light_behind_it() -> None:
    for name in ("eye_in_shadow", "slit"):
        scene = load(name, size=(16, 16))
        # the first metre of every ray
        dark = [np.all((begin == 0) & (end > 0.5)) for begin, end in SHADOWS[name](scene, np.ones((16, 16)))]
        assert any(dark), name
    scene = load("light_behind_eye", size=(16, 16))
    origin, direction, _ = scene.camera.rays()
    assert ((scene.lights[0].position - origin) * direction).sum(axis=-1).max() < 0


# --- which version they are ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", shipped())
def test_a_scene_is_the_frozen_one(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """After a change that is meant, run scripts/freeze_scenes.py."""
    monkeypatch.delenv("AIRLIGHT_MESH_DIR", raising=False)
    scene = load(name, size=(8, 8), sigma_t=0.2)
    assert frozen_version(scene) == numbered(name) + (" (stand-ins)" if scene.stand_ins else "")


def test_the_reference_meshes_are_known_by_their_hash(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A small mesh under the name of a large one, frozen in its place."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.uint32)
    for name in ("dragon_97k_fixed.ply", "spot.ply"):
        (tmp_path / name).write_bytes(ply_bytes(Triangles(corners, faces)))
    monkeypatch.setenv("AIRLIGHT_MESH_DIR", str(tmp_path))
    dragon, many_objects = numbered("dragon"), numbered("many_objects")
    assert frozen_version(load("dragon")) == f"unfrozen: dragon_97k_fixed.ply differs from {dragon}"

    here = FrozenMesh(sha256(tmp_path / "spot.ply"), "none")
    held = manifest()
    pretended = replace(held, meshes=held.meshes | {"dragon_97k_fixed.ply": here, "spot.ply": here})
    monkeypatch.setattr(manifest_module, "manifest", lambda: pretended)
    assert frozen_version(load("dragon")) == f"{dragon} (reference meshes)"
    others = sorted(load("many_objects").stand_ins)
    assert len(others) == 7
    assert frozen_version(load("many_objects")) == f"{many_objects} (stand-ins for {', '.join(others)})"

    made = FrozenMesh(reference="other", fetched=here.reference, ours="none")
    pretended = replace(held, meshes=held.meshes | {"dragon_97k_fixed.ply": made, "spot.ply": made})
    assert frozen_version(load("dragon")) == f"{dragon} (fetched meshes)"
    assert (
        frozen_version(load("many_objects")) == f"{many_objects} (fetched spot.ply; stand-ins for {', '.join(others)})"
    )
    both = FrozenMesh(reference=here.reference, fetched=here.reference, ours="none")
    pretended = replace(held, meshes=held.meshes | {"dragon_97k_fixed.ply": both})
    assert frozen_version(load("dragon")) == f"{dragon} (reference meshes)"


def test_a_manifest_that_is_missing_or_damaged_is_named(tmp_path: Path) -> None:
    path = tmp_path / "manifest.toml"
    good = manifest_module.PATH.read_text()
    with pytest.raises(InputError, match=rf"^{path} cannot be read \(No such file or directory\): .*make setup"):
        manifest.__wrapped__(path)
    damages = {
        "[versions": "Expected",
        good.replace("[files]", "[other]"): "files",
        good.replace("slit = 1", 'slit = "one"'): r"versions\.slit",
        good.replace("dragon = 1", "dragon = 1\ndragon = 1"): "Cannot overwrite",
        "versions = 1\nfiles = 2\nmeshes = 3\n": "versions",
        "a = " + "[" * 100_000: "",
    }
    for text, reason in damages.items():
        path.write_text(text)
        with pytest.raises(InputError, match=rf"^{path} is damaged \(.*{reason}.*\): .*make setup"):
            manifest.__wrapped__(path)
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match="is damaged"):
        manifest.__wrapped__(path)


def test_a_changed_number_is_no_frozen_scene(tmp_path: Path) -> None:
    shutil.copytree(FOLDER / "phase", tmp_path / "phase")
    copy = tmp_path / "slit.xml"
    text = (FOLDER / "slit.xml").read_text()
    # line ends are no difference, and parameters are not the scene's
    copy.write_bytes(text.replace("\n", "\r\n").encode())
    assert frozen_version(load(copy, phase="hg", g=0.1)) == frozen_version(load("slit"))
    copy.write_text(text.replace('value="45"', 'value="45.1"'))
    assert frozen_version(load(copy)) == f"unfrozen: slit.xml differs from {numbered('slit')}"

    copy.write_text(text)
    phase = tmp_path / "phase" / "hg.xml"
    phase.write_text(phase.read_text().replace("0.6", "0.61"))
    assert frozen_version(load(copy, phase="hg")) == f"unfrozen: phase/hg.xml differs from {numbered('slit')}"
    assert frozen_version(load(copy)) == numbered("slit")

    copy.rename(tmp_path / "mine.xml")
    assert frozen_version(load(tmp_path / "mine.xml")) == "unfrozen: no shipped scene"


def test_freezing_numbers_what_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("AIRLIGHT_MESH_DIR", raising=False)
    script = runpy.run_path(str(SCRIPTS / "freeze_scenes.py"))
    held = manifest()
    assert script["freeze"](held) == held
    for name, mesh in held.meshes.items():
        assert mesh.ours == RECIPES[name].sha256
        assert mesh.reference == (MESHES[name].reference_sha256 if RECIPES[name].stands_in else None)

    before = replace(
        held,
        files=held.files | {"slit.xml": "other"},
        meshes=held.meshes | {"spot.ply": replace(held.meshes["spot.ply"], ours="other")},
    )
    numbered = script["freeze"](before).versions
    changed = {name for name, number in numbered.items() if number != held.versions[name]}
    assert changed == {"slit", "many_objects"}
    everything = script["freeze"](replace(held, files=held.files | {"phase/hg.xml": "other"})).versions
    assert all(number == held.versions[name] + 1 for name, number in everything.items())
    # as it is from the first release on: a number goes on from whatever it was
    later = replace(held, versions={name: 7 for name in held.versions}, files=held.files | {"slit.xml": "other"})
    assert script["freeze"](later).versions == {name: 8 if name == "slit" else 7 for name in held.versions}
    assert script["freeze"](Manifest({}, {}, held.meshes)).versions == dict.fromkeys(held.versions, 1)


def test_freezing_takes_the_hash_of_a_fetched_mesh_from_its_note(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("AIRLIGHT_MESH_DIR", raising=False)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    freeze = runpy.run_path(str(SCRIPTS / "freeze_scenes.py"))["freeze"]
    name, held = "dragon_97k_fixed.ply", manifest()
    known, path = MESHES[name], user_folder() / name
    assert known.original
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
    path.parent.mkdir(parents=True)
    path.write_bytes(ply_bytes(Triangles(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.uint32))))
    steps = [StepRecord(step=s.name, parameters=s.parameters, made_by={}, vertices=4, polygons=4) for s in known.steps]
    words = dict.fromkeys(("what", "credit", "licence", "origin", "page", "address", "member", "airlight", "date"), "")
    original = known.original.sha256
    note = Note(name=name, original_sha256=original, steps=steps, triangles=4, sha256=sha256(path), **words)
    note_path(path).write_text(note.model_dump_json())

    unknown = replace(held, meshes=held.meshes | {name: replace(held.meshes[name], fetched=None)})
    found = freeze(unknown)
    assert found.meshes[name] == replace(held.meshes[name], fetched=sha256(path))
    assert found.versions == held.versions
    # another one under the same number would be two meshes under one name
    numbered = freeze(held).versions
    assert {name for name, number in numbered.items() if number != held.versions[name]} == {"dragon", "donut_dragon"}
    # made otherwise than the catalogue has it: no fetched mesh, but one that somebody means
    note_path(path).write_text(note.model_copy(update={"steps": steps[:1]}).model_dump_json())
    assert freeze(unknown).meshes[name] == FrozenMesh(sha256(path), None, held.meshes[name].ours)


def test_the_manifest_says_in_toml_what_it_holds(tmp_path: Path) -> None:
    script = runpy.run_path(str(SCRIPTS / "freeze_scenes.py"))
    path = tmp_path / "manifest.toml"
    path.write_text(script["to_toml"](manifest()))
    assert manifest.__wrapped__(path) == manifest()
