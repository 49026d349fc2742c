"""What cannot be rendered is refused in one sentence that names the place and what would do, and never crashes."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from spoilt_media import MORE_CASES
from spoilt_scenes import CASES, GOOD, PAINT, SPOT

from scenes.catalogue import scene_path
from scenes.errors import InputError
from scenes.loader import load
from scenes.meshes.triangles import Triangles, ply_bytes
from scenes.mitsuba_setup import mitsuba


def refusal(scene: object, /, **settings: object) -> str:
    """The one sentence with which a scene is refused."""
    with pytest.raises(InputError) as caught:
        load(scene, **settings)  # type: ignore[arg-type]
    sentence = str(caught.value)
    assert "\n" not in sentence
    assert sentence.endswith(".")
    assert "Traceback" not in sentence
    return sentence


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv("AIRLIGHT_MESH_DIR", raising=False)
    corners = np.eye(3, dtype=np.float32)
    side = np.array([[0, 1, 2]], np.uint32)
    broken = corners.copy()
    broken[1, 1] = np.nan
    (tmp_path / "nan.ply").write_bytes(ply_bytes(Triangles(broken, side)))
    # a pyramid whose tip points into it
    (tmp_path / "dented.obj").write_text(
        "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 2 0\nv 0 0.5 0\n"
        "f 1 4 5\nf 4 3 5\nf 3 2 5\nf 2 1 5\nf 4 1 6\nf 3 4 6\nf 2 3 6\nf 1 2 6\n"
    )
    (tmp_path / "good.ply").write_bytes(ply_bytes(Triangles(corners, side)))
    for name, value in {"picture": 0.5, "nan": np.nan, "bright": 1.5}.items():
        mitsuba().Bitmap(np.full((2, 2, 3), value, np.float32)).write(str(tmp_path / f"{name}.exr"))
    (tmp_path / "cloud.ply").write_bytes(ply_bytes(Triangles(corners, side[:0])))
    (tmp_path / "noise.ply").write_bytes(np.random.default_rng(5).bytes(4000))
    return tmp_path


def test_the_scene_that_the_cases_spoil_is_good(folder: Path) -> None:
    path = folder / "good.xml"
    path.write_text(GOOD)
    assert load(path).name == "good"


@pytest.mark.parametrize("case", CASES | MORE_CASES)
def test_a_bad_scene_is_refused_in_one_sentence(folder: Path, case: str) -> None:
    old, new, words = (CASES | MORE_CASES)[case]
    assert GOOD.count(old) == 1
    path = folder / "bad.xml"
    path.write_text(GOOD.replace(old, new))
    sentence = refusal(path)
    assert words in sentence
    assert "bad.xml" in sentence


def test_a_scene_without_any_light_is_refused(folder: Path) -> None:
    path = folder / "dark.xml"
    path.write_text(GOOD[: GOOD.index(SPOT)] + GOOD[GOOD.index("</emitter>") + len("</emitter>") :])
    assert refusal(path) == f"{path} has no light: add a <emitter type='point'> or a <emitter type='spot'>."


# --- files -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["none.xml", "nothing", "", ".", "..", "/", "a/b/c", "n" * 300, "/" + "n" * 5000, "zero\0byte", "/dev/zero"]
)
def test_what_is_no_file_is_no_scene(name: str) -> None:
    sentence = refusal(name)
    assert sentence.startswith(f"There is no scene '{name}'")
    assert all(f" {shipped}" in sentence for shipped in ("donut_dragon", "empty", "sphere"))


def test_a_folder_is_no_scene(tmp_path: Path) -> None:
    (tmp_path / "scene.xml").mkdir()
    assert "There is no scene" in refusal(tmp_path / "scene.xml")


def test_a_shipped_name_does_not_reach_out_of_the_folder() -> None:
    with pytest.raises(InputError, match="There is no scene"):
        scene_path("../scenes/nowhere/empty")


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "scene.xml")
    assert "There is no scene" in refusal(tmp_path / "scene.xml")


def test_a_file_that_gives_read_errors_is_refused() -> None:
    """The root user may read every file; this one cannot be read by anyone from its start."""
    assert "/proc/self/mem" in refusal("/proc/self/mem")


def test_binary_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "noise.xml"
    path.write_bytes(np.random.default_rng(2).bytes(100_000))
    assert "noise.xml" in refusal(path)
    path.write_bytes(b"\0" * 50_000_000)
    assert "noise.xml" in refusal(path)


def test_another_encoding_is_named(tmp_path: Path) -> None:
    path = tmp_path / "latin.xml"
    path.write_bytes(GOOD.replace('id="ball"', 'id="bäll"').encode("latin-1"))
    assert refusal(path) == f"{path} is not UTF-8; save it as UTF-8."


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_files_that_mark_their_encoding_are_read(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "marked.xml"
    path.write_bytes(GOOD.encode(encoding))
    assert load(path).name == "marked"


def test_deep_includes_are_followed_and_deeper_ones_refused(tmp_path: Path) -> None:
    """Mitsuba allows fifteen."""
    for depth in range(30):
        inner = f'<include filename="level{depth + 1}.xml"/>' if depth < 29 else ""
        (tmp_path / f"level{depth}.xml").write_text(f'<scene version="3.0.0">{inner}</scene>')
    path = tmp_path / "bad.xml"
    for level, good in ((29, True), (20, True), (0, False)):
        path.write_text(GOOD.replace(SPOT, f'<include filename="level{level}.xml"/>{SPOT}'))
        if good:
            assert load(path).name == "bad"
        else:
            assert "include recursion depth" in refusal(path)


def test_many_levels_of_nesting_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "deep.xml"
    path.write_text(GOOD.replace(PAINT, '<bsdf type="twosided">' * 1500 + PAINT + "</bsdf>" * 1500))
    assert "elements nest deeper" in refusal(path)


# --- parameters and size ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"sigma": 1}, "no use for the parameter $sigma "),
        ({"k": 0.3}, "no use for the parameter $k "),
        ({"scene": 1}, "no use for the parameter $scene "),
        ({"": 1}, "no use for the parameter"),
        ({"sigma_t": "thick"}, "could not parse floating point value"),
        ({"sigma_t": True}, "could not parse floating point value"),
        ({"sigma_t": None}, "could not parse floating point value"),
        ({"sigma_t": ""}, "was given no value"),
        ({"sigma_t": "$sigma_t"}, "undefined parameter"),
        ({"sigma_t": "nan"}, "should be finite"),
        ({"sigma_t": -1}, "not negative"),
        ({"phase": "mie"}, "mie.xml"),
        ({"phase": "../empty"}, "empty.xml"),
        ({"config": 1}, "cannot be given a parameter called config"),
        ({"filename": 1}, "cannot be given a parameter called filename"),
        ({"intensity": 0}, "has no intensity"),
    ],
)
def test_a_bad_parameter_is_refused(parameters: dict[str, object], words: str) -> None:
    sentence = refusal("empty", **parameters)
    assert words in sentence
    assert ".xml" in sentence


@pytest.mark.parametrize(
    "size", [(0, 8), (8, 0), (-1, 8), (16385, 8), (10**12, 8), (2.5, 8), (float("nan"), 8), ("8", "8")]
)
def test_a_size_that_no_image_can_have_is_refused(size: tuple[int, int]) -> None:
    sentence = refusal("empty", size=size)
    assert sentence == f"An image of {size[0]} x {size[1]} pixels cannot be made: use 1 to 16384 on each side."


def test_a_mesh_folder_that_is_not_there_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AIRLIGHT_MESH_DIR", "/nowhere")
    assert "AIRLIGHT_MESH_DIR names the folder /nowhere" in refusal("donut_dragon")
