"""Committed references: kept as they were, and refused where missing, damaged or stale."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from committed_references import Rewrite, rewritten

from experiments.gate.references import (
    EquiangularWitness,
    deciding,
    load_reference,
    make_reference,
    reference_path,
    write_reference,
)
from experiments.gate.suite import REFERENCES
from reference.convergence import Estimate
from reference.integrator import mi
from reference.moments import tiles
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Scene


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load("sphere", (64, 64), phase="isotropic")


@pytest.fixture
def folder(scene: Scene, tmp_path: Path) -> Path:
    """A folder with a copy of the scene's committed reference."""
    shutil.copy(reference_path(REFERENCES, scene), tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def small() -> tuple[Scene, Estimate]:
    found = load("sphere", (16, 24), phase="hg", g=0.3)
    return found, make_reference(found)


def test_what_is_written_is_read(small: tuple[Scene, Estimate], tmp_path: Path) -> None:
    scene, estimate = small
    path = write_reference(tmp_path / "new", scene, estimate)
    assert path.name == "sphere-hg-0.3-16x24.npz"
    reference = load_reference(tmp_path / "new", scene)
    found = reference.estimate
    for layer in ("scattering", "surface"):
        # float32 rounds by 6e-8
        np.testing.assert_allclose(found.mean[layer], estimate.mean[layer], rtol=1e-7)
        np.testing.assert_allclose(found.tile_mean[layer], estimate.tile_mean[layer], rtol=1e-7)
        np.testing.assert_allclose(found.image_mean[layer], estimate.image_mean[layer], rtol=1e-7)
        assert found.mean[layer].shape == (24, 16, 3)
    largest = estimate.standard_error["scattering"].max()
    np.testing.assert_allclose(
        found.standard_error["scattering"], estimate.standard_error["scattering"], rtol=5e-4, atol=4e-8 * largest
    )
    np.testing.assert_allclose(found.tile_error["scattering"], estimate.tile_error["scattering"], rtol=1e-7)
    np.testing.assert_array_equal(found.image_error["scattering"], estimate.image_error["scattering"])
    np.testing.assert_array_equal(found.samples, estimate.samples)
    assert (found.passes, found.stopped_by) == (estimate.passes, "goal")
    assert (reference.scene_digest, reference.pixel_filter) == (scene.digest, "centre")
    assert reference.recipe["variant"] == mi.variant()


def test_versions_of_mitsuba_do_not_decide(scene: Scene) -> None:
    assert set(deciding(scene)) == {"format", "scene", "size", "estimator", "estimator_version", "pixel_filter"}


def test_a_missing_reference_is_an_error(scene: Scene, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no committed reference .*sphere-isotropic-64x64\.npz.*gate --update"):
        load_reference(tmp_path, scene)


@pytest.mark.parametrize("place", [0.0, 0.1, 0.3, 0.5, 0.7, 0.9])
def test_a_damaged_reference_is_an_error(scene: Scene, folder: Path, place: float) -> None:
    path = reference_path(folder, scene)
    data = bytearray(path.read_bytes())
    at = int(place * len(data))
    data[at : at + 16] = bytes(255 - value for value in data[at : at + 16])
    path.write_bytes(data)
    with pytest.raises(InputError, match="is damaged: restore it"):
        load_reference(folder, scene)


@pytest.mark.parametrize("left", [0, 100, 20000])
def test_a_reference_that_was_cut_off_is_an_error(scene: Scene, folder: Path, left: int) -> None:
    path = reference_path(folder, scene)
    path.write_bytes(path.read_bytes()[:left])
    with pytest.raises(InputError, match="is damaged: restore it"):
        load_reference(folder, scene)


def test_a_reference_of_another_scene_is_stale(scene: Scene, folder: Path) -> None:
    with pytest.raises(InputError, match="is stale: its scene is not that of"):
        load_reference(folder, replace(scene, digest="another"))


def test_a_reference_of_an_older_estimator_is_stale(
    scene: Scene, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(EquiangularWitness, "version", EquiangularWitness.version + 1)
    with pytest.raises(InputError, match="is stale: its estimator version is not"):
        load_reference(folder, scene)


def test_a_recipe_that_was_changed_by_hand_is_an_error(scene: Scene, folder: Path) -> None:
    def relabelled(arrays: dict[str, np.ndarray], record: dict) -> None:
        record["recipe"]["scene"] = "another"

    rewritten(reference_path(folder, scene), relabelled)
    with pytest.raises(InputError, match="does not have the hash of its own recipe"):
        load_reference(folder, replace(scene, digest="another"))


def set_to(name: str, value: float) -> Rewrite:
    """Spoil one number of an array."""

    def spoilt(arrays: dict[str, np.ndarray], record: dict) -> None:
        arrays[name].flat[7 % arrays[name].size] = value

    return spoilt


def told(key: str, value: object) -> Rewrite:
    """Spoil an entry of the record."""
    return lambda arrays, record: record.__setitem__(key, value)


def shaped(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Rewrite:
    """Spoil an array's shape or type."""
    return lambda arrays, record: arrays.__setitem__(name, change(arrays[name]))


GOAL = {"rel_error": 0.001, "time_limit": 120.0, "percentile": 95.0, "sample_limit": None}
SPOILT: dict[str, Rewrite] = {
    **{
        f"{name} {value}": set_to(name, value) for name in ("scattering", "surface") for value in (np.nan, np.inf, -1.0)
    },
    **{f"{name} {value}": set_to(name, value) for name in ("error", "tile_error") for value in (np.nan, -1.0)},
    "image_error": set_to("image_error", np.nan),
    "no sample": set_to("samples", 0),
    "black": shaped("scattering", np.zeros_like),
    **{
        f"{name} cut": shaped(name, lambda array: array[..., 1:])
        for name in ("scattering", "error", "tile_error", "image_error", "samples")
    },
    "samples signed": shaped("samples", lambda array: array.astype(np.int16)),
    "scattering text": shaped("scattering", lambda array: array.astype(str)),
    "no error": lambda arrays, record: arrays.__delitem__("error"),
    "an array more": lambda arrays, record: arrays.__setitem__("more", np.zeros(3)),
    "no largest_error": lambda arrays, record: record.__delitem__("largest_error"),
    "no passes": lambda arrays, record: record.__delitem__("passes"),
    **{f"largest_error {value}": told("largest_error", value) for value in (-1.0, 0.0, np.nan, np.inf, "1", None)},
    **{f"passes {value}": told("passes", value) for value in (0, 1, -32, 32.5, "32", True)},
    **{f"seconds {value}": told("seconds", value) for value in (np.nan, "long")},
    "stopped_by": told("stopped_by", "luck"),
    "recipe": told("recipe", [1]),
    "recipe_hash": told("recipe_hash", 3),
    "goal": told("goal", "small"),
    "goal cut": told("goal", {key: GOAL[key] for key in ("rel_error",)} | {"time_limit": -1.0}),
}


@pytest.mark.parametrize("how", SPOILT)
def test_a_reference_that_no_estimate_can_be_is_damaged(scene: Scene, folder: Path, how: str) -> None:
    rewritten(reference_path(folder, scene), SPOILT[how])
    with pytest.raises(InputError, match="is damaged: restore it"):
        load_reference(folder, scene)


def test_tiles_of_a_read_reference_are_those_of_its_pixels(scene: Scene) -> None:
    found = load_reference(REFERENCES, scene).estimate
    np.testing.assert_array_equal(found.tile_mean["scattering"], tiles(found.mean["scattering"]))
    assert found.tile_error["scattering"].shape == found.tile_mean["scattering"].shape
