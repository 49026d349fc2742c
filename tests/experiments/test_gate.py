"""`airlight gate`: the committed limits hold, and what does not is named, with its pictures and an exit code."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from junitparser import JUnitXml

from experiments.exr import read_exr
from experiments.gate import gating, junit, limits, rounding, suite
from experiments.gate.agreement import Agreement
from experiments.gate.gating import Result, check_folder, run_gate
from experiments.gate.junit import write_junit
from experiments.gate.limits import Limit, read_limits, write_limits
from experiments.gate.references import reference_path
from experiments.gate.suite import gate_cases, gate_scenes, stand_in_meshes
from experiments.gate.verdicts import Verdict
from experiments.run.watcher import Watcher
from scenes.errors import InputError
from scenes.meshes.files import find_mesh
from scenes.model import Scene

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


@pytest.mark.parametrize("option", ["--junit", "--out"])
@pytest.mark.parametrize("bad", ["a_file/gate", "a_file/deeper/gate", "no_folder/gate.xml", "folder"])
def test_a_place_that_cannot_be_written_is_refused_before_the_work(
    airlight, tmp_path: Path, option: str, bad: str
) -> None:
    (tmp_path / "a_file").touch(0o755)
    (tmp_path / "folder").mkdir()
    if option == "--out" and not bad.startswith("a_file"):
        check_folder(tmp_path / bad)
    else:
        result = airlight("gate", option, bad)
        assert (result.code, result.err.count("\n"), result.out) == (2, 1, "")
        assert bad.partition("/")[0] in result.err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a_file", "folder"]


FAILED = Verdict(CASE, "scattering.rel_95", 0.5, Limit(0.1, 0.0, 0.0, 0.01))


@pytest.mark.parametrize(("verdicts", "code"), [((FAILED,), 1), ((), 2)])
def test_a_disk_that_is_full_does_not_lose_the_verdict(
    airlight, monkeypatch: pytest.MonkeyPatch, verdicts: tuple[Verdict, ...], code: int
) -> None:
    def full(*arguments: object) -> None:
        raise InputError("The disk is full.")

    monkeypatch.setattr(gating, "run_gate", lambda *arguments: Result(verdicts, {}, ()))
    monkeypatch.setattr(gating, "write_pictures", full)
    monkeypatch.setattr(junit, "write_junit", full)
    result = airlight("gate", "--junit", "gate.xml")
    assert result.code == code
    assert result.err.count("The disk is full.") == code % 2 + 1
    assert (f"Failed: {CASE}: scattering.rel_95 is 0.5" in result.err) == bool(verdicts)


@pytest.mark.parametrize("text", ["\x00", "\x1b[31mred", "\ud800", "\uffff", "\x0b", '<&"]]>'])
def test_junit_is_xml_whatever_a_reason_holds(tmp_path: Path, text: str) -> None:
    path = tmp_path / "gate.xml"
    skipped = Agreement(f"reference {text}", None, reason=f"not {text} here")
    write_junit(
        Result((replace(FAILED, case=f"case {text}"),), {f"name {text}": f"because {text} so"}, (skipped,)), path
    )
    found = ElementTree.parse(path).getroot()
    reasons = [one.get("message") for kind in ("failure", "skipped") for one in found.iter(kind)]
    assert len(reasons) == 3
    assert any(reason.startswith("because ") and reason.endswith(" so") for reason in reasons)
    if text.isprintable():
        assert f"because {text} so" in reasons


def test_the_reference_that_is_estimated_anew_is_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn, seeds = [], set()

    def check(folder: Path, scene: Scene, seed: int) -> Agreement:
        drawn.append(reference_path(folder, scene).stem)
        seeds.add(seed)
        return Agreement(drawn[-1], None)

    cases = gate_cases([CASE, "whole-sphere-rayleigh-Nishita1987", "parts-sphere-FrontFinal"])
    monkeypatch.setattr(gating, "_rows", lambda cases, watcher: [])
    monkeypatch.setattr(gating, "check_reference", check)
    for seed in range(16):
        run_gate(cases, {}, "one", seed, Watcher())
    assert len(drawn) == 16
    # a seed draws the same again
    assert len(set(drawn)) == 2
    run_gate(cases, {}, "one", 3, Watcher())
    assert (drawn[16], len(seeds)) == (drawn[3], 16)
    run_gate(cases, {}, "all", 0, Watcher())
    assert drawn[17:] == sorted(set(drawn))


def test_that_nothing_was_estimated_anew_is_said(airlight, monkeypatch: pytest.MonkeyPatch) -> None:
    found = Agreement("sphere", None, reason="scalar_rgb averages over pixels")
    monkeypatch.setattr(gating, "run_gate", lambda *arguments: Result((), {}, (found,)))
    result = airlight("gate")
    assert result.code == 0
    assert "sphere is not estimated anew: scalar_rgb averages over pixels" in result.err
    assert "within their limits; no reference was estimated anew" in result.out


def widened(text: str, line: str) -> str:
    margin = re.search(r"margin = (\S+) }", line)[1]
    return text.replace(line, line.replace(f"margin = {margin}", f"margin = {1.001 * float(margin):.6e}"), 1)


def spoil(text: str, how: str) -> str:
    first = next(line for line in text.splitlines() if line.startswith('"scattering.rel_50"'))
    return {
        "cut": text[: len(text) // 2],
        "no number": text.replace(first, first.replace("margin = ", "margin = nan #"), 1),
        "negative": text.replace(first, first.replace("margin = ", "margin = -"), 1),
        "a line less": text.replace(first + "\n", "", 1),
        "a case more": text + f'\n[limits."no_such"]\n{first}\n',
        "wider": widened(text, first),
        "no table": "limits = 3",
        "a list": "[limits]\nx = [1]",
    }[how]


@pytest.mark.parametrize(
    "how", ["cut", "no number", "negative", "wider", "a line less", "a case more", "no table", "a list", "gone"]
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
    assert "1 runs are a trial" in result.err
    assert "not to be committed" in own_limits.read_text(encoding="utf-8")
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
