"""What every test stands on: Mitsuba set up as airlight sets it up, and folders that are not the user's."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from other_meshes import write_models

from scenes.mitsuba_setup import mitsuba

# before any test module imports Mitsuba by itself: Dr.Jit settles on an LLVM library when it is first imported
MITSUBA = mitsuba()


@pytest.fixture(scope="session", autouse=True)
def _own_folders(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        patch.setenv("XDG_DATA_HOME", str(tmp_path_factory.mktemp("data")))
        yield


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An empty cache for one test; the others share theirs."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture(scope="session")
def others(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of scenes in other people's style, with the models and pictures that they name."""
    folder = tmp_path_factory.mktemp("elsewhere") / "others"
    shutil.copytree(Path(__file__).parent / "others", folder)
    write_models(folder / "models")
    return folder


@pytest.fixture(autouse=True)
def _variant_stays() -> Iterator[None]:
    """A test that turns to another variant leaves the others theirs."""
    before = MITSUBA.variant()
    yield
    if MITSUBA.variant() != before:
        MITSUBA.set_variant(before)
