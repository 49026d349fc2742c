"""`airlight gate`: the committed limits hold, and what does not is named, with its pictures and an exit code."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from junitparser import JUnitXml

from experiments.exr import read_exr
from experiments.gate import limits, rounding, suite
from experiments.gate.limits import read_limits, write_limits
from experiments.gate.references import reference_path
from experiments.gate.suite import gate_cases, gate_scenes, stand_in_meshes
from scenes.meshes.files import find_mesh

CASE = "whole-sphere-isotropic-Nishita1987"


@pytest.fixture
def own_limits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the committed limits that a test may spoil."""
    own = tmp_path / "limits.toml"
    own.write_text(limits.PATH.read_text(encoding="utf-8"), encoding="utf-8")
    monkeypatch.setattr(limits, "PATH", own)
    return own


def test_the_gate_holds(airlight, tmp_path: Path) -> None:
    result = airlight("gate", "--junit", "gate.xml")
    assert result.code == 0, result.out + result.err
    cases = gate_cases()
    assert f"{5 * len(cases)} values of {len(cases)} cases within their limits" in result.out
    found = JUnitXml.fromfile(str(tmp_path / "gate.xml"))
    # one reference was drawn
    assert (found.tests, found.failures) == (5 * len(cases) + 1, 0)
    assert "estimated anew, agrees" in " ".join(result.out.split())
    assert not (tmp_path / "gate-failures").exists()


def test_a_value_beyond_its_limit_is_named_and_drawn(airlight, own_limits: Path, tmp_path: Path) -> None:
    found = read_limits()
    one = found[CASE]["scattering.rel_95"]
    # as if the error had been three margins less
    found[CASE]["scattering.rel_95"] = replace(one, value=one.value - 3 * one.margin)
    write_limits(found, {})
    result = airlight("gate", "--case", CASE, "--seed", 1, "--out", "failed", "--junit", "gate.xml")
    assert result.code == 1
    told = " ".join(result.err.split())
    assert f"Failed: {CASE}: scattering.rel_95 is" in told
    assert "above its limit" in told
    assert "3.0 margins" in told
    assert f"failed/{CASE}.exr" in result.out
    layers, metadata = read_exr(tmp_path / "failed" / f"{CASE}.exr")
    assert layers["reference.scattering"].shape == layers["scattering"].shape == (64, 64, 3)
    assert metadata["technique"] == "Nishita1987"
    assert (tmp_path / "failed" / f"{CASE}.png").is_file()
    assert JUnitXml.fromfile(str(tmp_path / "gate.xml")).failures == 1


def test_a_missing_reference_is_a_failure(airlight, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(suite, "REFERENCES", tmp_path / "none")
    result = airlight("gate", "--case", CASE)
    assert result.code == 1
    # of the case, and of the check that was to estimate it anew
    assert result.err.count("There is no committed reference") == 2
    assert "FAILS" in result.out


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--case", "no_such"), "The gate has no case 'no_such'"),
        (("--update", "--mutations"), "two commands"),
        (("--update", "--case", CASE), "--case has no meaning beside --update"),
        (("--mutations", "--junit", "a.xml"), "--junit has no meaning beside --mutations"),
    ],
)
def test_what_cannot_be_meant_is_refused(airlight, words: tuple[str, ...], sentence: str) -> None:
    result = airlight("gate", *words)
    assert (result.code, result.err.count("\n")) == (2, 1)
    assert sentence in result.err


def spoil(text: str, how: str) -> str:
    first = next(line for line in text.splitlines() if line.startswith('"scattering.rel_50"'))
    return {
        "cut": text[: len(text) // 2],
        "no number": text.replace(first, first.replace("margin = ", "margin = nan #"), 1),
        "negative": text.replace(first, first.replace("margin = ", "margin = -"), 1),
        "a line less": text.replace(first + "\n", "", 1),
        "a case more": text + f'\n[limits."no_such"]\n{first}\n',
        "no table": "limits = 3",
        "a list": "[limits]\nx = [1]",
    }[how]


@pytest.mark.parametrize(
    "how", ["cut", "no number", "negative", "a line less", "a case more", "no table", "a list", "gone"]
)
def test_damaged_limits_are_refused(airlight, own_limits: Path, how: str) -> None:
    if how == "gone":
        own_limits.unlink()
    else:
        own_limits.write_text(spoil(own_limits.read_text(encoding="utf-8"), how), encoding="utf-8")
    result = airlight("gate")
    assert (result.code, result.err.count("\n")) == (2, 1)
    assert str(own_limits) in result.err
    assert "airlight gate --update" in result.err


def test_update_measures_anew_and_says_what_changed(
    airlight, own_limits: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    committed = read_limits()[CASE]
    other = {CASE: committed | {"composite.flip": replace(committed["composite.flip"], value=0.5)}, "lost": committed}
    write_limits(other, {})
    monkeypatch.setattr(suite, "gate_cases", lambda names: gate_cases([CASE]))
    monkeypatch.setattr(rounding, "TRIALS", 1)
    result = airlight("gate", "--update", "--runs", 1)
    assert result.code == 0, result.err
    measured = read_limits()
    assert list(measured) == [CASE]
    flip = next(line for line in result.out.splitlines() if CASE in line and "composite.flip" in line)
    assert f"0.5 -> {measured[CASE]['composite.flip'].value:.4g}" in flip
    # the case that is no more
    assert sum("lost" in line and "-> none" in line for line in result.out.splitlines()) == 5
    for metric, one in measured[CASE].items():
        assert one.value == pytest.approx(committed[metric].value, abs=committed[metric].margin)
        # an idle and a loaded run at two widths of llvmpipe's vectors
        assert one.repeats == 0
        assert one.rounding > 0


def test_meshes_are_stand_ins_on_every_machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    name = "dragon_97k_fixed.ply"
    for folder in (tmp_path / "meshes", tmp_path / "data" / "airlight" / "meshes"):
        folder.mkdir(parents=True)
        (folder / name).touch()
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    for variable in (str(tmp_path / "meshes"), None):
        if variable is None:
            monkeypatch.delenv("AIRLIGHT_MESH_DIR")
        else:
            monkeypatch.setenv("AIRLIGHT_MESH_DIR", variable)
        assert not find_mesh(name, tmp_path).is_stand_in
        with stand_in_meshes():
            assert find_mesh(name, tmp_path).is_stand_in
        assert not find_mesh(name, tmp_path).is_stand_in


def test_the_repository_has_the_references_of_the_suite_and_no_others() -> None:
    with stand_in_meshes():
        scenes = gate_scenes(gate_cases())
    kept = sorted(suite.REFERENCES.iterdir())
    assert [path.stem for path in kept] == sorted(scenes)
    assert [reference_path(suite.REFERENCES, scenes[name]) for name in sorted(scenes)] == kept
    assert sum(path.stat().st_size for path in kept) < 1_000_000
