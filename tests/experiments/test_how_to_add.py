"""The page about adding parts: its files are written, its commands run, and its pictures are what it says of them."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import OpenEXR
import polars
import pytest
from registries import restored_registries

import airlight as face
from experiments.exr import read_exr

PAGE = Path(__file__).parents[2] / "gpu_impl" / "ADDING.md"
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
COMMANDS = [line for kind, text in BLOCKS if kind == "sh" for line in text.splitlines()]
SIZE = (96, 96)


@pytest.fixture(autouse=True)
def _registries() -> Iterator[None]:
    with restored_registries():
        yield


@pytest.fixture
def page(airlight, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Its files in a folder, and a way to run those of its commands that hold some word."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    for kind, text in BLOCKS:
        if kind in ("glsl", "toml"):
            (name,) = re.findall(r"^(?://|#) (\w+\.\w+)$", text.splitlines()[0])
            (tmp_path / name).write_text(text)

    def run(word: str) -> None:
        chosen = [command for command in COMMANDS if word in command]
        assert chosen
        for command in chosen:
            program, *words = shlex.split(command)
            assert program == "airlight"
            result = airlight(*words)
            assert result.code == 0, result.err

    return run


def scattering(name: str) -> np.ndarray:
    return read_exr(Path(name))[0]["scattering"]


def drawn(technique: str, scene: object = None, **settings: object) -> np.ndarray:
    return face.render(scene or face.load("sphere", size=SIZE), technique, **settings).scattering


def test_every_block_is_of_a_kind_that_is_executed_here() -> None:
    assert {kind for kind, _ in BLOCKS} == {"glsl", "toml", "sh"}
    words = ("thin_fog", "every_other.toml", "blocks.toml", "run suite", "--export", "--rel-error", "compare")
    assert all(any(word in command for word in words) for command in COMMANDS)


def test_the_airlight_model(page) -> None:
    page("thin_fog")
    # next to no fog, where the one that counts what it takes away agrees
    thin = face.load("sphere", size=SIZE, sigma_t=1e-5)
    sampled = drawn("uniform_march+riemann", thin, steps=100)
    # 1e-5 of it for each unit of either leg; measured: 1.5e-4
    np.testing.assert_allclose(drawn("thin_fog.toml", thin), sampled, rtol=3e-4)
    # in thick fog it is too bright, everywhere
    lost = drawn("uniform_march+riemann", steps=100)
    assert (scattering("thin_fog.exr") > 1.5 * lost).all()  # measured: 1.99


def test_the_visibility_strategy(page) -> None:
    page("every_other.toml --out")
    exact = drawn("exact+quadrature")
    half, whole = scattering("every_other.exr"), drawn("uniform_march+riemann", steps=128)
    assert (half != whole).any()
    # the same light on the whole, by half the samples
    assert half.mean() == pytest.approx(exact.mean(), rel=0.02)  # measured: 3.8e-3
    twice = drawn("every_other.toml", steps=1024)
    # measured: 0.12
    assert np.median(np.abs(twice / exact - 1)) < 0.25 * np.median(np.abs(half / exact - 1))
    page("cell.exr")
    assert (scattering("cell.exr") != half).any()


def test_the_lattice(page) -> None:
    page("blocks.toml")
    found = scattering("blocks.exr")
    every = drawn("uniform_march+quadrature", steps=64)
    np.testing.assert_allclose(found, every[::4, ::4].repeat(4, axis=0).repeat(4, axis=1), rtol=2e-6)  # measured: 0


def test_the_suite(page) -> None:
    page("run suite")
    (folder,) = Path("runs").iterdir()
    table = polars.read_parquet(folder / "results.parquet")
    assert set(table["technique"]) == {"Weng2010", "EveryOther"}
    assert set(table["status"]) == {"done"}


def test_the_export_and_a_picture_of_another_engine(page, airlight) -> None:
    page("--export")
    page("--rel-error")
    assert sorted(path.name for path in Path("sphere_export").iterdir()) == ["README.txt", "pixels.exr", "scene.json"]
    image = drawn("exact+quadrature")
    # as an engine would save it that knows nothing of layers
    OpenEXR.File({}, {"RGB": image}).write("yours.exr")
    page("compare")
    OpenEXR.File({}, {"RGB": np.ascontiguousarray(image[::-1])}).write("yours.exr")
    result = airlight("compare", "yours.exr", "reference.exr", "--layer", "scattering")
    assert "yours.exr fits far better upside down" in result.err
