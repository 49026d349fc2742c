"""A catalogue of meshes on a server on loopback."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from fetchable_balls import BALL_PLY, BOX_OBJ, known
from mesh_server import MeshServer, serving

from scenes.meshes import catalogue
from scenes.meshes import fetch as mesh_fetch
from scenes.meshes.catalogue import Original
from scenes.meshes.files import VARIABLE
from scenes.meshes.steps import Step


@pytest.fixture
def server() -> Iterator[MeshServer]:
    with serving() as running:
        yield running


@pytest.fixture
def data(server: MeshServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A catalogue of four meshes on the server; the user's folder of meshes, which does not exist yet."""
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.delenv(VARIABLE, raising=False)
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    monkeypatch.setattr(mesh_fetch, "TIMEOUT", 0.3)
    ball = Original(f"{server.address}/ball.tar.gz", "ball.ply", hashlib.sha256(BALL_PLY).hexdigest())
    box = Original(f"{server.address}/box.zip", "box.obj", hashlib.sha256(BOX_OBJ).hexdigest())
    meshes = {
        "ball.ply": known(ball, (Step("repair"),)),
        "coarse_ball.ply": known(ball, (Step("decimate", {"target": 600}), Step("repair"))),
        "box.ply": known(box, (Step("catmull_clark", {"levels": 2}),)),
        "by_hand.ply": known(None, ()),
    }
    monkeypatch.setattr(catalogue, "MESHES", meshes)
    return tmp_path / "data" / "airlight" / "meshes"
