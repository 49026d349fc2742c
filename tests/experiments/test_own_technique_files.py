"""Commands with a technique of somebody's own: what files and runs keep of it, and that suites draw it everywhere."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import polars
import pytest
from registries import restored_registries

from experiments.exr import read_exr, write_exr
from experiments.provenance import describe_own_files, describe_technique
from gpu_impl.techniques import find_technique

TOML = 'name = "Mine"\nvisibility = "march.glsl"\nairlight = "riemann"\n\n[settings]\nsteps = 9\n'
MARCH = """#include "shadow_lookup.glsl"
#include "share.glsl"
void visibility(Ray ray, Light light) {
    for (int i = 0; i < STEPS; ++i) lit(SHARE * float(i) / float(STEPS), ray.t_max / float(STEPS), 1.0);
}
"""
SUITE = """
scenes = ["empty"]
size = [16, 12]
reference = { rel_error = 0.1 }
techniques = [{ name = "own/mine.toml" }, { name = "own/mine.toml", steps = 12 }]
"""


@pytest.fixture(autouse=True)
def _registries() -> Iterator[None]:
    with restored_registries():
        yield


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A technique in a folder beside a suite."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "mine.toml").write_text(TOML)
    (tmp_path / "own" / "march.glsl").write_text(MARCH)
    (tmp_path / "own" / "share.glsl").write_text("#define SHARE ray.t_max\n")
    (tmp_path / "suite.toml").write_text(SUITE)
    return tmp_path / "own"


def test_a_picture_keeps_the_texts_and_is_drawn_again_from_them(airlight, own: Path) -> None:
    result = airlight("render", "empty", "--size", 16, 12, "--technique", "own/mine.toml", "--out", "a.exr")
    assert result.code == 0, result.err
    assert ", Mine, " in result.out
    layers, metadata = read_exr(Path("a.exr"))
    assert metadata["technique"] == "Mine"
    assert metadata["steps"] == "9"
    assert metadata["technique_file"] == str(own / "mine.toml")
    texts = json.loads(metadata["technique_texts"])
    assert texts == {str(own / name): (own / name).read_text() for name in ("mine.toml", "march.glsl", "share.glsl")}
    # whatever the files hold now, and where there are none
    (own / "share.glsl").write_text("#define SHARE 0.0\n")
    assert airlight("render", "empty", "--size", 16, 12, "--technique", "own/mine.toml", "--out", "b.exr").code == 0
    assert (read_exr(Path("b.exr"))[0]["scattering"] != layers["scattering"]).any()
    for path in list(own.iterdir()):
        path.unlink()
    with restored_registries():
        again = airlight("render", "--again", "a.exr")
    assert again.code == 0, again.err
    assert "the same pixels as a.exr, bit for bit" in again.out
    np.testing.assert_array_equal(read_exr(Path("a-again.exr"))[0]["scattering"], layers["scattering"])
    assert read_exr(Path("a-again.exr"))[1]["technique_texts"] == metadata["technique_texts"]


@pytest.mark.parametrize("texts", ["{", "[]", "{}", "3"])
def test_texts_that_cannot_be_are_refused(airlight, own: Path, texts: str) -> None:
    assert airlight("render", "empty", "--size", 8, 6, "--technique", "own/mine.toml", "--out", "a.exr").code == 0
    layers, metadata = read_exr(Path("a.exr"))
    write_exr(Path("a.exr"), layers, metadata | {"technique_texts": texts})
    result = airlight("render", "--again", "a.exr")
    assert result.code == 2
    assert "technique_texts" in result.err
    assert "render the scene anew" in result.err


@pytest.mark.parametrize(
    ("file", "text", "said"),
    [
        ("march.glsl", MARCH.replace("lit(", "litt("), "own/march.glsl:4(30): error: no function with name 'litt'"),
        (
            "mine.toml",
            TOML.replace("steps = 9", "steps = 0"),
            "own/mine.toml (line 6): the key 'settings.steps': steps is",
        ),
        ("mine.toml", "name = ", "own/mine.toml is not TOML"),
    ],
)
def test_mistakes_end_in_one_sentence_and_code_2(airlight, own: Path, file: str, text: str, said: str) -> None:
    (own / file).write_text(text)
    result = airlight("render", "empty", "--size", 8, 6, "--technique", "own/mine.toml", "--out", "a.exr")
    assert result.code == 2
    assert said in result.err
    assert result.err.count("\n") == 1
    assert not Path("a.exr").exists()


def test_a_suite_names_it_from_its_own_folder_and_a_changed_file_is_another_run(
    airlight, own: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    # its cases run in a worker, which has never seen it
    result = airlight("run", tmp_path / "suite.toml", "--out", tmp_path / "runs")
    assert result.code == 0, result.err
    (folder,) = (tmp_path / "runs").iterdir()
    # elsewhere nobody knows the settings of its own, so that all that are not anybody's are told
    table = polars.read_parquet(folder / "results.parquet")
    assert table["case"].to_list() == ["empty-Mine-steps-9", "empty-Mine-steps-12"]
    assert table["status"].to_list() == ["done", "done"]
    assert table["visibility"].str.contains("^march.glsl@[0-9a-f]{12}$").all()
    assert (
        json.loads(read_exr(folder / "empty-Mine-steps-9.exr")[1]["technique_texts"])[str(own / "march.glsl")] == MARCH
    )
    # once, and nowhere else beside the pictures
    texts = {str(own / name): (own / name).read_text() for name in ("mine.toml", "march.glsl", "share.glsl")}
    assert json.loads((folder / "run.json").read_text())["own_techniques"] == {str(own / "mine.toml"): texts}
    assert not {"technique_file", "technique_texts"} & set(table.columns)
    for name in ("results.csv", "results.parquet", "report.html", "cases/empty-Mine-steps-9.json"):
        told = (folder / name).read_bytes()
        assert b"void visibility" not in told, name
        assert str(own).encode() not in told, name
    # the same cases by name, of another technique
    (own / "share.glsl").write_text("#define SHARE 0.0\n")
    result = airlight("run", tmp_path / "suite.toml", "--resume", folder)
    assert result.code == 2
    assert "is a run of other cases" in result.err


def test_two_techniques_of_one_name_are_told_apart_by_their_files(airlight, own: Path) -> None:
    (own / "other.toml").write_text(TOML.replace("riemann", "quadrature"))
    suite = SUITE.replace('own/mine.toml", steps = 12', 'own/other.toml"')
    (own.parent / "suite.toml").write_text(suite)
    result = airlight("run", own.parent / "suite.toml", "--out", own.parent / "runs")
    assert result.code == 2
    assert "Two cases have the same name, empty-Mine" in result.err
    assert "or your technique (`name`)." in result.err


def test_what_tables_say_of_a_technique_holds_no_file(own: Path) -> None:
    technique = find_technique(str(own / "mine.toml"))
    told = describe_technique(technique)
    assert told["technique"] == "Mine"
    assert told["steps"] == 9
    assert str(own) not in str(told)
    assert describe_own_files(technique) == {"technique_file": technique.file, "technique_texts": technique.texts}
    assert describe_own_files(find_technique("Weng2010")) == {}
