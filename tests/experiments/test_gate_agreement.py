"""Committed references held against Mitsuba: what agrees, what does not, and what `--update` renews."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from committed_references import rewritten

from experiments.gate import agreement, suite
from experiments.gate.agreement import FIRST_SEED, Agreement, OtherNumbers, check_reference
from experiments.gate.references import EquiangularWitness, load_reference, make_reference, reference_path
from experiments.gate.suite import REFERENCES, gate_cases
from experiments.gate.surfaces import Surfaces, compare_surfaces
from experiments.gate.update import renew_references
from scenes.errors import InputError
from scenes.loader import load, load_seen_from
from scenes.model import Scene


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load("sphere", (64, 64), phase="isotropic")


@pytest.fixture
def folder(scene: Scene, tmp_path: Path) -> Path:
    """A folder with a copy of the scene's committed reference."""
    shutil.copy(reference_path(REFERENCES, scene), tmp_path)
    return tmp_path


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
    assert ("image mean" if layer == "scattering" else "surfaces differ on") in str(found)
    assert "where the new one is right, `airlight gate --update` estimates it anew" in str(found)


@pytest.mark.parametrize("factor", [100.0, 1e60])
def test_errors_that_would_hide_anything_do_not_agree(scene: Scene, folder: Path, factor: float) -> None:
    def uncertain(arrays: dict[str, np.ndarray], record: dict) -> None:
        arrays["image_error"] = factor * arrays["image_error"]

    rewritten(reference_path(folder, scene), uncertain)
    found = check(folder, scene)
    assert found.comparison is not None
    assert not found.agrees
    assert "goes uncaught" in str(found)


def test_a_silhouette_may_move_and_an_edge_of_a_shadow_may_not(scene: Scene) -> None:
    surface = load_reference(REFERENCES, scene).estimate.mean["surface"]
    brightest = surface.max()

    def with_strays(count: int, size: float) -> Surfaces:
        other = surface.copy()
        other.reshape(-1, 3)[:count] += size * brightest
        return compare_surfaces(other, surface)

    # of 4,096 pixels
    assert with_strays(4, 1.01e-4).agree
    assert not with_strays(5, 1.01e-4).agree
    assert with_strays(4096, 1e-5).strays == 0
    # all of them a little, and one by much
    assert not with_strays(4096, 0.99e-4).agree
    assert not with_strays(1, 1.0).agree
    assert compare_surfaces(surface, surface) == Surfaces(0.0, 0.0)
    black = np.zeros_like(surface)
    assert compare_surfaces(black, black).agree
    assert not compare_surfaces(surface, black).agree


def test_surfaces_agree_where_the_eye_moves_by_a_spacing_of_float32(scene: Scene) -> None:
    committed, strays = load_reference(REFERENCES, scene).estimate.mean["surface"], []
    for axis, sign in ((0, 1), (1, 1), (2, -1)):
        eye = scene.camera.to_world.copy()
        eye[axis, 3] += sign * np.finfo(np.float32).eps * np.linalg.norm(eye[:3, 3])
        seen = load_seen_from(scene.path, eye, (64, 64), scene.parameters)
        found = compare_surfaces(committed, EquiangularWitness(seen).fixed()["surface"])
        assert found.agree, str(found)
        strays.append(found.strays)
    # the pixel that a limit on the largest difference would have failed on
    assert max(strays) == 1 / 4096


def test_update_renews_what_no_longer_agrees_and_leaves_what_does(
    scene: Scene, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = gate_cases(["parts-sphere-FrontFinal"])
    monkeypatch.setattr(suite, "REFERENCES", folder)
    assert list(renew_references(case, 0, lambda text: None)) == []

    def brighter(arrays: dict[str, np.ndarray], record: dict) -> None:
        arrays["scattering"] = np.float32(1.0005) * arrays["scattering"]

    path = reference_path(folder, scene)
    rewritten(path, brighter)
    ((written, why),) = renew_references(case, 0, lambda text: None)
    assert written == path
    assert "does not agree with what this machine's Mitsuba estimates now" in why
    np.testing.assert_allclose(
        load_reference(folder, scene).estimate.mean["scattering"],
        load_reference(REFERENCES, scene).estimate.mean["scattering"],
        rtol=1e-6,
    )


def test_without_llvm_nothing_is_estimated_anew(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agreement.mi, "variant", lambda: "scalar_rgb")
    found = check(REFERENCES, scene)
    assert found.agrees
    assert "is not estimated anew: scalar_rgb averages over pixels" in str(found)
    with pytest.raises(InputError, match="LLVM or CUDA variant"):
        make_reference(scene)
