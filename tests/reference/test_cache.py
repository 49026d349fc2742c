"""References kept on disk: what is damaged is never believed, what cannot be kept is said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from reference import cache
from reference.estimate import estimate_reference
from reference.goal import Goal
from scenes.errors import InputError
from scenes.loader import load

RECIPE = {"scene": "abc", "size": [4, 3], "goal": {"rel_error": 0.1}}
ARRAYS = {"mean.scattering": np.arange(36.0).reshape(3, 4, 3), "image_mean.scattering": np.ones(3)}
RECORD = {"passes": 32, "reached": True}


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def entry() -> Path:
    """An entry's file."""
    cache.store(RECIPE, ARRAYS, RECORD)
    (path,) = cache.folder().iterdir()
    return path


def test_what_is_stored_comes_back(entry: Path) -> None:
    arrays, record = cache.load(RECIPE)
    assert record == RECORD | {"recipe": RECIPE}
    assert arrays.keys() == ARRAYS.keys()
    for name, array in ARRAYS.items():
        assert (arrays[name] == array).all()
        assert arrays[name].dtype == np.float64


def test_another_recipe_is_another_entry(entry: Path) -> None:
    assert cache.load(RECIPE | {"size": [4, 4]}) is None
    assert cache.load(dict(reversed(RECIPE.items()))) is not None


def test_nothing_stored_is_nothing_found() -> None:
    assert cache.load(RECIPE) is None


def refused(entry: Path) -> None:
    assert cache.load(RECIPE) is None
    # set aside to look at, and out of the way of its successor
    assert not entry.exists()
    assert entry.with_suffix(".damaged").exists()
    cache.store(RECIPE, ARRAYS, RECORD)
    assert cache.load(RECIPE) is not None


@pytest.mark.parametrize("kept", [0, 1, 100, 0.5, -1])
def test_a_truncated_entry_is_set_aside(kept: float, entry: Path) -> None:
    content = entry.read_bytes()
    entry.write_bytes(content[: int(kept * len(content)) if 0 < kept < 1 else kept])
    refused(entry)


def test_an_entry_of_another_recipe_is_set_aside(entry: Path) -> None:
    other = RECIPE | {"size": [8, 8]}
    cache.store(other, ARRAYS, RECORD)
    entry.write_bytes((cache.folder() / f"{cache.key(other)}.npz").read_bytes())
    refused(entry)


@pytest.mark.parametrize("content", [b"not a zip", b"\x93NUMPY\x01\x00", b"\x80\x04N."], ids=["text", "npy", "pickle"])
def test_a_file_of_another_kind_is_set_aside(content: bytes, entry: Path) -> None:
    entry.write_bytes(content)
    refused(entry)


def test_an_array_in_place_of_an_entry_is_set_aside(entry: Path) -> None:
    with entry.open("wb") as file:
        np.save(file, np.ones(3))
    refused(entry)


def test_an_entry_without_a_record_is_set_aside(entry: Path) -> None:
    with entry.open("wb") as file:
        np.savez(file, **ARRAYS)
    refused(entry)


def test_no_damaged_byte_changes_what_is_read(entry: Path) -> None:
    content = entry.read_bytes()
    noticed = 0
    for position in np.random.default_rng(4).permutation(len(content))[:400]:
        spoilt = bytearray(content)
        spoilt[position] ^= 0x55
        entry.write_bytes(spoilt)
        found = cache.load(RECIPE)
        noticed += found is None
        if found is not None:
            assert found[1] == RECORD | {"recipe": RECIPE}
            assert all((found[0][name] == array).all() for name, array in ARRAYS.items())
    assert noticed > 200


def test_a_half_written_entry_is_never_read(monkeypatch: pytest.MonkeyPatch) -> None:
    def dies(file, **_: object) -> None:
        file.write(b"PK half")
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(np, "savez", dies)
        with pytest.raises(KeyboardInterrupt):
            cache.store(RECIPE, ARRAYS, RECORD)
    assert list(cache.folder().iterdir()) == []
    assert cache.load(RECIPE) is None
    cache.store(RECIPE, ARRAYS, RECORD)
    assert cache.load(RECIPE) is not None


def test_a_full_disk_is_one_sentence_and_leaves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(file, **_: object) -> None:
        file.write(b"PK half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(InputError, match=r"cannot be written \(No space left on device\).*XDG_CACHE_HOME"):
        cache.store(RECIPE, ARRAYS, RECORD)
    assert list(cache.folder().iterdir()) == []


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # a file in its place: root may write anywhere, so permissions would not do
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    assert cache.load(RECIPE) is None
    with pytest.raises(InputError, match=r"cannot be made .*XDG_CACHE_HOME"):
        cache.store(RECIPE, ARRAYS, RECORD)


def test_a_damaged_entry_that_cannot_be_moved_counts_as_missing(entry: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entry.write_bytes(b"not a zip")

    def fails(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "replace", fails)
    assert cache.load(RECIPE) is None


def test_a_reference_is_estimated_once() -> None:
    scene, goal = load("sphere", size=(6, 5)), Goal(0.2)
    first, again = estimate_reference(scene, goal), estimate_reference(scene, goal)
    assert (first.from_cache, again.from_cache) == (False, True)
    assert first.recipe == again.recipe
    for layer in ("surface", "scattering", "composite"):
        assert (getattr(first, layer) == getattr(again, layer)).all()
        assert (first.standard_error(layer) == again.standard_error(layer)).all()
    for field in ("passes", "rel_error", "reached", "seconds"):
        assert getattr(first.estimate, field) == getattr(again.estimate, field)


def test_whatever_decides_a_reference_makes_another_one() -> None:
    scene = load("empty", size=(6, 5))
    estimate_reference(scene, Goal(0.2))
    for other, goal in [
        (load("empty", size=(5, 6)), Goal(0.2)),
        (load("empty", size=(6, 5), sigma_t=0.11), Goal(0.2)),
        (load("empty", size=(6, 5), phase="hg", g=0.6), Goal(0.2)),
        (load("empty", size=(6, 5), phase="hg", g=-0.6), Goal(0.2)),
        (scene, Goal(0.1)),
    ]:
        assert not estimate_reference(other, goal).from_cache
    assert estimate_reference(load("empty", size=(6, 5)), Goal(0.2)).from_cache
