"""A suite is what its TOML file says."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from experiments.suite import FOLDER, load_suite, shipped
from reference.goal import Goal
from scenes.loader import load


@pytest.mark.parametrize("name", shipped())
def test_a_shipped_suite_can_be_run(name: str) -> None:
    found, suite = load_suite(name)
    assert found == name
    for scene in suite.scenes:
        loaded = load(scene, size=suite.size, **suite.parameters)
        for choice in suite.techniques:
            choice.technique().check_scene(loaded)


def test_quick_is_the_main_job() -> None:
    _, suite = load_suite("quick")
    assert suite.scenes == ["empty", "sphere", "donut_dragon"]
    assert suite.size == (256, 256)
    names = [choice.technique().name for choice in suite.techniques]
    assert names == ["Weng2010", "Nishita1987", "lit_intervals+quadrature"]
    assert suite.techniques[1].technique().steps == 64


def test_a_path_is_taken_before_a_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = tmp_path / "mine.toml"
    shutil.copy(FOLDER / "quick.toml", own)
    assert load_suite(str(own))[0] == "mine"
    monkeypatch.chdir(tmp_path)
    (tmp_path / "quick").write_text('scenes = ["empty"]\nsize = [4, 4]\n[[techniques]]\nname = "Weng2010"\n')
    assert load_suite("quick")[1].size == (4, 4)


def test_what_is_left_out_has_a_default(tmp_path: Path) -> None:
    path = tmp_path / "small.toml"
    path.write_text('scenes = ["empty"]\nsize = [4, 5]\n[[techniques]]\nname = "Weng2010"\nsteps = 7\n')
    _, suite = load_suite(str(path))
    assert suite.reference.goal() == Goal(0.005, 600.0)
    assert suite.parameters == {}
    technique = suite.techniques[0].technique()
    assert (technique.steps, technique.downsample) == (7, 1)
