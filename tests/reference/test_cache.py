"""References kept on disk: what is damaged is never believed, and what cannot be kept is said."""

from __future__ import annotations

import hashlib
import io
import json
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest
from cache_entries import ARRAYS, RECIPE, RECORD, age, names, stored

from reference import cache
from reference.cache import entry_file
from reference.cache.entry_file import DamagedError, OldFormatError
from scenes.errors import InputError

pytestmark = pytest.mark.usefixtures("own_cache")


@pytest.fixture
def entry() -> Path:
    """An entry's file."""
    return stored(RECIPE)


def test_what_is_stored_comes_back(entry: Path) -> None:
    arrays, record = cache.load(RECIPE)
    assert record == RECORD | {"recipe": RECIPE}
    assert arrays.keys() == ARRAYS.keys()
    for name, array in ARRAYS.items():
        assert arrays[name].tobytes() == array.tobytes()
        assert (arrays[name].dtype, arrays[name].shape) == (array.dtype, array.shape)


def test_the_file_is_what_its_description_says(entry: Path) -> None:
    with np.load(entry) as plain:
        assert (plain["mean.scattering"] == ARRAYS["mean.scattering"]).all()
        assert json.loads(str(plain["record"]))["recipe"] == RECIPE
    content = entry.read_bytes()
    assert content[-64:].decode() == hashlib.sha256(content[:-64]).hexdigest()
    assert zipfile.ZipFile(entry).testzip() is None


def test_another_recipe_is_another_entry(entry: Path) -> None:
    assert cache.load(RECIPE | {"size": [4, 4]}) is None
    assert cache.load(dict(reversed(RECIPE.items()))) is not None
    # JSON has no tuples
    assert cache.load(RECIPE | {"size": (4, 3)}) is not None


def test_nothing_stored_is_nothing_found() -> None:
    assert cache.load(RECIPE) is None
    assert cache.entries() == []
    assert cache.other_files() == cache.OtherFiles([], [], [])
    assert cache.prune() == []


def refused(entry: Path) -> None:
    told: list[str] = []
    assert cache.load(RECIPE, told.append) is None
    # set aside to look at, out of the way of its successor, and the person knows
    assert not entry.exists()
    assert entry.with_suffix(".damaged").exists()
    (sentence,) = told
    assert "damaged" in sentence
    assert str(entry.with_suffix(".damaged")) in sentence
    cache.store(RECIPE, ARRAYS, RECORD)
    assert cache.load(RECIPE, told.append) is not None
    assert len(told) == 1


def test_an_entry_that_is_cut_off_anywhere_is_set_aside(entry: Path) -> None:
    content = entry.read_bytes()
    for length in range(len(content)):
        with pytest.raises(DamagedError):
            entry_file.read(io.BytesIO(content[:length]))
    for length in (0, 1, 22, len(content) // 2, len(content) - 64, len(content) - 1):
        entry.write_bytes(content[:length])
        assert cache.entries()[0].damaged == "it is not whole"
        refused(entry)


@pytest.mark.parametrize("added", [b"\0", b"PK\x05\x06" + bytes(18)])
def test_bytes_at_the_end_are_noticed(added: bytes, entry: Path) -> None:
    with entry.open("ab") as file:
        file.write(added)
    refused(entry)


def test_every_altered_byte_is_noticed(entry: Path) -> None:
    content = entry.read_bytes()
    assert entry_file.read(io.BytesIO(content))[1] == RECORD | {"recipe": RECIPE}
    random = np.random.default_rng(4)
    for position in range(len(content)):
        spoilt = bytearray(content)
        spoilt[position] ^= int(random.integers(1, 256))
        with pytest.raises((DamagedError, OldFormatError)):
            entry_file.read(io.BytesIO(spoilt))
        if position % 100 == 0:
            entry.write_bytes(spoilt)
            refused(entry)


def test_a_digit_in_capitals_is_noticed(entry: Path) -> None:
    # a checksum compared as a number would let this byte through
    content = bytearray(entry.read_bytes())
    content[-64:] = content[-64:].upper()
    entry.write_bytes(content)
    refused(entry)


def test_an_entry_of_another_recipe_is_set_aside(entry: Path) -> None:
    other = RECIPE | {"size": [8, 8]}
    entry.write_bytes(stored(other).read_bytes())
    damaged = {listed.path: listed.damaged for listed in cache.entries()}
    assert damaged == {entry: "it is the entry of another recipe", cache.folder() / f"{cache.key(other)}.npz": ""}
    refused(entry)


@pytest.mark.parametrize("content", [b"not a zip", b"\x93NUMPY\x01\x00", b"\x80\x04N."], ids=["text", "npy", "pickle"])
def test_a_file_of_another_kind_is_set_aside(content: bytes, entry: Path) -> None:
    entry.write_bytes(content)
    refused(entry)


@pytest.mark.parametrize(
    "arrays",
    [{"x": np.ones(3)}, {"record": np.array("{")}, {"record": np.array("[]")}, {"record": np.array('{"recipe": 1}')}],
)
def test_a_sealed_file_that_is_no_entry_is_set_aside(arrays: dict, entry: Path) -> None:
    with entry.open("wb") as file:
        np.savez(file, **arrays)
    with zipfile.ZipFile(entry, "a") as archive:
        archive.comment = entry_file._MARK + b"0" * 64
    content = entry.read_bytes()[:-64]
    entry.write_bytes(content + hashlib.sha256(content).hexdigest().encode())
    refused(entry)


DIES = """
import os, signal, sys
import numpy as np
from reference import cache
def dies(file, array, **_):
    file.write(b"half")
    file.flush()
    os.kill(os.getpid(), signal.SIGKILL)
if sys.argv[1] == "in an array":
    np.lib.format.write_array = dies
else:
    os.fsync = lambda number: os.kill(os.getpid(), signal.SIGKILL)
cache.store({"scene": "abc"}, {"mean.scattering": np.ones(3)}, {})
"""


@pytest.mark.parametrize("where", ["in an array", "before it is renamed"])
def test_a_program_that_is_killed_leaves_no_entry_and_prune_takes_the_rest(where: str) -> None:
    assert subprocess.run([sys.executable, "-c", DIES, where]).returncode == -signal.SIGKILL
    assert cache.load({"scene": "abc"}) is None
    assert cache.entries() == []
    (leftover,) = cache.other_files().leftovers
    # whoever writes it may be alive
    assert cache.prune(everything=True) == []
    age(leftover, 1.01)
    assert [removal.path for removal in cache.prune()] == [leftover]
    assert names() == set()


def test_an_interrupted_store_leaves_what_was_there(entry: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def dies(file, *_: object, **__: object) -> None:
        file.write(b"half")
        raise KeyboardInterrupt

    before = entry.read_bytes()
    with monkeypatch.context() as patch:
        patch.setattr(np.lib.format, "write_array", dies)
        with pytest.raises(KeyboardInterrupt):
            cache.store(RECIPE, ARRAYS, RECORD)
    assert entry.read_bytes() == before
    assert names() == {entry.name}


def test_a_full_disk_is_one_sentence_and_leaves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np.lib.format, "write_array", full)
    with pytest.raises(InputError, match=r"cannot be written \(No space left on device\).*XDG_CACHE_HOME"):
        cache.store(RECIPE, ARRAYS, RECORD)
    assert names() == set()


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # a file in its place: root may write anywhere, so permissions would not do
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert cache.load(RECIPE) is None
    assert cache.entries() == []
    with pytest.raises(InputError, match=r"cannot be made .*XDG_CACHE_HOME"):
        cache.store(RECIPE, ARRAYS, RECORD)


def test_a_damaged_entry_that_cannot_be_moved_counts_as_missing(entry: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entry.write_bytes(b"not a zip")

    def fails(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "replace", fails)
    told: list[str] = []
    assert cache.load(RECIPE, told.append) is None
    assert f"stays at {entry}" in told[0]


def test_a_damaged_entry_that_was_replaced_meanwhile_is_not_set_aside(
    entry: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    entry.write_bytes(b"not a zip")
    read = entry_file.read

    def replaced_then(file: object) -> object:
        cache.store(RECIPE, ARRAYS, RECORD)
        return read(file)

    with monkeypatch.context() as patch:
        patch.setattr(entry_file, "read", replaced_then)
        assert cache.load(RECIPE) is None
    assert names() == {entry.name}
    assert cache.load(RECIPE) is not None


STORES_AND_LOADS = """
import json, sys, time
import numpy as np
from reference import cache
fill, until = float(sys.argv[1]), float(sys.argv[2])
arrays = {f"array {i}": np.full((64, 64, 3), fill) for i in range(4)}
rounds, wrong = 0, []
while rounds < 5 or time.time() < until:
    cache.store({"scene": "abc"}, arrays, {"fill": fill})
    found, record = cache.load({"scene": "abc"}, wrong.append) or ({}, {})
    if {float(value) for array in found.values() for value in (array.min(), array.max())} != {record.get("fill")}:
        wrong.append(f"mixed or missing: {record}")
    rounds += 1
print(json.dumps(wrong))
"""


def test_programs_that_store_the_same_entry_at_once_all_succeed_and_none_sees_half() -> None:
    until = str(time.time() + 2)
    workers = [
        subprocess.Popen([sys.executable, "-c", STORES_AND_LOADS, fill, until], stdout=subprocess.PIPE)
        for fill in ("1", "2", "3")
    ]
    answers = [worker.communicate(timeout=60)[0] for worker in workers]
    assert [json.loads(answer) for answer in answers] == [[]] * 3
    assert names() == {f"{cache.key({'scene': 'abc'})}.npz"}
