"""What the cache is said to hold, and what of it is pruned."""

from __future__ import annotations

import hashlib
import json
import time
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from cache_entries import ARRAYS, RECIPE, age, names, stored

from reference import cache
from reference.cache import entry_file
from reference.estimators import Equiangular

pytestmark = pytest.mark.usefixtures("own_cache")


@pytest.fixture
def entry() -> Path:
    """An entry's file."""
    return stored(RECIPE)


def old_entry() -> Path:
    """An entry as an earlier airlight stored it."""
    cache.folder().mkdir(parents=True, exist_ok=True)
    recipe = {"scene": "abc", "goal": {"rel_error": 0.1}}
    path = cache.folder() / f"{hashlib.sha256(json.dumps(recipe, sort_keys=True).encode()).hexdigest()}.npz"
    with path.open("wb") as file:
        np.savez(file, record=np.array(json.dumps({"recipe": recipe})), **ARRAYS)
    return path


def test_an_entry_of_an_earlier_airlight_is_not_found_and_is_pruned() -> None:
    path = old_entry()
    told: list[str] = []
    assert cache.load({"scene": "abc", "goal": {"rel_error": 0.1}}, told.append) is None
    assert told == []
    (listed,) = cache.entries()
    assert (listed.stale, listed.damaged) == ("written by an earlier airlight", "")
    assert cache.prune(damaged=True) == []
    assert [removal.path for removal in cache.prune(stale=True)] == [path]


def test_an_entry_is_described_by_its_record(entry: Path) -> None:
    (listed,) = cache.entries()
    assert abs(listed.last_used - time.time()) < 60
    assert listed == cache.Entry(
        path=entry,
        size=entry.stat().st_size,
        last_used=listed.last_used,
        damaged="",
        stale="",
        scene="fog",
        parameters={"g": "0.6"},
        image_size=(4, 3),
        estimator="equiangular",
        estimator_version=Equiangular.version,
        variant="llvm_ad_rgb",
        rel_error=0.09,
        asked=0.1,
        finished=True,
    )


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"estimator_version": Equiangular.version - 1}, f", now {Equiangular.version}"),
        ({"mitsuba": "3.0.0"}, f"mitsuba 3.0.0, now {version('mitsuba')}"),
        ({"drjit": "1.0.0"}, f"drjit 1.0.0, now {version('drjit')}"),
        ({"estimator": "dice"}, "now gone"),
    ],
)
def test_an_entry_of_another_version_is_stale(change: dict, why: str, entry: Path) -> None:
    old = stored(RECIPE | change)
    stale = {listed.path: listed.stale for listed in cache.entries()}
    assert why in stale[old]
    assert stale[entry] == ""
    assert [removal.path for removal in cache.prune(damaged=True)] == []
    assert [removal.path for removal in cache.prune(stale=True, dry_run=True)] == [old]
    assert old.exists()
    assert [removal.path for removal in cache.prune()] == [old]
    assert names() == {entry.name}


def test_the_list_reads_no_array_and_prune_checks_each_byte(entry: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    content = bytearray(entry.read_bytes())
    content[content.index(ARRAYS["mean.scattering"].tobytes()) + 8] ^= 1
    entry.write_bytes(content)
    with monkeypatch.context() as patch:
        patch.setattr(entry_file, "check", lambda file: pytest.fail("read"))
        assert [listed.damaged for listed in cache.entries()] == [""]
    assert [listed.damaged for listed in cache.entries(check_bytes=True)] == ["its bytes are not those of its checksum"]
    assert cache.prune(stale=True) == []
    (removal,) = cache.prune()
    assert removal == cache.Removal(entry, len(content), "fog, damaged: its bytes are not those of its checksum")


def test_what_was_set_aside_is_pruned(entry: Path) -> None:
    entry.write_bytes(b"")
    assert cache.load(RECIPE) is None
    aside = entry.with_suffix(".damaged")
    assert cache.other_files().set_aside == [aside]
    assert cache.prune(stale=True) == []
    assert [removal.path for removal in cache.prune()] == [aside]


def test_loading_is_using(entry: Path) -> None:
    other = stored(RECIPE | {"size": [8, 8]})
    for path in (entry, other):
        age(path, 40)
    assert cache.load(RECIPE) is not None
    assert [listed.path for listed in cache.entries()] == [entry, other]
    assert cache.prune(older_than=41) == []
    (removal,) = cache.prune(older_than=39)
    assert (removal.path, removal.why) == (other, "fog, not used for 40 days")
    assert [removal.path for removal in cache.prune(everything=True)] == [entry]


def test_nothing_but_our_own_files_is_ever_removed(entry: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere.npz"
    elsewhere.write_bytes(b"precious")
    folder = cache.folder()
    foreign = {"notes.txt", "a.npz", "e" * 64 + ".txt", "f" * 64 + ".npz", "0" * 64 + ".npz", entry.stem + ".bak"}
    for name in foreign - {"f" * 64 + ".npz", "0" * 64 + ".npz"}:
        (folder / name).write_bytes(b"precious")
    # a link and a folder by the name of an entry
    (folder / ("f" * 64 + ".npz")).symlink_to(elsewhere)
    (folder / ("0" * 64 + ".npz")).mkdir()
    assert {path.name for path in cache.other_files().foreign} == foreign
    cache.prune(everything=True, older_than=0, stale=True, damaged=True)
    assert names() == foreign
    assert elsewhere.read_bytes() == b"precious"
