"""Edges of a scene and their silhouettes, against the usual test and against the definition in float64."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from obj_meshes import BOX, SHEETS, SUN, obj
from scene_files import write_scene

from gpu_impl.renderer import Renderer
from gpu_impl.silhouettes import edges_of, welded
from gpu_impl.techniques import find_technique
from scenes.loader import load
from scenes.model import Scene

BALL = trimesh.creation.icosphere(subdivisions=3, radius=0.9)
RING = trimesh.creation.torus(0.8, 0.3)
# a sheet whose two triangles are wound differently
MIXED = ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 3, 2)])


def scene_of(vertices, faces) -> SimpleNamespace:
    mesh = SimpleNamespace(vertices=np.array(vertices, np.float32), faces=np.array(faces, np.uint32))
    return SimpleNamespace(meshes=(mesh,))


def silhouette(scene: Scene) -> set[frozenset]:
    """What the compute shader gathers for the only light, as sets of two places."""
    vertices, _ = welded(scene)
    with Renderer(scene) as renderer:
        technique = find_technique("lit_intervals:printed+quadrature", steps=1, shadow_map=8)
        renderer.render(technique)
        adjacency = renderer.passes.kept.get("adjacency", dict)
        corners = np.frombuffer(adjacency.draw_call.read(), np.uint32)[0]
        found = np.frombuffer(adjacency.silhouette.read(), np.uint32).reshape(-1, 4)[: corners // 6, :2]
    return {frozenset(map(tuple, vertices[pair].tolist())) for pair in found}


def expected(scene: Scene, clear: float = 0.0) -> set[frozenset]:
    """By the definition; with `clear`, those of which rounding leaves no doubt."""
    vertices, faces = welded(scene)
    sides: dict[frozenset, list[float]] = {}
    (light,) = scene.lights
    vertices = vertices.astype(np.float64)
    for face in faces:
        for i in range(3):
            a, b, c = vertices[np.roll(face, i)]
            way = light.direction if light.kind == "directional" else a - light.position
            height = np.cross(way, b - a) @ (c - a) * (1 if tuple(a) < tuple(b) else -1)
            sides.setdefault(frozenset((tuple(a), tuple(b))), []).append(height if abs(height) > clear else 0.0)
    return {edge for edge, heights in sides.items() if not min(heights) < 0 < max(heights)}


def test_edges_of_a_tetrahedron() -> None:
    edges, opposite = edges_of(np.zeros((4, 3)), np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]))
    found = {(a, b): set(opposite[first : first + count]) for a, b, first, count in edges.tolist()}
    assert found == {(a, b): {0, 1, 2, 3} - {a, b} for a in range(4) for b in range(a + 1, 4)}


def test_any_number_of_triangles_may_share_an_edge() -> None:
    edges, opposite = edges_of(*map(np.array, SHEETS))
    first, count = edges[(edges[:, 0] == 0) & (edges[:, 1] == 1)][0, 2:]
    assert set(opposite[first : first + count]) == {2, 3, 4}
    assert sorted(edges[:, 3]) == [1] * 6 + [3]


def test_a_triangle_with_two_equal_corners_has_no_edges() -> None:
    edges, opposite = edges_of(np.zeros((3, 3)), np.array([[0, 1, 1], [2, 2, 2]]))
    assert edges.shape == (0, 4)
    assert opposite.size == 0


def test_seams_are_welded() -> None:
    loose = BALL.vertices[BALL.faces].reshape(-1, 3)
    vertices, faces = welded(scene_of(loose, np.arange(len(loose)).reshape(-1, 3)))
    assert len(vertices) == len(BALL.vertices)
    assert (edges_of(vertices, faces)[0][:, 3] == 2).all()


def test_zero_is_one_place_with_either_sign() -> None:
    vertices, _ = welded(scene_of([(0, 0, 0), (-0.0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 2, 3), (1, 3, 2)]))
    assert len(vertices) == 3


@pytest.mark.parametrize("mesh", [BALL, RING], ids=["ball", "ring"])
def test_on_a_closed_manifold_it_is_the_usual_test(mesh, tmp_path) -> None:
    """Edges between a triangle that faces the light and one that does not; the ball's are read back from OpenGL."""
    scene = write_scene(tmp_path, shapes=obj(tmp_path, "mesh", mesh.vertices, mesh.faces), size=(8, 8))
    vertices, faces = welded(scene)
    corners = vertices.astype(np.float64)[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = ((scene.lights[0].position - corners[:, 0]) * normals).sum(-1)
    # the two triangles of an edge, one of them found through each of its directions
    of = {(a, b): i for i, face in enumerate(faces.tolist()) for a, b in zip(face, np.roll(face, -1), strict=True)}
    usual = {
        frozenset(map(tuple, vertices[[a, b]].tolist())) for a, b in of if facing[of[a, b]] * facing[of[b, a]] <= 0
    }
    assert np.abs(facing).min() > 1e-6 * np.abs(facing).max()
    assert len(usual) > 20
    assert silhouette(scene) == usual == expected(scene)


@pytest.mark.parametrize("sun", [False, True], ids=["point", "directional"])
@pytest.mark.parametrize("mesh", [SHEETS, MIXED, (BALL.vertices, BALL.faces[7:])], ids=["sheets", "mixed", "hole"])
def test_neither_orientation_nor_a_closed_mesh_is_needed(mesh, sun: bool, tmp_path) -> None:
    lights = {"emitters": SUN, "shapes": BOX} if sun else {"shapes": ""}
    lights["shapes"] += obj(tmp_path, "mesh", *mesh)
    scene = write_scene(tmp_path, **lights, size=(8, 8))
    # an edge that float32 cannot tell the side of is taken
    assert expected(scene) <= silhouette(scene) <= expected(scene, clear=1e-6)


def test_a_triangle_edge_on_to_the_light_loses_no_edge(tmp_path) -> None:
    """The light lies in the planes of two of the box's sides, to rounding: their edges count."""
    box = trimesh.creation.box((0.6, 0.6, 0.6))
    scene = write_scene(tmp_path, shapes=obj(tmp_path, "mesh", box.vertices, box.faces), size=(8, 8))
    found = silhouette(scene)
    assert scene.lights[0].position[0] == pytest.approx(0.3)
    rim = {frozenset(((x, 0.3, z), (x, 0.3, -z))) for x in (-0.3,) for z in (0.3,)}
    assert {frozenset(tuple(np.float32(p).tolist()) for p in edge) for edge in rim} <= found
    assert expected(scene, clear=1e-7) >= found >= expected(scene)


def test_the_scenes_of_the_thesis_are_found_at_once() -> None:
    """Nothing but what the test says: every edge of a shipped scene has at least one opposite vertex."""
    vertices, faces = welded(load("donut_dragon", size=(8, 8)))
    edges, opposite = edges_of(vertices, faces)
    assert edges[:, 3].sum() == len(opposite) == 3 * len(faces)
    assert (edges[:, 0] < edges[:, 1]).all()
