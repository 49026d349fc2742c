"""`airlight cache`: the list says what is kept, and prune removes what it says and no more."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import cache_entries
import numpy as np
import pytest

from experiments.cache_cli import cache_app
from reference import cache
from reference.estimators import Equiangular
from scenes.errors import InputError

Run = Callable[..., str]
RECIPE = cache_entries.RECIPE | {"size": [640, 480]}
RECORD = {
    "scene_name": "a [bold] fog",
    "parameters": {"g": "0.6"},
    "goal": {"rel_error": 0.01, "percentile": 95.0},
    "rel_error": 0.0123,
}


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Run:
    """Run `airlight cache ...` in this process, with an empty cache; what it printed."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))

    def cache_command(*words: str) -> str:
        cache_app(list(words), standalone_mode=False)
        return capsys.readouterr().out

    return cache_command


def stored(finished: bool = True, **change: object) -> Path:
    recipe = RECIPE | change
    cache.store(recipe, {"mean.scattering": np.ones((3, 4, 3))}, RECORD | {"finished": finished})
    return cache.folder() / f"{cache.key(recipe)}.npz"


def full() -> dict[str, Path]:
    """One file of each kind, by its name here."""
    files = {"usable": stored(), "unfinished": stored(finished=False, size=[8, 8]), "stale": stored(mitsuba="3.0.0")}
    files |= {"damaged": stored(size=[9, 9]), "altered": stored(size=[10, 10])}
    files["damaged"].write_bytes(files["damaged"].read_bytes()[:100])
    content = bytearray(files["altered"].read_bytes())
    content[content.index(np.ones(8).tobytes())] ^= 1
    files["altered"].write_bytes(content)
    files["aside"] = cache.folder() / f"{'a' * 64}.damaged"
    files["leftover"] = cache.folder() / f".{'b' * 40}-{'c' * 8}.part.npz"
    files["foreign"] = cache.folder() / "thesis.pdf"
    for name in ("aside", "leftover", "foreign"):
        files[name].write_bytes(b"12345")
    then = time.time() - 2 * 86400
    os.utime(files["leftover"], (then, then))
    return files


def left(files: dict[str, Path]) -> set[str]:
    return {name for name, path in files.items() if path.exists()}


def test_an_empty_cache_is_said_to_be_empty(run: Run) -> None:
    assert run("list") == f"0 references, 0 bytes, in {cache.folder()}\n"
    assert run("prune") == f"0 files, 0 bytes, removed from {cache.folder()}\n"
    assert json.loads(run("list", "--json"))["entries"] == []
    # looking makes no folder
    assert not cache.folder().exists()


def test_the_table_says_what_each_reference_is(run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    files = full()
    cache_app(["list"], standalone_mode=False)
    out, notices = capsys.readouterr()
    text = " ".join(out.split())
    for said in (
        "a [bold] fog, g=0.6",
        f"equiangular {Equiangular.version},",
        "llvm_ad_rgb",
        "640 x 480",
        "1.23%",
        " 1% ",
        "usable",
        "unfinished",
        "stale: mitsuba 3.0.0,",
        "damaged: it is not",
        "5 references, ",
        str(cache.folder()),
        "1 damaged entry set aside, 1 file being written or left half written",
    ):
        assert said in text
    assert "left alone: thesis.pdf" in notices
    total = sum(path.stat().st_size for name, path in files.items() if name not in ("aside", "leftover", "foreign"))
    assert f"{total / 1000:.3g} kB" in text


def test_json_has_all_of_it_and_nothing_else_on_standard_output(run: Run) -> None:
    files = full()
    told = json.loads(run("list", "--json"))
    assert told["folder"] == str(cache.folder())
    assert told["bytes"] == sum(entry["size"] for entry in told["entries"])
    assert (told["set_aside"], told["foreign"]) == ([str(files["aside"])], [str(files["foreign"])])
    rows = {row["path"]: row for row in told["entries"]}
    usable, unfinished = rows[str(files["usable"])], rows[str(files["unfinished"])]
    assert (usable["finished"], unfinished["finished"]) == (True, False)
    assert (usable["image_size"], usable["asked"], usable["rel_error"]) == ([640, 480], 0.01, 0.0123)
    assert (usable["stale"], usable["damaged"]) == ("", "")
    assert rows[str(files["stale"])]["stale"].startswith("mitsuba 3.0.0")


@pytest.mark.parametrize(
    ("words", "removed"),
    [
        ((), {"stale", "damaged", "altered", "aside", "leftover"}),
        (("--stale",), {"stale"}),
        (("--damaged",), {"damaged", "altered", "aside", "leftover"}),
        (("--older-than", "1"), {"unfinished"}),
        (("--older-than", "1", "--stale"), {"unfinished", "stale"}),
        (("--all",), {"usable", "unfinished", "stale", "damaged", "altered", "aside", "leftover"}),
    ],
)
def test_prune_removes_what_it_names_and_dry_run_only_names_it(
    words: tuple[str, ...], removed: set[str], run: Run
) -> None:
    files = full()
    then = time.time() - 1.5 * 86400
    os.utime(files["unfinished"], (then, then))
    size = sum(files[name].stat().st_size for name in removed)
    told = run("prune", *words, "--dry-run")
    assert left(files) == set(files)
    assert run("prune", *words) == told.replace("would be removed", "removed")
    assert left(files) == set(files) - removed
    lines = told.splitlines()
    assert {line.partition(": ")[0] for line in lines[:-1]} == {files[name].name for name in removed}
    freed = f"{size} bytes" if size < 1000 else f"{size / 1000:.3g} kB"
    assert lines[-1].startswith(f"{len(removed)} file{'s' * (len(removed) > 1)}, {freed}, would be removed from ")


def test_a_negative_age_is_refused(run: Run) -> None:
    with pytest.raises(InputError, match="--older-than -1"):
        run("prune", "--older-than", "-1")


def test_the_command_loads_nothing_heavy_until_it_runs() -> None:
    code = "import sys, experiments.cache_cli; print([m for m in ('numpy', 'rich', 'mitsuba') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_it_is_a_command_of_airlight(airlight) -> None:
    answer = airlight("cache", "list", "--json")
    assert answer.code == 0
    assert json.loads(answer.out)["folder"] == str(cache.folder())
    assert airlight("cache", "prune", "--older-than", "nan").code == 2
