"""`airlight benchmark techniques`: its statistics, its rounds, its pairs, its budget of triangles and its page."""

from __future__ import annotations

import csv
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scene_files import sphere, write_scene

from experiments.metrics import measure
from experiments.technique_benchmark import budget, measurement, report, summary, tables
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
from experiments.technique_benchmark.intervals import FEWEST_ROUNDS, median_interval
from experiments.technique_benchmark.measurement import Measured, Result, time_in_rounds
from experiments.technique_benchmark.spacing import steps_as_dense
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.device import shared_device
from gpu_impl.memory import Footprint
from gpu_impl.passes.scattering import COUNTERS
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from gpu_impl.visibilities import VISIBILITIES
from reference.estimate import estimate_reference
from reference.goal import Goal
from scenes.errors import InputError
from scenes.loader import load

RNG = np.random.default_rng(6)
# one of each kind, so that the whole takes seconds
FEW = tuple(one for one in CONTENDERS if one.name in ("march", "fast, quadrature", "merged"))


def test_the_interval_holds_the_median_as_often_as_it_says() -> None:
    # log-normal: nothing about it is symmetric, and its median is 1
    for n in (6, 15, 40):
        found = [median_interval(np.exp(RNG.normal(size=n))) for _ in range(1000)]
        held = np.mean([low <= 1 <= high for low, high in found])
        # 95 % at least, and no more than counts in whole samples make it (97 % for 6 of them)
        # and three standard errors of a thousand of them
        assert 0.93 < held < 0.99, n
    assert median_interval(np.arange(6.0)) == (0.0, 5.0)
    # of 15 the fourth from either end: fewer than four on one side happen 1.8 % of the time each
    assert median_interval(RNG.permutation(np.arange(15.0))) == (3.0, 11.0)


def test_too_few_rounds_are_refused(airlight) -> None:
    with pytest.raises(ValueError, match="values must be 6 or more"):
        median_interval(np.ones(FEWEST_ROUNDS - 1))
    assert airlight("benchmark", "techniques", "sphere", "--frames", FEWEST_ROUNDS - 1).code == 2


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


def test_published_rates_are_those_of_table_5_1() -> None:
    assert published_rate("yeahright", "isotropic") == 17
    assert published_rate("yeahright", "rayleigh") == published_rate("yeahright", "hg") == 6
    assert published_rate("wire_mesh", "isotropic") is None


def test_rounds_run_each_once_in_an_order_of_their_own(monkeypatch) -> None:
    order: list[tuple[str, int, bool]] = []

    class Silent:
        def __init__(self, *_: object) -> None: ...
        def __enter__(self) -> Silent:
            return self

        def __exit__(self, *_: object) -> None: ...
        def frame_time(self, technique: object, number: int, clock: object = None) -> float:
            order.append((str(technique), number, clock is not None))
            return 100.0 * number + len(str(technique))

    class Clock:
        def __init__(self, *_: object) -> None: ...
        def milliseconds(self) -> dict[str, float]:
            return {"surface": 2.0}

    monkeypatch.setattr(measurement, "Renderer", Silent)
    monkeypatch.setattr(measurement, "PassClock", Clock)
    names = {name: name for name in ("a", "bb", "ccc", "dddd")}
    found = time_in_rounds(None, None, names, 8, lambda _: None)
    rounds = [order[8 * n : 8 * n + 8] for n in range(9)]
    for number, one in enumerate(rounds):
        assert {frame for _, frame, _ in one} == {number}
        # without a clock, then with one
        assert [name for name, _, clocked in one if clocked] == [name for name, _, clocked in one if not clocked]
        assert sorted(name for name, _, clocked in one if clocked) == sorted(names)
    assert len({tuple(name for name, _, _ in one) for one in rounds}) > 5
    # the first round is not among them
    np.testing.assert_array_equal(found["bb"]["milliseconds"], 100.0 * np.arange(1, 9) + 2)
    np.testing.assert_array_equal(found["bb"]["passes"]["surface"], np.full(8, 2.0))


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
            footprint=Footprint(10, 2_000_000, 30, 4.0, 5.0),
            counts=dict.fromkeys(COUNTERS, 1.5),
            rays=16,
            milliseconds=times[one.name],
            clocked=1.1 * times[one.name],
            passes={"scattering": 0.5 * times[one.name]},
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


def test_the_fast_row_is_the_fastest_within_the_limits() -> None:
    rounds = np.ones(6)
    times = {"march": 9 * rounds, "fast": 2 * rounds, "fast, quadrature": 3 * rounds, "quadrature": rounds}
    one = summary.fastest(made_up(times))
    assert one is not None
    assert one.contender.name == "fast"
    for errors in ((0.051, 0.02), (0.01, 0.21)):
        result = made_up(times, {"fast": errors})
        assert summary.fastest(result) is result.contenders["fast, quadrature"]
        assert "yes" in tables.rates_table([result])
    # where none is, the page says so
    result = made_up(times, {"fast": (0.1, 0.1), "fast, quadrature": (0.1, 0.1)})
    assert summary.fastest(result) is result.contenders["fast"]
    assert "| no |" in tables.rates_table([result])


def test_as_dense_is_the_length_of_rays_over_their_regions(tmp_path: Path) -> None:
    bounded = find_technique("lit_intervals+quadrature", steps=16, shadow_map=256)
    before = set(AIRLIGHT_MODELS), set(VISIBILITIES)
    with Renderer(write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), size=(24, 24))) as renderer:
        dense = steps_as_dense(renderer, bounded)
        assert steps_as_dense(renderer, replace(bounded, steps=32)) == pytest.approx(2 * dense, abs=1)
    # rays of some 25 units, of which a ball's shadow takes two or three
    assert 5 * 16 < dense < 30 * 16
    with Renderer(load("empty", size=(8, 8))) as renderer:
        assert steps_as_dense(renderer, bounded) == 16
    assert (set(AIRLIGHT_MODELS), set(VISIBILITIES)) == before


def test_a_budget_decimates_files_for_both_renderers(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    whole = load("wire_mesh", size=(8, 8), phase="rayleigh")
    count = budget.triangle_count(whole)
    meshes = os.environ.get("AIRLIGHT_MESH_DIR")
    coarse = budget.load_within("wire_mesh", 20_000, size=(8, 8), phase="rayleigh")
    assert count > 100_000
    assert 0.9 * 20_000 < budget.triangle_count(coarse) <= 20_000
    assert coarse.digest != whole.digest
    assert coarse.phase.name == "rayleigh"
    assert os.environ.get("AIRLIGHT_MESH_DIR") == meshes
    # the shape is the same
    for before, after in zip(whole.meshes, coarse.meshes, strict=True):
        np.testing.assert_allclose(after.vertices.min(axis=0), before.vertices.min(axis=0), atol=0.05)
        np.testing.assert_allclose(after.vertices.max(axis=0), before.vertices.max(axis=0), atol=0.05)
    # within the budget nothing happens
    assert budget.load_within("wire_mesh", count, size=(8, 8), phase="rayleigh").digest == whole.digest
    with pytest.raises(InputError, match="in no mesh file"):
        budget.load_within("sphere", 100, size=(8, 8))


def test_a_scene_is_measured_and_written(airlight, monkeypatch, tmp_path: Path) -> None:
    # whatever runs after this in the process
    monkeypatch.setattr(report, "NO_SHADER_CACHE", {})
    out = tmp_path / "page"
    chosen = ("--contender", "fast, quadrature", "--contender", "merged")
    words = ("half_plane", "--size", 24, 16, "--phase", "rayleigh", "--frames", 6, "--rel-error", 0.05, "--out", out)
    result = airlight("benchmark", "techniques", *chosen, *words)
    assert result.code == 0, result.err
    text = (out / "README.md").read_text()
    assert text.startswith("# What the techniques cost\n")
    command = (
        "benchmark techniques half_plane --size 24 16 --phase rayleigh --contender 'fast, quadrature' "
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
    for name in ("march", "fast, quadrature"):
        row = rows[name]
        assert 0 < float(row["milliseconds_25"]) <= float(row["milliseconds_50"]) <= float(row["milliseconds_75"])
        assert float(row["over_march_low"]) <= float(row["over_march"]) <= float(row["over_march_high"])
        assert int(row["frame_bytes"]) > 0
        assert float(row["error_rel_95"]) < 1
    assert rows["march"]["over_march"] == "1.0"
    # every fourth pixel in x and y
    assert (int(rows["march"]["rays"]), int(rows["fast, quadrature"]["rays"])) == (24 * 16, 6 * 4)
    assert float(rows["march"]["storage_bytes"]) == 0 < float(rows["fast, quadrature"]["storage_bytes"])
    assert (out / "passes.png").read_bytes().startswith(b"\x89PNG")


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
