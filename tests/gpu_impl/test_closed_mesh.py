"""Triangles that cannot be seen are left out, and pictures stay what they are."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scene_files import POINT, write_scene

from gpu_impl import geometry
from gpu_impl.closed_mesh import distance_to_box, outward_side
from scenes.catalogue import shipped
from scenes.loader import load


def side(mesh: trimesh.Trimesh) -> int:
    return outward_side(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32))


def flipped(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)


def moved(mesh: trimesh.Trimesh, x: float) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices + np.array([x, 0, 0]), mesh.faces, process=False)


# each with more triangles than `WORTH_IT`
BALL = trimesh.creation.icosphere(5)
TORUS = trimesh.creation.torus(2, 0.5, major_sections=128, minor_sections=64)


@pytest.mark.parametrize("mesh", [BALL, TORUS, trimesh.util.concatenate([BALL, moved(TORUS, 5)])])
def test_closed_meshes(mesh: trimesh.Trimesh) -> None:
    assert mesh.is_watertight
    assert side(mesh) == 1
    assert side(flipped(mesh)) == -1
    # far from the origin too
    assert side(moved(mesh, 1e3)) == 1


def test_meshes_whose_triangles_may_be_seen_from_either_side() -> None:
    assert side(trimesh.Trimesh(BALL.vertices, BALL.faces[1:], process=False)) == 0
    one_wrong = BALL.faces.copy()
    one_wrong[7] = one_wrong[7, ::-1]
    assert side(trimesh.Trimesh(BALL.vertices, one_wrong, process=False)) == 0
    # closed each, and inside out the one to the other
    assert side(trimesh.util.concatenate([BALL, moved(flipped(BALL), 5)])) == 0
    # hollow: the inner side of the wall is inside out by itself
    assert (
        side(trimesh.util.concatenate([BALL, flipped(trimesh.Trimesh(BALL.vertices / 2, BALL.faces, process=False))]))
        == 0
    )
    # each triangle twice: every edge has four
    assert side(trimesh.Trimesh(BALL.vertices, np.tile(BALL.faces, (2, 1)), process=False)) == 0
    assert outward_side(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32)) == 0
    # so few that it does not pay, and may pass through themselves unnoticed
    assert side(trimesh.creation.icosphere(2)) == 0


def test_vertices_that_no_triangle_has_do_not_matter() -> None:
    vertices = np.concatenate([np.full((5, 3), 9.0), BALL.vertices]).astype(np.float32)
    assert outward_side(vertices, (BALL.faces + 5).astype(np.uint32)) == 1


def test_distance_to_a_box() -> None:
    low, high = np.array([-1.0, -1, -1]), np.array([1.0, 2, 3])
    assert distance_to_box(np.array([0.0, 1, 2]), low, high) == 0
    assert distance_to_box(np.array([4.0, 1, 7]), low, high) == 5


@pytest.mark.parametrize("name", shipped())
def test_pictures_stay_what_they_are(name: str, draw, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load(name, size=(96, 96))
    settings = {"steps": 16, "shadow_map": 256}
    culled = draw(scene, "lit_intervals+quadrature", **settings)
    monkeypatch.setattr(geometry, "outward_side", lambda *_: 0)
    whole = draw(scene, "lit_intervals+quadrature", **settings)
    # On a silhouette the rasteriser's rounding may let a triangle that looks away win by a hair: measured in at most 2
    # pixels of 9,216 (wire_mesh, donut_dragon), 1.7e-4 of the distance.
    assert ((culled.composite != whole.composite).any(axis=-1)).sum() <= 6
    assert culled.depth == pytest.approx(whole.depth, rel=1e-3)


@pytest.mark.parametrize("eye", ["0, 0, 0.5", "0, 0, 1.005"])
def test_a_closed_mesh_is_seen_from_inside(eye: str, tmp_path, draw) -> None:
    """The eye in a ball, and before one that its near plane cuts open."""
    ball = "<shape type='sphere'><bsdf type='twosided'><bsdf type='diffuse'/></bsdf></shape>"
    scene = write_scene(tmp_path, POINT.replace("2.6", "0.2"), ball, eye=eye)
    depth = draw(scene, "lit_intervals+quadrature", steps=4, shadow_map=64).depth
    # the far side of the ball, at most its diameter away
    assert (depth < 2.1).all()
