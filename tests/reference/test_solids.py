"""Which points a closed surface holds: against the winding number, and where nobody can tell."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from reference.checks.shut_in import _meet_square
from reference.checks.solids import closed_parts
from scenes.loader import load
from scenes.model import Material, Mesh

PAINT = Material(np.full(3, 0.5), np.zeros(3), 0.0, two_sided=False)


def mesh_of(*bodies: trimesh.Trimesh) -> Mesh:
    body = trimesh.util.concatenate(bodies)
    vertices, faces = np.asarray(body.vertices, np.float32), np.asarray(body.faces, np.uint32)
    return Mesh("body", vertices, faces, None, PAINT, None, "uv", None)


def flat(mesh: Mesh) -> Mesh:
    """The same with corners of its own for each triangle."""
    corners = mesh.vertices[mesh.faces].reshape(-1, 3)
    faces = np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
    return Mesh("body", corners, faces, None, PAINT, None, "uv", None)


def ball(radius: float = 1.0, centre: tuple[float, float, float] = (0, 0, 0)) -> trimesh.Trimesh:
    return trimesh.creation.icosphere(subdivisions=3, radius=radius).apply_translation(centre)


def box(side: float = 2.0) -> trimesh.Trimesh:
    return trimesh.creation.box((side, side, side))


def winding_number(mesh: Mesh, point: np.ndarray) -> float:
    """Solid angle of the surface over 4 pi.

    Source: van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle".
    """
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces].astype(float) - point, 1, 0)
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    triple = np.einsum("ij,ij->i", a, np.cross(b, c))
    rest = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return float(np.arctan2(triple, rest).sum() / (2 * np.pi))


def held(mesh: Mesh, points: np.ndarray) -> np.ndarray:
    parts = closed_parts(mesh, points)
    return np.any([part.holds for part in parts], axis=0) if parts else np.zeros(len(points), bool)


@pytest.mark.parametrize(
    "mesh",
    [
        mesh_of(ball()),
        flat(mesh_of(ball())),
        mesh_of(box()),
        flat(mesh_of(box())),
        mesh_of(trimesh.creation.torus(1.0, 0.3)),
        mesh_of(ball(), ball(0.5, (2, 0.3, 0))),
        load("donut_dragon", size=(2, 2)).meshes[0],
    ],
    ids=["ball", "flat ball", "box", "flat box", "torus", "two balls", "dragon"],
)
def test_it_holds_the_points_around_which_it_winds(mesh: Mesh) -> None:
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    random = np.random.default_rng(5).uniform(low - 0.1, high + 0.1, (20, 3))
    # the middle and the axes of symmetry, where rays along the axes would meet edges and corners
    middle = (low + high) / 2 + np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, -0.1], [0.1, 0.1, 0.1]])
    points = np.concatenate([random, middle])
    around = np.array([winding_number(mesh, point) for point in points])
    assert np.abs(around - around.round()).max() < 1e-6  # measured: 2e-8, float32 vertices that fit together
    assert 0 < (around.round() != 0).sum() < len(points)
    assert (held(mesh, points) == (around.round() != 0)).all()


def test_which_side_the_triangles_face_is_no_matter() -> None:
    mesh, points = mesh_of(ball()), np.array([[0.0, 0.1, 0.2], [0, 0, 1.1]])
    turned = mesh.faces.copy()
    turned[::3] = turned[::3, ::-1]
    mesh = Mesh("body", mesh.vertices, turned, None, PAINT, None, "uv", None)
    assert held(mesh, points).tolist() == [True, False]


@pytest.mark.parametrize("missing", [0, 100, 1279])
def test_what_lacks_a_triangle_holds_nothing(missing: int) -> None:
    body = ball()
    body.faces = np.delete(body.faces, missing, axis=0)
    assert closed_parts(mesh_of(body), np.zeros((1, 3))) == []


def test_an_open_part_beside_a_closed_one_does_not_open_it() -> None:
    open_one = ball(0.5, (3, 0, 0))
    open_one.faces = open_one.faces[1:]
    points = np.array([[0.0, 0, 0], [3, 0, 0]])
    (part,) = closed_parts(mesh_of(ball(), open_one), points)
    assert part.holds.tolist() == [True, False]
    assert len(part.triangles) == 1280


def test_a_hollow_body_is_two_surfaces() -> None:
    inner = ball(0.5)
    inner.invert()
    points = np.array([[0.0, 0.1, 0], [0, 0.7, 0], [0, 2, 0]])
    held_by = {tuple(part.holds.tolist()) for part in closed_parts(mesh_of(ball(), inner), points)}
    # by winding numbers nothing would hold the first
    assert held_by == {(True, True, False), (True, False, False)}


@pytest.mark.parametrize("away", [0.0, 1e-7, -1e-7])
def test_a_body_on_which_a_point_lies_is_left_out(away: float) -> None:
    assert closed_parts(mesh_of(box()), np.array([[0.2, 0.3, 1 + away], [0, 0, 0]])) == []
    assert len(closed_parts(mesh_of(box()), np.array([[0.2, 0.3, 1 - 1e-4], [0, 0, 0]]))) == 1


def test_a_body_far_from_the_origin_and_one_of_no_size() -> None:
    assert held(mesh_of(box().apply_translation((1000, 0, 0))), np.array([[1000.3, 0.2, 0.1]])).all()
    assert closed_parts(mesh_of(box(0.0)), np.zeros((1, 3))) == []


def test_segments_that_meet_the_square_are_found() -> None:
    random = np.random.default_rng(8)
    begin, end = random.uniform(-3, 3, (2, 900, 2))
    # some upright, some level, some along the sides
    end[:200, 0], end[200:400, 1], begin[400:450, 0] = begin[:200, 0], begin[200:400, 1], 1.0
    end[400:450, 0] = 1.0
    share = np.linspace(0, 1, 4001)[:, None, None]
    nearest = np.abs(begin + share * (end - begin)).max(axis=-1).min(axis=0)
    sure = np.abs(nearest - 1) > 1e-3
    sure[400:450] = True
    assert (_meet_square(begin, end) == (nearest <= 1))[sure].all()
