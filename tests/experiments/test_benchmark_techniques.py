"""`airlight benchmark techniques`: its rounds, its pairs and its page."""

from __future__ import annotations

import csv
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from experiments.metrics import measure
from experiments.rounds import Times
from experiments.technique_benchmark import report, summary, tables
from experiments.technique_benchmark.contenders import (
    AS_DENSE,
    BASELINE,
    BOUNDED,
    CONTENDERS,
    FAST_ROWS,
    PAIRS,
    chosen,
    published_rate,
)
from experiments.technique_benchmark.measurement import Measured, Result
from gpu_impl.device import shared_device
from gpu_impl.memory import Footprint
from gpu_impl.passes.scattering import COUNTERS
from reference.estimate import estimate_reference
from reference.goal import Goal
from scenes.catalogue import FOLDER
from scenes.loader import load
from scenes.model import Scene

# one of each kind, so that the whole takes seconds
FEW = tuple(one for one in CONTENDERS if one.name in ("march", "fast quadrature", "merged"))


def test_every_contender_exists_and_names_are_unique() -> None:
    names = [one.name for one in CONTENDERS]
    assert len(set(names)) == len(names)
    for one in CONTENDERS:
        one.find().check()
    assert {AS_DENSE, BOUNDED, BASELINE.name, *FAST_ROWS} <= set(names)
    for pair in PAIRS:
        first, second = (next(c.find() for c in CONTENDERS if c.name == name) for name in (pair.first, pair.second))
        # they differ in one thing: a part or a setting; the samples of one pair are found scene by scene
        different = [key for key in vars(first) if key != "name" and getattr(first, key) != getattr(second, key)]
        assert len(different) == 1, pair


def test_published_rates_are_those_of_table_5_1(tmp_path: Path) -> None:
    isotropic, rayleigh, hg = (
        load("donut_dragon", size=(2, 2), phase=phase) for phase in ("isotropic", "rayleigh", "hg")
    )
    assert published_rate(isotropic) == 23
    assert published_rate(rayleigh) == published_rate(hg) == 6
    assert published_rate(load("sphere", size=(2, 2))) is None
    # somebody else's scene of the same name is not the thesis's
    assert published_rate(replace(isotropic, path=tmp_path / "donut_dragon.xml")) is None


def made_up(times: dict[str, np.ndarray], errors: dict[str, tuple[float, float]] | None = None) -> Result:
    """A result of given times and errors, all else invented."""
    reference = np.ones((4, 4, 3))
    measured = {}
    for one in CONTENDERS:
        technique = one.find()
        if one.name not in times:
            measured[one.name] = Measured(one, technique, refusal="It takes no such thing.")
            continue
        median, worst = (errors or {}).get(one.name, (0.01, 0.02))
        measured[one.name] = Measured(
            one,
            technique,
            metrics=replace(measure(reference, reference), rel_50=median, rel_95=worst),
            footprint=Footprint(10, 7.0, 2_000_000, 30, 4.0, 5.0),
            counts=dict.fromkeys(COUNTERS, 1.5),
            rays=16,
            times=Times(times[one.name], 1.1 * times[one.name], {"scattering": 0.5 * times[one.name]}),
        )
    scene = load("sphere", size=(4, 4))
    return Result(scene, estimate_reference(scene, Goal(0.5)), measured, "wall clock around glFinish")


def test_ratios_are_of_one_round() -> None:
    # the machine is four times slower in every other round, and the ratio is the same in all
    slow = np.array([1.0, 4.0] * 5)
    result = made_up({"march": 100 * slow, "quadrature": 50 * slow, "map in a buffer": 50 * slow[::-1]})
    row = next(row for row in summary.rows(result) if row["contender"] == "quadrature")
    assert (row["over_march"], row["over_march_low"], row["over_march_high"]) == (0.5, 0.5, 0.5)
    assert row["milliseconds_50"] == pytest.approx(125.0)
    assert row["frames_per_second"] == pytest.approx(8.0)
    assert row["clocked_over_plain"] == pytest.approx(1.1)
    assert row["milliseconds_scattering"] == pytest.approx(62.5)
    assert row["milliseconds_shadow_polygons"] == 0
    # other rounds are no pairs: half of the ratios are 4 and half 1/4
    (pair,) = summary.pair_rows(result)
    assert (pair["first"], pair["second"]) == ("quadrature", "map in a buffer")
    assert (pair["ratio_low"], pair["ratio_high"]) == (0.25, 4.0)
    assert summary.told(pair) == "no difference found"
    assert summary.told(pair | {"ratio_low": 1.01}) == "the second is faster"
    assert summary.told(pair | {"ratio_high": 0.99}) == "the first is faster"
    # the same counts and the same model: the map's place is what differs
    assert not pair["same_work"]


def test_pairs_of_models_that_count_the_same_compare_nothing() -> None:
    rounds = np.ones(6)
    result = made_up({"march": rounds, "four Ei": 2 * rounds, "three Ei": rounds, "two Ei": rounds})
    assert [summary.told(row) for row in summary.pair_rows(result)] == ["same work", "same work"]
    fewer = replace(result.contenders["three Ei"], counts=result.contenders["three Ei"].counts | {summary.EI: 1.25})
    result.contenders["three Ei"] = fewer
    rows = summary.pair_rows(result)
    assert [summary.told(row) for row in rows] == ["the second is faster", "no difference found"]
    assert (rows[0]["first_exponential_integrals"], rows[0]["second_exponential_integrals"]) == (1.5, 1.25)
    text = tables.pairs_table([result])
    assert "| 1.5 / 1.25 | the second is faster |" in text
    # claims are those of the pairs that are there
    assert text.count("\n- ") + text.startswith("- ") == 2
    assert tables.pairs_table([made_up({"march": rounds})]) == ""


def test_the_fast_row_is_the_fastest_within_the_limits() -> None:
    rounds = np.ones(6)
    times = {"march": 9 * rounds, "fast": 2 * rounds, "fast quadrature": 3 * rounds, "quadrature": rounds}
    one = summary.fastest(made_up(times))
    assert one is not None
    assert one.contender.name == "fast"
    for errors in ((0.051, 0.02), (0.01, 0.21)):
        result = made_up(times, {"fast": errors})
        assert summary.fastest(result) is result.contenders["fast quadrature"]
        assert "yes" in tables.rates_table([result])
    # where none is, the page says so
    result = made_up(times, {"fast": (0.1, 0.1), "fast quadrature": (0.1, 0.1)})
    assert summary.fastest(result) is result.contenders["fast"]
    assert "| no |" in tables.rates_table([result])
    # nor does it get the terminal's star
    assert not any("*" in name for name in names_in_terminal(result))
    assert [name for name in names_in_terminal(made_up(times)) if "*" in name] == ["fast *"]
    assert tables.rates_table([made_up({"march": rounds})]) == tables.passes_table([made_up({"march": rounds})]) == ""


def names_in_terminal(result: Result) -> list[str]:
    return [str(name) for name in report.rates([result]).columns[1].cells]


def test_a_scene_is_measured_and_written(airlight, monkeypatch, tmp_path: Path) -> None:
    # whatever runs after this in the process
    monkeypatch.setattr(report, "NO_SHADER_CACHE", {})
    out = tmp_path / "page"
    chosen = ("--contender", "fast quadrature", "--contender", "merged")
    words = ("half_plane", "--size", 24, 16, "--phase", "rayleigh", "--frames", 6, "--rel-error", 0.05, "--out", out)
    result = airlight("benchmark", "techniques", *chosen, *words)
    assert result.code == 0, result.err
    text = (out / "README.md").read_text()
    assert text.startswith("# What the techniques cost\n")
    command = (
        "benchmark techniques half_plane --size 24 16 --phase rayleigh --contender 'fast quadrature' "
        f"--contender merged --frames 6 --rel-error 0.05 --out {out}"
    )
    assert command in text
    assert shared_device().info.renderer in text
    assert "wall clock around glFinish" in text or "GL_TIME_ELAPSED" in text
    assert "- merged: The airlight model weng2010 takes the phase function isotropic" in text
    rows = {row["contender"]: row for row in csv.DictReader((out / "results.csv").open())}
    assert list(rows) == [one.name for one in FEW]
    assert rows["merged"]["refusal"]
    assert rows["merged"]["milliseconds_50"] == ""
    for name in ("march", "fast quadrature"):
        row = rows[name]
        assert 0 < float(row["milliseconds_25"]) <= float(row["milliseconds_50"]) <= float(row["milliseconds_75"])
        assert float(row["over_march_low"]) <= float(row["over_march"]) <= float(row["over_march_high"])
        assert int(row["frame_bytes"]) > 0
        assert float(row["error_rel_95"]) < 1
    assert rows["march"]["over_march"] == "1.0"
    # every fourth pixel in x and y
    assert (int(rows["march"]["rays"]), int(rows["fast quadrature"]["rays"])) == (24 * 16, 6 * 4)
    assert float(rows["march"]["storage_bytes"]) == 0 < float(rows["fast quadrature"]["storage_bytes"])
    assert (out / "passes.png").read_bytes().startswith(b"\x89PNG")
    # what is not there is not talked of
    assert "## Pass by pass" in text
    assert "Table 5.1" in text
    assert "in pairs" not in text
    assert not (out / "pairs.csv").exists()
    assert "So far" not in text
    assert "decimated" not in text


def test_what_is_measured_is_kept_when_the_rest_is_stopped(airlight, monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setattr(report, "NO_SHADER_CACHE", {})
    first = made_up({"march": np.ones(6), "two Ei": np.ones(6), "merged": np.ones(6)})

    def measure_one(scene: Scene, *_: object) -> Result:
        if scene.phase.name == "rayleigh":
            raise KeyboardInterrupt
        return replace(first, scene=scene)

    monkeypatch.setattr(report, "estimate_reference", lambda *_: first.reference)
    monkeypatch.setattr(report, "measure_scene", measure_one)
    path = tmp_path / "mine.xml"
    shutil.copy(FOLDER / "sphere.xml", path)
    shutil.copytree(FOLDER / "phase", tmp_path / "phase")
    words = ("benchmark", "techniques", "mine.xml", "--size", 4, 4, "--triangles", 300_000, "--out", "page")
    # Ctrl-C's code
    assert airlight(*words).code == 130
    text = (tmp_path / "page" / "README.md").read_text()
    assert "So far 1 of 2 cases are measured." in text
    # the command names the file whatever folder it is run in, and all that was asked for
    assert f"airlight benchmark techniques {path} --size 4 4 --phase isotropic --phase rayleigh" in text
    assert "decimated to 300,000 triangles" in text
    assert "- two Ei / merged: " in text
    assert "- four Ei / three Ei" not in text
    assert "Of 2 intervals of 95%" in text
    assert "MB, meshes made ready in 7 ms." in text
    # no fast row was drawn
    assert "Table 5.1" not in text
    assert "## Pass by pass" not in text


def test_the_phase_function_is_given_once(airlight) -> None:
    result = airlight("benchmark", "techniques", "sphere", "-p", "phase=hg")
    assert result.code == 2
    assert result.err.strip() == "airlight: -p phase=hg: give it as --phase hg."


def test_an_unknown_contender_is_refused(airlight) -> None:
    result = airlight("benchmark", "techniques", "sphere", "--contender", "slow")
    assert result.code == 2
    assert "There is no contender 'slow'; use one of march, fast" in result.err


def test_what_is_as_dense_needs_what_it_is_as_dense_as() -> None:
    assert [one.name for one in chosen([AS_DENSE])] == [BASELINE.name, BOUNDED, AS_DENSE]
    assert chosen(None) == chosen([]) == CONTENDERS


def test_another_page_is_not_overwritten(airlight, monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setattr(report, "estimate_reference", None)
    (tmp_path / "README.md").write_text("# Mine\n")
    result = airlight("benchmark", "techniques", "sphere", "--out", tmp_path)
    assert result.code == 2
    assert "choose another --out" in result.err
    assert (tmp_path / "README.md").read_text() == "# Mine\n"
