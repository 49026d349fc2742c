"""A small suite from end to end: tables, pictures, and the cache of references."""

from __future__ import annotations

import os
import signal
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
import polars
import pytest

from experiments import runner
from experiments.exr import read_exr
from experiments.pictures import LAYERS
from experiments.runner import Row, Watcher, run_suite
from experiments.suite import Suite
from experiments.terminal import results_table
from reference import cache, estimate
from scenes.model import Scene

SUITE = Suite.model_validate(
    {
        "scenes": ["empty"],
        "size": [16, 12],
        "parameters": {"sigma_t": 0.2},
        "techniques": [{"name": "Weng2010"}, {"name": "Nishita1987", "steps": 5}, {"name": "Nishita1987"}],
        "reference": {"rel_error": 0.05},
    }
)
CASES = ["empty-Nishita1987", "empty-Nishita1987-steps-5", "empty-Weng2010"]


class Notes(Watcher):
    """Keeps what it is told."""

    def __init__(self) -> None:
        self.cases: list[tuple[str, int, int]] = []
        self.scenes: list[str] = []

    def case(self, name: str, number: int, total: int) -> None:
        self.cases.append((name, number, total))

    def scene(self, scene: Scene) -> None:
        self.scenes.append(scene.name)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[Row], Path, Notes]:
    """One run with a cache of its own; later tests look at what it left."""
    folder = tmp_path_factory.mktemp("first")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        notes = Notes()
        # in place of what warms the sheets' process up: its signal mask, seen by a child of its own
        look = f"grep SigBlk /proc/$PPID/status > {folder / 'mask'}"
        patch.setattr(runner, "prepare_sheets", partial(os.system, look))
        rows, results = run_suite("tiny", SUITE, folder / "runs", notes)
    return rows, results, notes


def test_the_tables_hold_a_row_per_case_and_layer(run: tuple[list[Row], Path, Notes]) -> None:
    rows, folder, _ = run
    table = polars.read_parquet(folder / "results.parquet")
    keys = table.select("scene", "technique", "steps", "layer").rows()
    steps = {"Weng2010": ["128"], "Nishita1987": ["5", "64"]}
    expected = [("empty", name, n, layer) for name, numbers in steps.items() for n in numbers for layer in LAYERS]
    assert sorted(keys) == sorted(expected)
    assert len(rows) == len(expected)
    text = polars.read_csv(folder / "results.csv", schema_overrides=table.schema)
    # an empty text is nothing in a CSV file
    assert text.fill_null("").equals(table.with_columns(polars.col(polars.String).fill_null("")).fill_null(""))
    assert set(table["parameters"]) == {'{"sigma_t": "0.2"}'}
    assert set(table["size"]) == {"16 12"}


def test_numbers_are_those_of_the_pictures(run: tuple[list[Row], Path, Notes]) -> None:
    rows, folder, _ = run
    for case in CASES:
        layers, metadata = read_exr(folder / f"{case}.exr")
        for layer in LAYERS:
            test, truth = layers[layer].astype(float), layers[f"reference.{layer}"].astype(float)
            (row,) = (
                row
                for row in rows
                if (row["technique"], row["steps"], row["layer"]) == (metadata["technique"], metadata["steps"], layer)
            )
            # rows are measured before the reference is rounded to float32
            assert row["rmse"] == pytest.approx(np.sqrt(np.mean((test - truth) ** 2)), rel=1e-4, abs=1e-9)
            assert row["scene_digest"] == metadata["scene_digest"]
        np.testing.assert_allclose(layers["composite"], layers["surface"] + layers["scattering"], rtol=1e-6, atol=1e-12)
        assert layers["depth"].shape == layers["lit_intervals"].shape == (12, 16)


def test_each_case_has_a_picture_and_nothing_half_done_is_left(run: tuple[list[Row], Path, Notes]) -> None:
    _, folder, _ = run
    expected = [f"{case}.{ending}" for case in CASES for ending in ("exr", "png")]
    assert sorted(path.name for path in folder.iterdir()) == sorted([*expected, "results.csv", "results.parquet"])
    for case in CASES:
        assert (folder / f"{case}.png").read_bytes().startswith(b"\x89PNG")


def test_more_steps_are_closer(run: tuple[list[Row], Path, Notes]) -> None:
    rows, _, _ = run
    errors = {row["steps"]: row["rel_50"] for row in rows if row["layer"] == "scattering"}
    assert errors["64"] < errors["5"]
    # the closed form has no error here but float32's and the reference's noise
    assert errors["128"] < 0.01


def test_the_table_tells_two_settings_of_a_technique_apart(run: tuple[list[Row], Path, Notes]) -> None:
    labels = list(results_table(run[0]).columns[1].cells)
    assert labels == ["Weng2010", "Nishita1987, steps 5", "Nishita1987"]


def test_the_watcher_hears_of_every_case(run: tuple[list[Row], Path, Notes]) -> None:
    _, _, notes = run
    assert notes.scenes == ["empty"]
    assert notes.cases[0] == ("empty: reference", 0, 3)
    assert notes.cases[-1] == ("done", 3, 3)
    assert len(notes.cases) == 5


def test_the_sheets_process_never_hears_ctrl_c(run: tuple[list[Row], Path, Notes]) -> None:
    blocked = int((run[1].parents[1] / "mask").read_text().split()[1], 16)
    assert blocked >> (signal.SIGINT - 1) & 1
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def short(folder: Path, patch: pytest.MonkeyPatch) -> tuple[list[Row], Path]:
    # a thread draws as well, and another process takes a second to start
    patch.setattr(runner, "ProcessPoolExecutor", lambda workers, mp_context: ThreadPoolExecutor(workers))
    suite = SUITE.model_copy(update={"techniques": SUITE.techniques[:1]})
    return run_suite("tiny", suite, folder, Watcher())


def numbers(rows: list[Row]) -> list[Row]:
    return [{key: value for key, value in row.items() if key != "date"} for row in rows]


def test_a_second_run_takes_the_reference_from_the_cache(
    run: tuple[list[Row], Path, Notes], monkeypatch: pytest.MonkeyPatch
) -> None:
    rows, folder, _ = run
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder.parents[1] / "cache"))

    def refused(*_: object) -> None:
        raise AssertionError("the reference was estimated again")

    monkeypatch.setattr(estimate, "converge", refused)
    again, other = short(folder.parent, monkeypatch)
    assert other != folder
    assert numbers(again) == numbers([row for row in rows if row["technique"] == "Weng2010"])


def test_a_damaged_entry_is_set_aside_and_made_again(
    run: tuple[list[Row], Path, Notes], monkeypatch: pytest.MonkeyPatch
) -> None:
    rows, folder, _ = run
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder.parents[1] / "cache"))
    (entry,) = cache.folder().glob("*.npz")
    whole = entry.read_bytes()
    entry.write_bytes(whole[: len(whole) // 2])
    again, _ = short(folder.parent, monkeypatch)
    assert numbers(again) == numbers([row for row in rows if row["technique"] == "Weng2010"])
    assert entry.is_file()
    assert [path.suffix for path in cache.folder().iterdir()].count(".npz") == 1
    (aside,) = cache.folder().glob("*.damaged")
    assert aside.read_bytes() == whole[: len(whole) // 2]
