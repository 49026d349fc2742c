"""`airlight meshes`: the list says what there is, fetch shows terms, steps and path, and refuses in one sentence."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from mesh_server import serving, stalled, tar, whole

from experiments.meshes_cli import meshes_app
from scenes.errors import InputError
from scenes.meshes import catalogue
from scenes.meshes.catalogue import MESHES, KnownMesh, Original
from scenes.meshes.files import VARIABLE
from scenes.meshes.procedural import RECIPES
from scenes.meshes.steps import Step
from scenes.meshes.triangles import Triangles, ply_bytes

BALL = trimesh.creation.icosphere(subdivisions=2)
BALL_PLY = ply_bytes(Triangles(np.asarray(BALL.vertices, np.float32), np.asarray(BALL.faces[:-3], np.uint32)))
Run = Callable[..., str]


@pytest.fixture
def meshes(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Run:
    """Run `airlight meshes ...` in this process, with empty folders of the user's; what it printed."""
    for variable in ("XDG_DATA_HOME", "XDG_CACHE_HOME"):
        monkeypatch.setenv(variable, str(tmp_path / variable))
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.delenv(VARIABLE, raising=False)

    def run(*words: str) -> str:
        meshes_app(list(words), standalone_mode=False)
        return capsys.readouterr().out

    return run


def listed(meshes: Run) -> dict[str, dict]:
    return {row["name"]: row for row in json.loads(meshes("list", "--json"))}


def test_the_list_has_every_mesh_and_says_where_it_is_from(
    meshes: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = listed(meshes)
    assert set(rows) == set(MESHES) | set(RECIPES)
    teapot, torus = rows["teapot.ply"], rows["torus.ply"]
    assert (teapot["from"], teapot["reference_copy"], teapot["licence"]) == ("stand-in", False, "not stated")
    assert "by hand" in teapot["get"]
    assert (torus["from"], torus["reference_copy"], torus["licence"]) == ("generated", True, "BSD-3-Clause")
    assert rows["dragon_97k_fixed.ply"]["get"] == "airlight meshes fetch dragon_97k_fixed.ply"

    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "spot.ply").write_bytes(BALL_PLY)
    (folder / "own.ply").write_bytes(BALL_PLY)
    monkeypatch.setenv(VARIABLE, str(folder))
    rows = listed(meshes)
    assert (rows["spot.ply"]["from"], rows["spot.ply"]["reference_copy"]) == ("mesh folder", False)
    assert rows["own.ply"]["licence"] is None
    real = hashlib.sha256(BALL_PLY).hexdigest()
    monkeypatch.setitem(catalogue.MESHES, "spot.ply", KnownMesh("a cow", "C", "L", "o", "http://p", real))
    spot = listed(meshes)["spot.ply"]
    assert (spot["reference_copy"], spot["sha256"], spot["path"]) == (True, real, str(folder / "spot.ply"))


def test_the_table_shows_each_name_and_licence(meshes: Run) -> None:
    text = meshes("list")
    for name in [*MESHES, "torus.ply", "CC BY 3.0", "airlight meshes fetch"]:
        assert name in text
    assert VARIABLE in text


def test_fetch_shows_terms_steps_and_path_and_the_list_then_knows(meshes: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    with serving() as server:
        server.answers["/ball.tar.gz"] = whole(tar({"recon/ball.ply": BALL_PLY}))
        original = Original(f"{server.address}/ball.tar.gz", "ball.ply", hashlib.sha256(BALL_PLY).hexdigest())
        ball = KnownMesh("a ball", "Somebody", "for research", "o", "http://p", "0" * 64, original, (Step("repair"),))
        monkeypatch.setattr(catalogue, "MESHES", {"ball.ply": ball})
        text = meshes("fetch", "--all")
        assert text.startswith("ball.ply: a ball. Credit: Somebody. Licence: for research.\n")
        assert "ball.ply: repair()\n" in text
        row = listed(meshes)["ball.ply"]
        assert f"{row['path']}: ball.ply, repair -> {len(BALL.faces)} polygons" in text
        assert (row["from"], row["steps"][0]["step"], row["licence"]) == ("user data", "repair", "for research")
        assert "was there already" in meshes("fetch", "ball.ply")
        assert server.asked == ["/ball.tar.gz"]
        Path(row["path"] + ".json").unlink()
        monkeypatch.setitem(catalogue.MESHES, "ball.ply", dataclasses.replace(ball, reference_sha256=row["sha256"]))
        assert f"{row['path']}: was there already, and is the reference copy\n" in meshes("fetch", "ball.ply")


def test_the_list_is_shown_beside_a_damaged_note(meshes: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "spot.ply").write_bytes(BALL_PLY)
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    for text in ("[" * 200_000, '{"steps": [{}]}', "null"):
        (tmp_path / "spot.ply.json").write_text(text)
        assert listed(meshes)["spot.ply"]["steps"] == []


TERMINATED = """
import dataclasses, sys
from experiments.meshes_cli import meshes_app
from scenes.meshes import catalogue
known = catalogue.MESHES["dragon_res3_fixed.ply"]
here = dataclasses.replace(known.original, address=sys.argv[1])
catalogue.MESHES["dragon_res3_fixed.ply"] = dataclasses.replace(known, original=here)
meshes_app(["fetch", "dragon_res3_fixed.ply"], standalone_mode=False)
"""


def test_a_program_that_is_terminated_while_it_fetches_leaves_nothing_behind(tmp_path: Path) -> None:
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    folders = {"TMPDIR": str(temporary), "XDG_DATA_HOME": str(tmp_path / "data"), "NO_PROXY": "*"}
    with serving() as server:
        server.answers["/ball.tar.gz"] = stalled(np.random.default_rng(1).bytes(1_000_000), server)
        process = subprocess.Popen(
            [sys.executable, "-c", TERMINATED, f"{server.address}/ball.tar.gz"],
            env=os.environ | folders,
            stderr=subprocess.PIPE,
        )
        try:
            patience = time.monotonic() + 60
            while not list(temporary.rglob("*/*")) and time.monotonic() < patience:
                assert process.poll() is None, process.stderr
                time.sleep(0.02)
            assert list(temporary.rglob("*/*"))
            process.terminate()
            _, said = process.communicate(timeout=60)
        finally:
            process.kill()
    assert process.returncode == 128 + signal.SIGTERM
    assert b"Traceback" not in said
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
    assert list(temporary.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ((), "Name the meshes"),
        (("--all", "spot.ply"), "Name the meshes"),
        (("spot.ply",), "Keenan Crane's model repository"),
        (("dragon.ply",), "is no mesh that can be fetched"),
    ],
)
def test_what_cannot_be_fetched_is_refused_in_one_sentence(
    meshes: Run, words: tuple[str, ...], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(InputError, match=sentence):
        meshes("fetch", *words)
    assert capsys.readouterr().out == ""


def test_the_commands_load_nothing_heavy_until_they_run() -> None:
    code = (
        "import sys, experiments.meshes_cli; "
        "print([m for m in ('numpy', 'rich', 'pooch', 'requests', 'fast_simplification') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
