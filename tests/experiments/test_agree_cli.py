"""`airlight agree`: what it prints, what it writes, and when it complains."""

from __future__ import annotations

import json
import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import typer
from PIL import Image
from typer.testing import CliRunner

from experiments.agree import cases, report
from experiments.agree.cases import Case, list_cases
from experiments.agree_cli import agree
from experiments.exr import read_exr
from reference.agreement.witnesses import Witnesses, call_witnesses
from reference.mutations import MUTATIONS
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Scene

app = typer.Typer()
app.command()(agree)

EMPTY, SIZE = Case("empty", {}), (16, 16)
SCALES = ("pixels", "tiles", "image")


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load("empty", size=SIZE)


@pytest.fixture(scope="module")
def witnesses(scene: Scene) -> Witnesses:
    return call_witnesses(scene, 1.0)


@pytest.fixture
def called(witnesses: Witnesses, monkeypatch: pytest.MonkeyPatch) -> None:
    """Witnesses that are there already."""
    monkeypatch.setattr(cases, "call_witnesses", lambda *_: witnesses)


@pytest.fixture
def doubted(witnesses: Witnesses, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same, but that volpath saw half as much again."""
    *ours, theirs = witnesses.composite
    brighter = replace(theirs, image=replace(theirs.image, mean=1.5 * theirs.image.mean))
    bad = replace(witnesses, composite=(*ours, brighter))
    monkeypatch.setattr(cases, "call_witnesses", lambda *_: bad)


def test_the_table(called, capsys: pytest.CaptureFixture) -> None:
    assert report.run_agree([EMPTY], SIZE, 1.0)
    printed = capsys.readouterr()
    for text in (
        "equiangular - deterministic",
        "deterministic - volpath",
        "image mean",
        "critical",
        "All three agree.",
    ):
        assert text in printed.out
    assert "DISAGREES" not in printed.out
    assert "Allowed for: volpath stops short of a light" in printed.out
    # one second is not enough for it
    assert "stopped at its time limit" in printed.err


def test_a_disagreement_is_an_error(doubted, capsys: pytest.CaptureFixture) -> None:
    assert not report.run_agree([EMPTY], SIZE, 1.0)
    printed = capsys.readouterr().out
    assert printed.count("DISAGREES") == 2
    assert "These disagree: equiangular - volpath; deterministic - volpath." in printed
    assert CliRunner().invoke(app, ["empty", "--size", "16", "16", "--time-limit", "1"]).exit_code == 1


def test_mutations_and_the_page(called, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert report.run_agree([EMPTY], SIZE, 1.0, mutations=True, out=tmp_path)
    printed = capsys.readouterr().out
    assert printed.count("no bearing on this scene") == 2
    assert "noticed by all" in printed
    assert "Each mutation that matters is noticed." in printed
    assert {path.name for path in tmp_path.iterdir()} == {"README.md", "agreement.json", "z.exr", "z_histogram.png"}
    page = (tmp_path / "README.md").read_text()
    assert page.startswith("# Do independent estimates agree?\n")
    for mutation in MUTATIONS:
        assert f"| {mutation.name} |" in page
    assert "no bearing on this scene: nothing shades the fog that is seen" in page
    (found,) = json.loads((tmp_path / "agreement.json").read_text())["cases"]
    assert [pair["pair"] for pair in found["comparisons"]][2] == ["deterministic", "volpath"]
    assert len(found["mutations"]) == 8
    layers, metadata = read_exr(tmp_path / "z.exr")
    assert metadata["scene"] == "empty"
    z = layers["z.equiangular_volpath"]
    assert z.shape == (16, 16, 3)
    assert np.abs(z).max() == pytest.approx(abs(found["comparisons"][1]["tests"][0]["largest"]), rel=1e-6)
    ours, theirs = (layers[f"mean.composite_as_volpath.{name}"] for name in ("equiangular", "volpath"))
    error = layers["standard_error.composite_as_volpath.volpath"]
    assert (np.sign(ours - theirs)[np.abs(z) > 0.1] == np.sign(z)[np.abs(z) > 0.1]).all()
    assert (error > 0).all()
    assert np.asarray(Image.open(tmp_path / "z_histogram.png")).std() > 10


def test_an_unnoticed_mutation_is_an_error(called, monkeypatch, capsys: pytest.CaptureFixture) -> None:
    weak = replace(MUTATIONS[2], name="nothing at all", around=MUTATIONS[1].around)
    monkeypatch.setattr(cases, "MUTATIONS", (weak,))
    assert not report.run_agree([EMPTY], SIZE, 1.0, mutations=True)
    printed = capsys.readouterr().out
    assert "Unnoticed: nothing at all (empty)." in printed
    assert "passes" in printed


def test_several_cases_make_one_page(called, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    listed = [*list_cases(["empty"], False, True, {"sigma_t": "0.02"})[:2], Case("nowhere", {"phase": "hg"})]
    assert not report.run_agree(listed, SIZE, 1.0, out=tmp_path, command="airlight agree several")
    printed = capsys.readouterr()
    assert "empty cornette_shanks: agrees; catches" in printed.out
    assert "nowhere hg: failed" in printed.err
    assert "These failed: nowhere hg." in printed.out
    assert {path.name for path in tmp_path.iterdir()} == {"README.md", "agreement.json", "z_histogram.png"}
    page, found = (tmp_path / "README.md").read_text(), json.loads((tmp_path / "agreement.json").read_text())
    assert "    airlight agree several\n" in page
    assert "**failed**: There is no scene 'nowhere'" in page
    rows = [line for line in page.splitlines() if line.startswith(("| empty |", "| | |", "| nowhere |"))]
    assert len(rows) == 3 + 3 + 1
    # the header of the table has as many columns as each row
    header = next(line for line in page.splitlines() if line.startswith("| scene |"))
    assert {row.count("|") for row in rows} == {header.count("|")}
    assert [case["failure"] == "" for case in found["cases"]] == [True, True, False]
    # the same witnesses twice: known better by the square root of two
    alone = found["cases"][0]["comparisons"][2]
    assert found["pooled"]["cases"] == 2
    assert found["pooled"]["bias"] == pytest.approx(1 / (1 + alone["difference"]) - 1, rel=1e-9)
    assert found["pooled"]["power"] < 0.75 * alone["tests"][2]["catches"]
    assert f"Over 2 cases, volpath's image mean is {found['pooled']['bias']:+.4%} off" in page


def test_a_crash_of_one_case_leaves_the_others(called, monkeypatch, capsys: pytest.CaptureFixture) -> None:
    def crash(scene: Scene, case: Case, *rest: object) -> object:
        if case.parameters:
            raise ZeroDivisionError("of no use")
        return cases.examine(scene, case, *rest)

    monkeypatch.setattr(report, "examine", crash)
    assert not report.run_agree([Case("empty", {"sigma_t": "0.02"}), EMPTY], SIZE, 1.0)
    printed = capsys.readouterr()
    assert "ZeroDivisionError: of no use" in printed.err
    assert "Over 1 cases" not in printed.out
    assert "empty: agrees" in printed.out


def test_cases() -> None:
    every = list_cases([], True, True, {"g": "0.3"})
    assert len(every) == 11 * 6
    assert {case.parameters["phase"] for case in every} == {
        "cornette_shanks",
        "hg",
        "isotropic",
        "rayleigh",
        "schlick",
        "tabphase",
    }
    assert list_cases(["a", "b", "a"], False, False, {}) == [Case("a", {}), Case("b", {})]
    for scenes, whole in (([], False), (["sphere"], True)):
        with pytest.raises(InputError, match="--all"):
            list_cases(scenes, whole, False, {})
    with pytest.raises(InputError, match="exclude each other"):
        list_cases(["sphere"], False, True, {"phase": "hg"})


def test_the_command_of_a_page_makes_it_again(called, tmp_path: Path) -> None:
    asked = ["empty", "-p", "sigma_t=0.02", "--size", "16", "16", "--time-limit", "1", "--out", str(tmp_path / "a b")]
    assert CliRunner().invoke(app, asked).exit_code == 0
    assert f"    airlight agree {shlex.join(asked)}\n" in (tmp_path / "a b" / "README.md").read_text()


def test_what_cannot_be_meant_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="time limit is 0"):
        report.run_agree([EMPTY], SIZE, 0)
    (tmp_path / "README.md").write_text("# My notes\n")
    result = CliRunner().invoke(app, ["empty", "--out", str(tmp_path)])
    assert isinstance(result.exception, InputError)
    assert "another page" in str(result.exception)
    for name in ("agreement.json", "z.exr"):
        folder = tmp_path / name
        folder.mkdir()
        (folder / name).write_text("mine")
        result = CliRunner().invoke(app, ["empty", "--out", str(folder)])
        assert isinstance(result.exception, InputError)
        assert "of no page of ours" in str(result.exception)
        assert (folder / name).read_text() == "mine"


def test_a_black_volpath_is_told(called, witnesses: Witnesses, monkeypatch, tmp_path: Path, capsys) -> None:
    *ours, theirs = witnesses.composite
    dark = {scale: replace(getattr(theirs, scale), mean=0 * getattr(theirs, scale).mean) for scale in SCALES}
    wide = {scale: replace(one, variance=one.variance + 1e9) for scale, one in dark.items()}
    black = replace(witnesses, composite=(*ours, replace(theirs, **wide)), volpath_error=np.inf, volpath_samples=99)
    monkeypatch.setattr(cases, "call_witnesses", lambda *_: black)
    assert report.run_agree([EMPTY], SIZE, 1.0, out=tmp_path)
    printed = capsys.readouterr()
    assert "The two that met light agree." in printed.out
    assert "stopped at its time limit" not in printed.err
    page = (tmp_path / "README.md").read_text()
    assert page.count("| none | none | none | volpath met no light in 99 samples |") == 2
    assert json.loads((tmp_path / "agreement.json").read_text())["cases"][0]["volpath_error"] is None


def test_surfaces_that_disagree_are_an_error(called, witnesses: Witnesses, monkeypatch, tmp_path: Path, capsys) -> None:
    bad = replace(witnesses, surfaces=replace(witnesses.surfaces, excess=1e-3))
    monkeypatch.setattr(cases, "call_witnesses", lambda *_: bad)
    assert not report.run_agree([EMPTY], SIZE, 1.0, out=tmp_path)
    assert "These disagree: surfaces." in capsys.readouterr().out
    assert "**not so in empty: surfaces: " in (tmp_path / "README.md").read_text()
    assert not report.run_agree([EMPTY, EMPTY], SIZE, 1.0)
    assert "These disagree: empty: surfaces; empty: surfaces." in capsys.readouterr().out


def test_what_fails_unspoilt_too_cannot_tell(doubted, monkeypatch, capsys: pytest.CaptureFixture) -> None:
    weak = replace(MUTATIONS[2], name="nothing at all", around=MUTATIONS[1].around)
    monkeypatch.setattr(cases, "MUTATIONS", (weak,))
    assert not report.run_agree([EMPTY], SIZE, 1.0, mutations=True)
    printed = capsys.readouterr().out
    assert "cannot tell" in printed
    assert "Unnoticed: nothing at all (empty)." in printed
