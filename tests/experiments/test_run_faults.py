"""What goes wrong costs one case and no more; what was finished is kept, and a run goes on from it."""

from __future__ import annotations

import json
import os
import random
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import polars
import pytest

SUPPORT = Path(__file__).parent.parent / "support"
SUITE = """
scenes = ["empty", "half_plane"]
size = [8, 8]
pictures = "none"
measure = "counts"

[[techniques]]
name = "Weng2010"

[[techniques]]
name = "Nishita1987"

[[techniques]]
name = "lit_intervals+quadrature"
"""
# what differs from run to run of the same cases
TIMINGS = ("seconds", "process", "date")


@pytest.fixture
def start(tmp_path: Path):
    """Start the command in a process of its own, in which measurements that go wrong are registered."""
    (tmp_path / "small.toml").write_text(SUITE)
    # dask starts its worker by importing the main program again
    (tmp_path / "airlight.py_").write_text(
        "if __name__ == '__main__':\n    import faulty_measurements\n    from experiments.cli import main\n    main()\n"
    )
    environment = os.environ | {
        "PYTHONPATH": str(SUPPORT),
        "DASK_DISTRIBUTED__WORKER__PRELOAD": '["faulty_measurements"]',
        "XDG_CACHE_HOME": str(tmp_path / "cache"),
    }

    def run(*words: str) -> subprocess.Popen:
        return subprocess.Popen(
            [sys.executable, "airlight.py_", *words],
            cwd=tmp_path,
            env=environment,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )

    return run


def told(process: subprocess.Popen) -> tuple[int, str]:
    """Exit code and everything said, on one line."""
    out, err = process.communicate(timeout=300)
    return process.returncode, " ".join((out + err).split())


def rows(folder: Path) -> dict[str, dict]:
    return {row["case"]: row for path in (folder / "cases").glob("*.json") for row in [json.loads(path.read_text())]}


@pytest.mark.parametrize(
    ("fault", "limit", "words"),
    [
        ("crash", "60.0", "its process ended without a word"),
        ("hang", "15.0", "it took longer than its time limit of 15 s"),
        ("defect", "60.0", "ZeroDivisionError: a defect"),
    ],
)
def test_a_fault_costs_its_case_and_is_reported_with_the_command_that_runs_it_alone(
    fault: str, limit: str, words: str, start, tmp_path: Path
) -> None:
    # one scene's case is faulty, so that what follows it must be measured too
    settings = ("--set", f"measure={fault}", "--set", f"time_limit={limit}", "--set", "scenes=empty")
    code, said = told(start("run", "small.toml", *settings, "--out", "runs"))
    assert code == 1
    (run,) = (tmp_path / "runs").iterdir()
    found = rows(run)
    states = [
        found[case]["status"] for case in ("empty-Weng2010", "empty-Nishita1987", "empty-lit_intervals+quadrature")
    ]
    assert states == ["done", "failed", "done"]
    failed = found["empty-Nishita1987"]
    assert failed["reason"].startswith(words)
    assert f"Failed: empty-Nishita1987: {words}" in said
    assert failed["command"] in said
    assert "finished" not in json.loads((run / "run.json").read_text())
    assert len(polars.read_parquet(run / "results.parquet")) == 3
    if fault == "defect":
        assert "ZeroDivisionError" in failed["traceback"]
        # the command is a person's: it runs that case alone, which fails again
        alone = shlex.split(failed["command"])[1:]
        code, said = told(start(*alone, "--out", "alone"))
        assert code == 1
        (run,) = (tmp_path / "alone").iterdir()
        assert list(rows(run)) == ["empty-Nishita1987"]


def test_so_many_failures_are_enough(start, tmp_path: Path) -> None:
    code, said = told(start("run", "small.toml", "--set", "measure=defect", "--max-failures", "1", "--out", "runs"))
    assert code == 1
    (run,) = (tmp_path / "runs").iterdir()
    assert sorted(rows(run)) == ["empty-Nishita1987", "empty-Weng2010"]
    assert "4 of 6 cases were left after 1 failures; the same command goes on with them." in said


def test_killed_at_random_moments_and_resumed_a_run_ends_with_the_table_of_an_undisturbed_one(
    start, tmp_path: Path
) -> None:
    steps = (
        "--set",
        "settings.steps=[4, 8, 16]",
        "--set",
        'measure=["counts", "errors"]',
        "--set",
        "reference.rel_error=0.05",
    )
    assert told(start("run", "small.toml", *steps, "--out", "whole"))[0] == 0
    (whole,) = (tmp_path / "whole").iterdir()
    assert len(rows(whole)) == 18
    draw = random.Random(6)
    kept = 0
    for _ in range(2):
        process = start("run", "small.toml", *steps, "--out", "runs")
        # until the first new row is there, and then some
        deadline = time.monotonic() + 120
        while time.monotonic() < deadline and process.poll() is None:
            if len(list((tmp_path / "runs").glob("*/cases/*.json"))) > kept:
                break
            time.sleep(0.01)
        time.sleep(draw.uniform(0.0, 0.6))
        process.send_signal(signal.SIGKILL)
        process.communicate()
        kept = len(list((tmp_path / "runs").glob("*/cases/*.json")))
    assert kept > 0
    code, said = told(start("run", "small.toml", *steps, "--out", "runs"))
    assert code == 0
    (run,) = (tmp_path / "runs").iterdir()
    assert kept == 18 or f"{kept} of 18 cases are there" in said
    assert _without_timings(run) == _without_timings(whole)
    assert not list(run.rglob("*.part*"))
    # finished: nothing is left to go on with
    assert told(start("run", "small.toml", *steps, "--out", "runs", "--resume", str(run)))[0] == 0
    assert len(list((tmp_path / "runs").iterdir())) == 1


def _without_timings(run: Path) -> list[dict]:
    table = polars.read_parquet(run / "results.parquet").drop(*TIMINGS)
    return table.to_dicts()
