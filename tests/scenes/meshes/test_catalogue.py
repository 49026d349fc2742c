"""The meshes that are not ours: what is known of each, and whom to credit for a file."""

from __future__ import annotations

import dataclasses
import hashlib
import re
from pathlib import Path

import numpy as np
import pytest

from scenes.meshes import catalogue
from scenes.meshes.catalogue import MESHES, KnownMesh, credit
from scenes.meshes.files import VARIABLE, find_mesh
from scenes.meshes.notes import note_path
from scenes.meshes.procedural import RECIPES
from scenes.meshes.steps import STEPS
from scenes.meshes.triangles import Triangles, ply_bytes

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
BALL_PLY = ply_bytes(Triangles(CORNERS, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], np.uint32)))


def test_credit_goes_by_bytes_then_by_the_note_then_by_the_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = {"ball.ply": KnownMesh("a ball", "Somebody", "for research", "a page", "http://page", "0" * 64)}
    monkeypatch.setattr(catalogue, "MESHES", known)
    folder = tmp_path / "meshes"
    folder.mkdir()
    (folder / "ball.ply").write_bytes(BALL_PLY)
    (folder / "mine.ply").write_bytes(BALL_PLY)
    monkeypatch.setenv(VARIABLE, str(folder))
    assert credit(find_mesh("ball.ply", tmp_path)) == "ball.ply: Somebody (for research), by its name alone"
    assert credit(find_mesh("mine.ply", tmp_path)) is None
    assert credit(find_mesh("ball.ply", folder)) is None  # a scene's own ball
    copy = dataclasses.replace(catalogue.MESHES["ball.ply"], reference_sha256=hashlib.sha256(BALL_PLY).hexdigest())
    catalogue.MESHES["ball.ply"] = copy
    assert credit(find_mesh("ball.ply", tmp_path)) == "ball.ply: Somebody (for research)"
    assert credit(find_mesh("ball.ply", folder)) == "ball.ply: Somebody (for research)"
    for text in ("{", "[]", '{"sha256": "0"}'):
        note_path(folder / "mine.ply").write_text(text)
        assert credit(find_mesh("mine.ply", tmp_path)) is None


def test_what_our_code_made_needs_no_credit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # a folder of the user's may hold them too
    monkeypatch.delenv("AIRLIGHT_MESH_DIR", raising=False)
    assert credit(find_mesh("teapot.ply", tmp_path)) is None
    assert credit(find_mesh("torus.ply", tmp_path)) is None


def test_the_catalogue_has_every_mesh_with_a_stand_in_and_is_complete() -> None:
    assert set(MESHES) == {name for name, recipe in RECIPES.items() if recipe.stands_in}
    for mesh in MESHES.values():
        assert re.fullmatch("[0-9a-f]{64}", mesh.reference_sha256)
        assert mesh.what
        assert mesh.credit
        assert mesh.licence
        assert mesh.page.startswith(("http://", "https://"))
        assert bool(mesh.original) == bool(mesh.steps)
        for step in mesh.steps:
            assert step.name in STEPS
        if mesh.original:
            assert re.fullmatch("[0-9a-f]{64}", mesh.original.sha256)
            assert "/" not in mesh.original.member
    assert len({mesh.reference_sha256 for mesh in MESHES.values()}) == len(MESHES)
