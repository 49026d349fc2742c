"""Committed references: kept as they were, refused where missing, damaged or stale, and held against Mitsuba."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from experiments.gate import agreement
from experiments.gate.agreement import FIRST_SEED, Agreement, OtherNumbers, check_reference
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

Rewrite = Callable[[dict[str, np.ndarray], dict], None]


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load("sphere", (64, 64), phase="isotropic")


@pytest.fixture
def folder(scene: Scene, tmp_path: Path) -> Path:
    """A folder with a copy of the scene's committed reference."""
    shutil.copy(reference_path(REFERENCES, scene), tmp_path)
    return tmp_path


def rewritten(path: Path, change: Rewrite) -> None:
    with np.load(path) as entry:
        arrays = dict(entry)
    record = json.loads(str(arrays.pop("record")))
    change(arrays, record)
    np.savez_compressed(path, record=np.array(json.dumps(record)), **arrays)


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


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_reference_that_is_not_finite_is_an_error(scene: Scene, folder: Path, value: float) -> None:
    def spoilt(arrays: dict[str, np.ndarray], record: dict) -> None:
        arrays["surface"][0, 3, 4] = value

    rewritten(reference_path(folder, scene), spoilt)
    with pytest.raises(InputError, match="holds no pictures of 64 x 64"):
        load_reference(folder, scene)


def check(folder: Path, scene: Scene) -> Agreement:
    return check_reference(folder, scene, FIRST_SEED)


def test_a_committed_reference_agrees_with_a_new_one(scene: Scene) -> None:
    found = check(REFERENCES, scene)
    assert found.agrees, str(found)
    assert found.comparison is not None
    # what the sentence promises: measured 6.7e-5
    assert found.comparison.verdicts[2].power < 1e-4
    # other random numbers: without what is allowed for the unseen, differences are as large as their errors
    new, old = found.comparison.first.pixels, found.comparison.second.pixels
    variance = new.variance - new.allowed + old.variance - old.allowed
    lit = new.mean > 0
    score = (new.mean - old.mean)[lit] / np.sqrt(variance[lit])
    assert 0.9 < score.std() < 1.15


def test_other_seeds_give_other_numbers(scene: Scene) -> None:
    new, old = OtherNumbers(scene, FIRST_SEED), EquiangularWitness(scene)
    assert (new.one_pass(0)["scattering"] != old.one_pass(0)["scattering"]).any()
    np.testing.assert_array_equal(new.one_pass(3)["scattering"], old.one_pass(FIRST_SEED + 3)["scattering"])


@pytest.mark.parametrize("layer", ["scattering", "surface"])
def test_a_reference_that_is_a_little_wrong_does_not_agree(scene: Scene, folder: Path, layer: str) -> None:
    def brighter(arrays: dict[str, np.ndarray], record: dict) -> None:
        arrays[layer] = np.float32(1.0005) * arrays[layer]

    rewritten(reference_path(folder, scene), brighter)
    found = check(folder, scene)
    assert not found.agrees
    assert ("image mean" if layer == "scattering" else "surfaces differ by") in str(found)


def test_without_llvm_nothing_is_estimated_anew(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agreement.mi, "variant", lambda: "scalar_rgb")
    found = check(REFERENCES, scene)
    assert found.agrees
    assert "is not estimated anew: scalar_rgb averages over pixels" in str(found)
    with pytest.raises(InputError, match="LLVM or CUDA variant"):
        make_reference(scene)


def test_tiles_of_a_read_reference_are_those_of_its_pixels(scene: Scene) -> None:
    found = load_reference(REFERENCES, scene).estimate
    np.testing.assert_array_equal(found.tile_mean["scattering"], tiles(found.mean["scattering"]))
    assert found.tile_error["scattering"].shape == found.tile_mean["scattering"].shape
