"""What a run cannot use is said in one sentence, before or instead of work, and nothing is lost."""

from __future__ import annotations

import json
from pathlib import Path

import polars
import pytest
from distributed import LocalCluster

from experiments.gate.references import load_reference
from experiments.measurements import MEASUREMENTS, Measurement, find_measurement
from experiments.run import folder as run_folder
from experiments.run.cluster import QUIET, slots
from experiments.run.folder import digest_of
from experiments.run.scenes_of import look_at_scenes
from experiments.suite import cases_of, load_suite
from scenes.catalogue import FOLDER
from scenes.errors import InputError
from scenes.loader import load

SUITE = 'scenes = "empty"\nsize = [8, 8]\npictures = "none"\nmeasure = "counts"\n[[techniques]]\nname = "Weng2010"\n'


@pytest.fixture
def suite(tmp_path: Path) -> Path:
    path = tmp_path / "one.toml"
    path.write_text(SUITE)
    return path


@pytest.fixture
def finished(airlight, suite: Path, tmp_path: Path) -> Path:
    """The folder of a finished run."""
    assert airlight("run", suite, "--out", tmp_path / "runs").code == 0
    (found,) = (tmp_path / "runs").iterdir()
    return found


def refused(result) -> str:
    assert result.code == 2
    # below the progress bar, where the work had begun
    *bars, last = result.err.strip().splitlines()
    assert all("%" in bar for bar in bars)
    return last


def test_a_run_of_another_kind_is_not_gone_on_with(airlight, suite: Path, finished: Path) -> None:
    record = json.loads((finished / "run.json").read_text())
    said = refused(airlight("run", suite, "--set", "size=[4, 4]", "--resume", finished))
    assert "is a run of other cases than one has now" in said
    for key, value, words in (
        ("format", 99, "was made by airlight 0.1.0, whose results this version (0.1.0) does not read"),
        ("code", "0" * 64, f"it was begun at commit {record['commit']}, and airlight's sources have changed since"),
        ("mitsuba", "3.0.0", "it was begun with another mitsuba"),
    ):
        (finished / "run.json").write_text(json.dumps(record | {key: value}))
        assert words in refused(airlight("run", suite, "--resume", finished))
    (finished / "run.json").write_text(json.dumps(record)[:40])
    assert "is not the folder of a run" in refused(airlight("run", suite, "--resume", finished))
    assert "leave one out" in refused(airlight("run", suite, "--resume", finished, "--fresh"))
    assert "is not the folder of a run" in refused(airlight("page", finished.parent, "--out", finished.parent / "page"))


def test_results_of_another_version_make_no_page(airlight, finished: Path, tmp_path: Path) -> None:
    record = json.loads((finished / "run.json").read_text())
    (finished / "run.json").write_text(json.dumps(record | {"format": 99, "airlight": "7.0"}))
    said = refused(airlight("page", finished, "--out", tmp_path / "page"))
    assert "was made by airlight 7.0, whose results this version" in said
    assert not (tmp_path / "page").exists()
    (finished / "run.json").write_text(json.dumps(record))
    (finished / "results.parquet").write_bytes(b"half")
    assert "results.parquet is missing or damaged" in refused(airlight("page", finished, "--out", tmp_path / "page"))


def test_a_stopped_run_of_another_program_is_left_and_said(airlight, suite: Path, finished: Path) -> None:
    record = json.loads((finished / "run.json").read_text())
    del record["finished"]
    (finished / "run.json").write_text(json.dumps(record | {"code": "0" * 64}))
    result = airlight("run", suite, "--out", finished.parent)
    assert result.code == 0
    assert f"{finished} was stopped, and is left as it is: it was begun at commit" in " ".join(result.err.split())
    assert len(list(finished.parent.iterdir())) == 2


def test_a_run_that_goes_on_is_nobody_elses(airlight, suite: Path, finished: Path) -> None:
    lock = run_folder._locked(finished)
    assert "is being run by another process" in refused(airlight("run", suite, "--resume", finished))
    assert lock is not None
    lock.close()


def test_a_full_disk_ends_the_run_with_one_sentence(airlight, suite: Path, tmp_path: Path, monkeypatch) -> None:
    # the folder of the rows is in the way of itself: no row can be written, whoever tries
    made = run_folder._new_folder

    def without_room(*words):
        found = made(*words)
        (found.path / "cases").rmdir()
        (found.path / "cases").write_text("")
        return found

    monkeypatch.setattr(run_folder, "_new_folder", without_room)
    said = refused(airlight("run", suite, "--out", tmp_path / "runs"))
    assert "empty-Weng2010.json cannot be written" in said
    assert "what is finished is kept" in said


def test_a_table_that_does_not_fit_is_said_in_the_same_way(finished: Path, monkeypatch) -> None:
    def full(self, path) -> None:
        raise polars.exceptions.ComputeError("parquet: no space left")

    monkeypatch.setattr(polars.DataFrame, "write_parquet", full)
    folder = run_folder.RunFolder(finished, {})
    with pytest.raises(InputError, match=r"results\.parquet cannot be written .parquet: no space left"):
        folder.write_tables(list(folder.rows().values()))


def test_a_scene_that_has_changed_makes_another_run(airlight, tmp_path: Path) -> None:
    scene = tmp_path / "mine.xml"
    scene.write_text((FOLDER / "empty.xml").read_text())
    (tmp_path / "phase").symlink_to(FOLDER / "phase")
    suite = tmp_path / "own.toml"
    suite.write_text(SUITE.replace('"empty"', '"mine.xml"'))
    seen = []
    for text in (scene.read_text(), scene.read_text().replace('value="0.12"', 'value="0.9"').replace('0.1"', '0.2"')):
        scene.write_text(text)
        cases = cases_of(load_suite(str(suite))[1])
        seen.append(digest_of(load_suite(str(suite))[1], cases, look_at_scenes(cases).digests))
    assert seen[0] != seen[1]


@pytest.mark.parametrize(
    ("worker", "words"),
    [
        ({"nthreads": 4, "nanny": "tcp://x", "resources": {}}, "has several threads; start it with dask worker"),
        ({"nthreads": 1, "nanny": None, "resources": {}}, "has no nanny that could end it where it hangs"),
    ],
)
def test_a_worker_that_cannot_serve_is_refused(worker: dict, words: str) -> None:
    class Cluster:
        def scheduler_info(self, n_workers: int) -> dict:
            return {"workers": {"tcp://here": worker}}

    with pytest.raises(InputError) as caught:
        slots(Cluster(), quiet=False)
    assert words in str(caught.value)


def test_nobody_answers_at_the_schedulers_address(airlight, suite: Path) -> None:
    # a port that nothing listens at
    assert "No scheduler of dask answers at tcp://127.0.0.1:9" in refused(
        airlight("run", suite, "--scheduler", "tcp://127.0.0.1:9")
    )
    assert "No scheduler of dask answers at here" in refused(airlight("run", suite, "--scheduler", "here"))


def test_a_cluster_that_is_there_runs_the_cases_and_timings_wait_for_a_quiet_worker(
    airlight, suite: Path, tmp_path: Path, monkeypatch
) -> None:
    with LocalCluster(
        n_workers=1, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0", processes=True
    ) as own:
        address = own.scheduler_address
        assert airlight("run", suite, "--scheduler", address, "--out", tmp_path / "runs").code == 0
        (run,) = (tmp_path / "runs").iterdir()
        assert json.loads((run / "cases" / "empty-Weng2010.json").read_text())["status"] == "done"
        said = refused(
            airlight("run", suite, "--set", "measure=timing", "--scheduler", address, "--out", tmp_path / "t")
        )
        assert f"--resources {QUIET}=1" in said


def test_timing_is_quiet_and_nothing_else_is() -> None:
    found = {name: find_measurement(name) for name in MEASUREMENTS}
    assert all(isinstance(one, Measurement) for one in found.values())
    assert [name for name, one in found.items() if one.needs_quiet] == ["timing"]


def test_a_case_that_there_is_none_of_is_named(airlight, suite: Path) -> None:
    assert "has no case 'x'; its first of 1 is empty-Weng2010" in refused(airlight("run", suite, "--case", "x"))


def test_a_scene_that_cannot_be_used_is_said_before_a_folder_is_made(airlight, suite: Path, tmp_path: Path) -> None:
    for change in ("scenes=nowhere", 'parameters={phase = "square"}', "parameters={sigma_t = -1.0}"):
        refused(airlight("run", suite, "--set", change, "--out", tmp_path / "runs"))
    assert not (tmp_path / "runs").exists()


def test_a_missing_reference_is_a_failure(airlight, suite: Path, tmp_path: Path) -> None:
    nowhere = tmp_path / "references"
    nowhere.mkdir()
    result = airlight(
        "run", suite, "--set", "measure=errors", "--set", f"reference.folder={nowhere}", "--out", tmp_path / "runs"
    )
    assert result.code == 1
    assert "Failed: empty-Weng2010" in result.err
    with pytest.raises(InputError):
        load_reference(nowhere, load("empty", (8, 8)))
