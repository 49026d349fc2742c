"""Meshes fetched from a server on loopback: checked, made and noted, or nothing left behind."""

from __future__ import annotations

import dataclasses
import errno
import hashlib
import json
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler
from pathlib import Path

import numpy as np
import pytest
import trimesh
from fetchable_balls import BALL_PLY, BOX_OBJ, GOOD, fetched, files_below
from mesh_server import Answer, MeshServer, stalled, tar, whole, zipped

from scenes.errors import InputError
from scenes.meshes import archive_member, catalogue
from scenes.meshes import fetch as mesh_fetch
from scenes.meshes.catalogue import credit
from scenes.meshes.catmull_clark import catmull_clark
from scenes.meshes.fetch import Watcher, fetch
from scenes.meshes.files import VARIABLE, find_mesh, read_mesh
from scenes.meshes.notes import note_path
from scenes.meshes.polygons import as_triangles, read_polygons
from scenes.meshes.steps import STEPS

# --- what is fetched -------------------------------------------------------------------------------------------------


def test_a_mesh_is_fetched_made_and_noted(server: MeshServer, data: Path, tmp_path: Path) -> None:
    server.answers = {"/ball.tar.gz": whole(tar(GOOD)), "/box.zip": whole(zipped({"deep/er/box.obj": BOX_OBJ}))}
    meshes = fetched("ball.ply", "box.ply", "coarse_ball.ply")
    assert server.asked == ["/ball.tar.gz", "/box.zip"]  # one archive for two meshes
    names = ["ball.ply", "box.ply", "coarse_ball.ply"]
    assert files_below(tmp_path) == sorted(f"data/airlight/meshes/{n}{end}" for n in names for end in ("", ".json"))
    assert sorted(mesh.path.name for mesh in meshes) == names
    for mesh in meshes:
        triangles = read_mesh(mesh.path)
        shell = trimesh.Trimesh(triangles.vertices, triangles.faces, process=False)
        assert shell.is_watertight
        note = json.loads(note_path(mesh.path).read_text())
        assert mesh.note
        assert note == mesh.note.model_dump()
        assert note["sha256"] == hashlib.sha256(mesh.path.read_bytes()).hexdigest()
        assert note["triangles"] == len(triangles.faces)
        assert (note["credit"], note["licence"]) == ("Somebody", "for research")
        found = find_mesh(mesh.path.name, tmp_path)
        assert (found.path, found.origin) == (mesh.path, "user data")
        assert credit(found) == f"{found.name}: Somebody (for research)"
    note = json.loads(note_path(data / "coarse_ball.ply").read_text())
    assert [(step["step"], step["parameters"]) for step in note["steps"]] == [
        ("decimate", {"target": 600}),
        ("repair", {}),
    ]
    assert note["original_sha256"] == hashlib.sha256(BALL_PLY).hexdigest()
    assert note["address"] == f"{server.address}/ball.tar.gz"
    original = tmp_path / "box.obj"
    original.write_bytes(BOX_OBJ)
    expected = as_triangles(catmull_clark(read_polygons(original), 2))
    np.testing.assert_array_equal(read_mesh(data / "box.ply").vertices, expected.vertices)


def test_progress_is_told_from_the_first_byte_to_the_last(server: MeshServer, data: Path) -> None:
    body = tar({**GOOD, "ballast": np.random.default_rng(1).bytes(300_000)})
    server.answers["/ball.tar.gz"] = whole(body)
    seen: list[tuple[int, int]] = []
    steps: list[str] = []

    class Recorder(Watcher):
        def downloading(self, address: str, done: int, total: int) -> None:
            seen.append((done, total))

        def doing(self, mesh: str, what: str) -> None:
            steps.append(f"{mesh} {what}")

    list(fetch(["ball.ply"], Recorder()))
    assert len(seen) > 3
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)
    assert seen[-1] == (len(body), len(body))
    assert steps == ["ball.ply unpack ball.ply", "ball.ply repair()"]


@pytest.mark.parametrize(
    ("address", "sentence"),
    [
        ("http://does-not-exist.invalid/", r"\(the name does-not-exist\.invalid cannot be resolved\); try again later"),
        # nothing listens on the port of tcpmux
        ("http://127.0.0.1:1/", r"\(Connection refused\); try again later"),
    ],
)
def test_the_reason_of_no_connection_is_given_in_plain_words(
    address: str, sentence: str, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_PROXY", "*")
    ball = catalogue.MESHES["ball.ply"]
    assert ball.original
    moved = dataclasses.replace(ball.original, address=f"{address}ball.tar.gz")
    catalogue.MESHES["ball.ply"] = dataclasses.replace(ball, original=moved)
    with pytest.raises(InputError, match=rf"^{address}ball\.tar\.gz could not be downloaded {sentence}"):
        fetched("ball.ply")
    assert files_below(tmp_path) == []


# --- what is not -----------------------------------------------------------------------------------------------------

CHANGED = BALL_PLY[:-1] + b"\1"
Faulty = Callable[[MeshServer], Answer]
FAULTS: dict[str, tuple[Faulty, str]] = {
    "wrong hash": (lambda _: whole(tar({"ball.ply": CHANGED})), r"has a ball\.ply with the sha256 [0-9a-f]{64} where"),
    "wrong hash in a zip": (lambda _: whole(zipped({"ball.ply": CHANGED})), "with the sha256"),
    "cut": (
        lambda _: whole(tar(GOOD)[:2000], len(tar(GOOD))),
        r"downloaded \(the connection was cut with \d+ bytes still to come\)",
    ),
    "cut, and declared so": (lambda _: whole(tar(GOOD)[:2000]), "no whole tar or zip"),
    "cut zip": (lambda _: whole(zipped(GOOD)[:2000]), "no whole tar or zip"),
    "damaged zip": (lambda _: whole(spoilt(zipped(GOOD))), "no whole tar or zip"),
    "damaged tar": (lambda _: whole(spoilt(tar(GOOD))), "no whole tar or zip"),
    "empty": (lambda _: whole(b""), "no whole tar or zip"),
    "404": (lambda _: lambda handler: handler.send_error(404), r"could not be downloaded \(404 Not Found\)"),
    "500": (lambda _: lambda handler: handler.send_error(500), r"\(500 Internal Server Error\)"),
    "no answer": (lambda _: lambda handler: handler.connection.close(), r"downloaded \([\w ]+\);"),
    "stalled": (
        lambda server: stalled(tar(GOOD), server),
        r"could not be downloaded \((The read operation )?timed out",
    ),
    "not an archive": (lambda _: whole(b"<html>moved</html>" * 100), "no whole tar or zip"),
    "no such member": (lambda _: whole(tar({"recon/README": b"words"})), r"has no file ball\.ply"),
    "a link out": (lambda _: whole(tar({}, {"ball.ply": "/etc/passwd"})), r"has no file ball\.ply"),
    "a path out": (lambda _: whole(tar({"../../ball.ply": CHANGED, "/ball.ply": CHANGED})), "with the sha256"),
}


def spoilt(body: bytes) -> bytes:
    """Wrong bytes where the data of the first member are."""
    return body[:200] + bytes(byte ^ 255 for byte in body[200:1200]) + body[1200:]


@pytest.mark.parametrize("fault", FAULTS)
def test_what_fails_leaves_nothing_behind(fault: str, server: MeshServer, data: Path, tmp_path: Path) -> None:
    answer, sentence = FAULTS[fault]
    server.answers["/ball.tar.gz"] = answer(server)
    with pytest.raises(InputError, match=sentence) as refusal:
        fetched("ball.ply")
    text = str(refusal.value)
    assert text.startswith(f"{server.address}/ball.tar.gz")
    assert "\n" not in text
    assert text.endswith(".")
    assert list(tmp_path.rglob("*")) == [tmp_path / "temporary"]


def test_a_right_file_is_taken_from_any_folder_of_an_archive_and_put_nowhere_else(
    server: MeshServer, data: Path, tmp_path: Path
) -> None:
    hostile = {"../../../escaped.ply": BALL_PLY, "ball.ply": b"another of that name", "../../ball.ply": BALL_PLY}
    server.answers["/ball.tar.gz"] = whole(tar(hostile, {"recon": "/tmp"}))
    fetched("ball.ply")
    assert files_below(tmp_path) == ["data/airlight/meshes/ball.ply", "data/airlight/meshes/ball.ply.json"]


def test_sizes_are_bounded(server: MeshServer, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    server.answers["/ball.tar.gz"] = whole(tar({**GOOD, "ballast": np.random.default_rng(1).bytes(200_000)}))
    with monkeypatch.context() as patch:
        patch.setattr(archive_member, "LARGEST_MEMBER", 1000)
        with pytest.raises(InputError, match=r"has no file ball\.ply of up to"):
            fetched("ball.ply")
    with monkeypatch.context() as patch:
        patch.setattr(archive_member, "LARGEST_CONTENT", 1000)
        with pytest.raises(InputError, match="no whole tar or zip"):
            fetched("ball.ply")
    with monkeypatch.context() as patch:
        patch.setattr(mesh_fetch, "LARGEST_DOWNLOAD", 100_000)
        with pytest.raises(InputError, match="sends more than"):
            fetched("ball.ply")
    assert files_below(tmp_path) == []


@pytest.mark.parametrize("where", ["download", "steps", "write"])
def test_an_interruption_leaves_nothing_behind(
    where: str, server: MeshServer, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    server.answers["/ball.tar.gz"] = whole(tar(GOOD))
    watcher = Watcher()
    if where == "download":
        monkeypatch.setattr(watcher, "downloading", interrupt)
    elif where == "steps":
        monkeypatch.setitem(STEPS, "repair", (interrupt, ()))
    else:
        monkeypatch.setattr(Path, "write_text", interrupt)
    with pytest.raises(KeyboardInterrupt):
        list(fetch(["ball.ply"], watcher))
    assert files_below(tmp_path) == []


def test_a_full_disk_leaves_nothing_behind_and_is_named(
    server: MeshServer, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    server.answers["/ball.tar.gz"] = whole(tar(GOOD))
    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_text", full)
        with pytest.raises(InputError, match=r"No space left on device.*XDG_DATA_HOME"):
            fetched("ball.ply")
    with monkeypatch.context() as patch:
        patch.setattr(archive_member, "_copy", full)
        with pytest.raises(InputError, match=r"temporary.*No space left on device.*TMPDIR"):
            fetched("ball.ply")
    assert files_below(tmp_path) == []


def test_a_mesh_that_cannot_take_its_place_has_no_note_either(server: MeshServer, data: Path, tmp_path: Path) -> None:
    def in_the_way(handler: BaseHTTPRequestHandler) -> None:
        (data / "ball.ply").mkdir(parents=True)
        whole(tar(GOOD))(handler)

    server.answers["/ball.tar.gz"] = in_the_way
    with pytest.raises(InputError, match=r"ball\.ply cannot be written"):
        fetched("ball.ply")
    assert files_below(tmp_path) == []


def test_a_failure_leaves_the_meshes_before_it(server: MeshServer, data: Path, tmp_path: Path) -> None:
    server.answers["/ball.tar.gz"] = whole(tar(GOOD))
    with pytest.raises(InputError, match="404"):
        fetched("ball.ply", "box.ply")
    assert files_below(data) == ["ball.ply", "ball.ply.json"]
    assert files_below(tmp_path / "temporary") == []


def test_what_cannot_be_fetched_is_refused_before_anything_is_asked_for(server: MeshServer, data: Path) -> None:
    with pytest.raises(InputError, match=rf"comes from a page \(http://page\).*{VARIABLE}"):
        fetched("ball.ply", "by_hand.ply")
    with pytest.raises(InputError, match=r"'unknown\.ply' is no mesh that can be fetched; .* ball\.ply"):
        fetched("ball.ply", "unknown.ply")
    assert server.asked == []
