"""A small suite from end to end: rows, tables, pictures, going on, and the cache of references."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import polars
import pytest

from experiments import cli
from experiments.exr import read_exr
from experiments.terminal import results_table
from reference import cache
from reference.estimate import LAYERS

SUITE = """
scenes = ["empty"]
size = [16, 12]
parameters = { sigma_t = 0.2 }
reference = { rel_error = 0.05 }

[[techniques]]
name = "Weng2010"

[[techniques]]
name = "Nishita1987"
steps = [5, 64]
"""
CASES = ["empty-Nishita1987", "empty-Nishita1987-steps-5", "empty-Weng2010"]
TIMINGS = ("seconds", "process", "date")


def command(*words: object) -> int:
    """Run the command line in this process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["airlight", *map(str, words)])
        try:
            cli.main()
        except SystemExit as end:
            return int(end.code or 0)
    return 0


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One run with a cache of its own; later tests look at what it left."""
    home = tmp_path_factory.mktemp("first")
    (home / "tiny.toml").write_text(SUITE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(home / "cache"))
        assert command("run", home / "tiny.toml", "--out", home / "runs") == 0
    (found,) = (home / "runs").iterdir()
    return found


def test_the_tables_hold_a_row_per_case(folder: Path) -> None:
    table = polars.read_parquet(folder / "results.parquet")
    keys = table.select("case", "scene", "technique", "steps", "status").rows()
    steps = [("empty-Weng2010", "Weng2010", 128), (CASES[1], "Nishita1987", 5), (CASES[0], "Nishita1987", 64)]
    assert keys == [(case, "empty", technique, n, "done") for case, technique, n in steps]
    text = polars.read_csv(folder / "results.csv", schema_overrides=table.schema)
    # an empty text is nothing in a CSV file
    assert text.fill_null("").equals(table.with_columns(polars.col(polars.String).fill_null("")).fill_null(""))
    assert set(table["parameters"]) == {'{"sigma_t": "0.2"}'}
    assert table.select("width", "height").unique().rows() == [(16, 12)]


def test_a_row_says_everything_that_made_it(folder: Path) -> None:
    row = json.loads((folder / "cases" / "empty-Weng2010.json").read_text())
    made = ("commit", "airlight", "mitsuba", "drjit", "numpy", "machine", "gl_renderer", "seeds", "scene_version")
    assert all(row[key] for key in (*made, "scene_digest", "estimator", "variant", "passes", "rel_error", "date"))
    assert row["command"].endswith("tiny.toml --case empty-Weng2010")
    record = json.loads((folder / "run.json").read_text())
    assert record["finished"]
    assert record["contents"]["products"][0]["scenes"] == ["empty"]


def test_numbers_are_those_of_the_pictures(folder: Path) -> None:
    for case in CASES:
        row = json.loads((folder / "cases" / f"{case}.json").read_text())
        layers, metadata = read_exr(folder / f"{case}.exr")
        assert row["scene_digest"] == metadata["scene_digest"]
        for layer in LAYERS:
            test, truth = layers[layer].astype(float), layers[f"reference.{layer}"].astype(float)
            # rows are measured before the reference is rounded to float32
            assert row[f"{layer}.rmse"] == pytest.approx(np.sqrt(np.mean((test - truth) ** 2)), rel=1e-4, abs=1e-9)
        np.testing.assert_allclose(layers["composite"], layers["surface"] + layers["scattering"], rtol=1e-6, atol=1e-12)
        assert layers["depth"].shape == layers["lit_intervals"].shape == (12, 16)


def test_each_case_has_a_picture_and_nothing_half_done_is_left(folder: Path) -> None:
    pictures = [f"{case}.{ending}" for case in CASES for ending in ("exr", "png")]
    others = [".lock", "cases", "report.html", "results.csv", "results.parquet", "run.json"]
    assert sorted(path.name for path in folder.iterdir()) == sorted([*pictures, *others])
    for case in CASES:
        assert (folder / f"{case}.png").read_bytes().startswith(b"\x89PNG")


def test_more_steps_are_closer(folder: Path) -> None:
    table = polars.read_parquet(folder / "results.parquet")
    errors = dict(table.select("steps", "scattering.rel_50").rows())
    assert errors[64] < errors[5]
    # the closed form has no error here but float32's and the reference's noise
    assert errors[128] < 0.01


def test_the_table_tells_two_settings_of_a_technique_apart(folder: Path) -> None:
    rows = polars.read_parquet(folder / "results.parquet").to_dicts()
    labels = list(results_table(rows).columns[1].cells)
    assert labels == ["Weng2010", "Nishita1987, steps 5", "Nishita1987"]


def numbers(folder: Path) -> list[dict]:
    rows = [json.loads(path.read_text()) for path in sorted((folder / "cases").glob("*.json"))]
    return [{key: value for key, value in row.items() if key not in (*TIMINGS, "command")} for row in rows]


def test_a_second_run_gives_the_same_numbers_and_a_damaged_one_is_made_again(
    folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    home = folder.parents[1]
    monkeypatch.setenv("XDG_CACHE_HOME", str(home / "cache"))
    (entry,) = cache.folder().glob("*.npz")
    whole = entry.read_bytes()
    assert command("run", home / "tiny.toml", "--out", tmp_path / "second") == 0
    (second,) = (tmp_path / "second").iterdir()
    assert numbers(second) == numbers(folder)
    assert entry.read_bytes() == whole
    entry.write_bytes(whole[: len(whole) // 2])
    assert command("run", home / "tiny.toml", "--out", tmp_path / "third", "--case", "empty-Weng2010") == 0
    (third,) = (tmp_path / "third").iterdir()
    assert numbers(third) == numbers(folder)[2:]
    (aside,) = cache.folder().glob("*.damaged")
    assert aside.read_bytes() == whole[: len(whole) // 2]


def test_a_refused_cell_says_why_and_is_no_failure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "hg.toml").write_text(
        'scenes = "empty"\nsize = [8, 8]\nphases = { name = "hg", g = 0.6 }\npictures = "none"\nmeasure = "counts"\n'
        '[[techniques]]\nname = "Weng2010"\n[[techniques]]\nname = "lit_intervals+quadrature"\n'
    )
    assert command("run", tmp_path / "hg.toml", "--out", tmp_path) == 0
    capsys.readouterr()
    (run,) = tmp_path.glob("hg-*")
    refused, done = polars.read_parquet(run / "results.parquet").sort("status", descending=True).to_dicts()
    assert (refused["status"], done["status"]) == ("refused", "done")
    assert refused["reason"].startswith("The airlight model one_ei takes the phase function isotropic or rayleigh")
    assert refused["phase"] == "hg 0.6"
    assert "finished" in json.loads((run / "run.json").read_text())
    # nothing needed a reference: none was estimated
    assert "estimator" not in done
