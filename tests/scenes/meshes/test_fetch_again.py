"""What is in the user's data folder before a fetch: taken for what it is, and replaced only where it is airlight's."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable
from pathlib import Path

import pytest
from fetchable_balls import BALL_PLY, GOOD, fetched, files_below
from mesh_server import MeshServer, tar, whole

from scenes.errors import InputError
from scenes.meshes import catalogue
from scenes.meshes.fetch import Fetched
from scenes.meshes.files import VARIABLE, read_mesh
from scenes.meshes.notes import note_path
from scenes.meshes.steps import Step


def test_a_mesh_that_is_there_is_not_fetched_again_unless_its_recipe_changed(server: MeshServer, data: Path) -> None:
    server.answers["/ball.tar.gz"] = whole(tar(GOOD))
    assert [mesh.fresh for mesh in fetched("ball.ply")] == [True]
    assert [mesh.fresh for mesh in fetched("ball.ply")] == [False]
    assert len(server.asked) == 1
    changed = dataclasses.replace(catalogue.MESHES["ball.ply"], steps=(Step("decimate", {"target": 500}),))
    catalogue.MESHES["ball.ply"] = changed
    assert [mesh.fresh for mesh in fetched("ball.ply")] == [True]
    assert len(server.asked) == 2
    assert len(read_mesh(data / "ball.ply").faces) == pytest.approx(500, abs=20)


def test_the_reference_copy_that_a_person_put_there_counts_as_there(server: MeshServer, data: Path) -> None:
    data.mkdir(parents=True)
    (data / "ball.ply").write_bytes(BALL_PLY)
    copy = dataclasses.replace(catalogue.MESHES["ball.ply"], reference_sha256=hashlib.sha256(BALL_PLY).hexdigest())
    catalogue.MESHES["ball.ply"] = copy
    assert fetched("ball.ply") == [Fetched(data / "ball.ply", None, fresh=False)]
    assert files_below(data) == ["ball.ply"]
    assert server.asked == []


def _put_another_file(mesh: Path) -> None:
    mesh.write_bytes(BALL_PLY)


def _put_another_in_place_of_the_fetched_one(mesh: Path) -> None:
    fetched("ball.ply")
    mesh.write_bytes(BALL_PLY)


def _spoil_the_note(mesh: Path) -> None:
    fetched("ball.ply")
    note_path(mesh).write_text("{}")


def _lend_it_the_note_of_another(mesh: Path) -> None:
    fetched("coarse_ball.ply")
    for file in (mesh.with_name("coarse_ball.ply"), note_path(mesh.with_name("coarse_ball.ply"))):
        file.rename(file.with_name(file.name.replace("coarse_", "")))


def _link_to_nowhere(mesh: Path) -> None:
    mesh.symlink_to("nowhere.ply")


ANOTHERS = (
    *(_put_another_file, _put_another_in_place_of_the_fetched_one, _spoil_the_note),
    *(_lend_it_the_note_of_another, _link_to_nowhere, Path.mkdir),
)


@pytest.mark.parametrize("put", ANOTHERS, ids=lambda put: put.__name__.strip("_"))
def test_a_file_that_airlight_did_not_fetch_stays(put: Callable[[Path], None], server: MeshServer, data: Path) -> None:
    server.answers["/ball.tar.gz"] = whole(tar(GOOD))
    data.mkdir(parents=True)
    put(data / "ball.ply")
    # a recipe that changed gives it away no more than one that did not
    catalogue.MESHES["ball.ply"] = dataclasses.replace(catalogue.MESHES["ball.ply"], steps=(Step("repair"),) * 2)
    before = {name: (data / name).read_bytes() for name in files_below(data) if (data / name).is_file()}
    asked = len(server.asked)
    with pytest.raises(InputError, match=rf"/ball\.ply is there already and is not airlight's; move it .*{VARIABLE}"):
        fetched("box.ply", "ball.ply")
    assert {name: (data / name).read_bytes() for name in files_below(data) if (data / name).is_file()} == before
    assert len(server.asked) == asked
