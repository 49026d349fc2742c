"""What `airlight benchmark techniques` rests on: intervals of medians, spacing of samples, a budget of triangles."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scene_files import sphere, write_scene

from experiments.intervals import FEWEST_ROUNDS, median_interval
from experiments.technique_benchmark import budget
from experiments.technique_benchmark.spacing import steps_as_dense
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from gpu_impl.visibilities import VISIBILITIES
from scenes.errors import InputError
from scenes.loader import load

RNG = np.random.default_rng(6)


def test_the_interval_holds_the_median_as_often_as_it_says() -> None:
    # log-normal: nothing about it is symmetric, and its median is 1
    for n in (6, 15, 40):
        found = [median_interval(np.exp(RNG.normal(size=n))) for _ in range(1000)]
        held = np.mean([low <= 1 <= high for low, high in found])
        # 95 % at least, and no more than counts in whole samples make it (97 % for 6 of them)
        # and three standard errors of a thousand of them
        assert 0.93 < held < 0.99, n
    assert median_interval(np.arange(6.0)) == (0.0, 5.0)
    # of 15 the fourth from either end: fewer than four on one side happen 1.8 % of the time each
    assert median_interval(RNG.permutation(np.arange(15.0))) == (3.0, 11.0)


def test_too_few_rounds_are_refused(airlight) -> None:
    with pytest.raises(ValueError, match="values must be 6 or more"):
        median_interval(np.ones(FEWEST_ROUNDS - 1))
    assert airlight("benchmark", "techniques", "sphere", "--frames", FEWEST_ROUNDS - 1).code == 2


def test_as_dense_is_the_length_of_rays_over_their_regions(tmp_path: Path) -> None:
    bounded = find_technique("lit_intervals+quadrature", steps=16, shadow_map=256)
    before = set(AIRLIGHT_MODELS), set(VISIBILITIES)
    with Renderer(write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), size=(24, 24))) as renderer:
        dense = steps_as_dense(renderer, bounded)
        assert steps_as_dense(renderer, replace(bounded, steps=32)) == pytest.approx(2 * dense, abs=1)
    # rays of some 25 units, of which a ball's shadow takes two or three
    assert 5 * 16 < dense < 30 * 16
    with Renderer(load("empty", size=(8, 8))) as renderer:
        assert steps_as_dense(renderer, bounded) == 16
    assert (set(AIRLIGHT_MODELS), set(VISIBILITIES)) == before


def test_a_budget_decimates_files_for_both_renderers(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    whole = load("wire_mesh", size=(8, 8), phase="rayleigh")
    count = budget.triangle_count(whole)
    meshes = os.environ.get("AIRLIGHT_MESH_DIR")
    coarse = budget.load_within("wire_mesh", 20_000, size=(8, 8), phase="rayleigh")
    assert count > 100_000
    assert 0.9 * 20_000 < budget.triangle_count(coarse) <= 20_000
    assert coarse.digest != whole.digest
    assert coarse.phase.name == "rayleigh"
    assert os.environ.get("AIRLIGHT_MESH_DIR") == meshes
    # the shape is the same
    for before, after in zip(whole.meshes, coarse.meshes, strict=True):
        np.testing.assert_allclose(after.vertices.min(axis=0), before.vertices.min(axis=0), atol=0.05)
        np.testing.assert_allclose(after.vertices.max(axis=0), before.vertices.max(axis=0), atol=0.05)
    # within the budget nothing happens
    assert budget.load_within("wire_mesh", count, size=(8, 8), phase="rayleigh").digest == whole.digest
    with pytest.raises(InputError, match="in no mesh file"):
        budget.load_within("sphere", 100, size=(8, 8))


def test_a_decimated_stand_in_is_called_one(monkeypatch) -> None:
    monkeypatch.delenv("AIRLIGHT_MESH_DIR", raising=False)
    coarse = budget.load_within("dragon", 2000, size=(8, 8))
    assert budget.triangle_count(coarse) <= 2000
    assert coarse.stand_ins == load("dragon", size=(8, 8)).stand_ins == ("dragon_97k_fixed.ply",)
    assert coarse.parsed.nodes
