"""The steps that make meshes out of originals: subdivision against known limits, closed shells out of damaged ones."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import trimesh

from scenes.errors import InputError
from scenes.meshes.catmull_clark import catmull_clark
from scenes.meshes.files import VARIABLE, read_mesh
from scenes.meshes.hole_filling import close_holes
from scenes.meshes.polygons import Polygons, as_triangles, cut_into_triangles, of_triangles, read_polygons
from scenes.meshes.repair import repair, weld
from scenes.meshes.steps import Step, decimate, run_steps

CUBE = """
v -1 -1 -1
v 1 -1 -1
v 1 1 -1
v -1 1 -1
v -1 -1 1
v 1 -1 1
v 1 1 1
v -1 1 1
g sides
f 1/1 4/1 3/1 2/1
f 5//1 6//1 7//1 8//1
f 1 2 6 5
f -6 -5 -1 -2
f 2 3 7 6
f 4 1 5 8
"""


def cube(folder: Path, text: str = CUBE) -> Polygons:
    path = folder / "cube.obj"
    path.write_text(text)
    return read_polygons(path)


def solid(mesh: Polygons) -> trimesh.Trimesh:
    vertices, faces = cut_into_triangles(mesh)
    return trimesh.Trimesh(vertices, faces, process=False)


def sphere(level: int = 4) -> tuple[np.ndarray, np.ndarray]:
    ball = trimesh.creation.icosphere(subdivisions=level)
    return np.asarray(ball.vertices, np.float32).astype(np.float64), np.asarray(ball.faces, np.int64)


# --- Catmull-Clark ---------------------------------------------------------------------------------------------------


def test_one_level_of_the_cube_is_where_the_rules_put_it(tmp_path: Path) -> None:
    points = {tuple(np.round(p, 12)) for p in catmull_clark(cube(tmp_path), 1).vertices.tolist()}
    # by hand: face points at 1; edge points at 3/4; corners (Q + 2 R) / 3 = (1/3 + 2 * 2/3) / 3 = 5/9 each
    expected = [(1, 0, 0), (0.75, 0.75, 0), (5 / 9, 5 / 9, 5 / 9)]
    for point in expected:
        assert tuple(np.round(point, 12)) in points
    assert len(points) == 8 + 12 + 6


def test_the_cube_tends_to_its_limit(tmp_path: Path) -> None:
    start = cube(tmp_path)
    fine = catmull_clark(start, 6)
    # Halstead et al. 1993: a vertex of valence n goes to (n^2 v + 4 sum(edge neighbours) + sum(face neighbours)) /
    # (n (n + 5)); with the points of the first level around a corner of the cube
    first = catmull_clark(start, 1)
    low = float((9 * 5 / 9 + 4 * (0.75 + 0.75 + 0.0) + (1.0 + 0.0 + 0.0)) / 24)
    assert np.allclose(np.abs(first.vertices[:8]), 5 / 9)
    # measured: 2e-4; a level divides the distance by about four
    np.testing.assert_allclose(np.abs(fine.vertices[:8]), low, atol=5e-4)
    shell = solid(fine)
    assert shell.is_watertight
    assert shell.volume > 0


@pytest.mark.parametrize("levels", [1, 2, 3])
def test_counts_and_euler_characteristic_hold(levels: int) -> None:
    # a torus of 5 x 7 quads, two of them joined into a hexagon and one cut into triangles
    around, across = 5, 7
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    quads = [
        [(i + di) % around * across + (j + dj) % across for di, dj in corners]
        for i in range(around)
        for j in range(across)
    ]
    a, b = quads[0], quads[1]
    polygons = [[a[0], a[1], a[2], b[2], b[3], a[3]], [quads[2][0], *quads[2][1:3]], [quads[2][0], *quads[2][2:]]]
    polygons += quads[3:]
    angle = 2 * np.pi * np.stack(np.meshgrid(np.arange(5) / 5, np.arange(7) / 7, indexing="ij"), -1).reshape(-1, 2)
    ring = 2 + np.cos(angle[:, 1])
    vertices = np.stack([ring * np.cos(angle[:, 0]), ring * np.sin(angle[:, 0]), np.sin(angle[:, 1])], axis=1)
    sides = np.array([len(polygon) for polygon in polygons])
    mesh = Polygons(vertices, np.concatenate(polygons), sides)
    fine = catmull_clark(mesh, levels)
    assert len(fine.sides) == sides.sum() * 4 ** (levels - 1)
    assert len(as_triangles(fine).faces) == 2 * len(fine.sides)
    shell = solid(fine)
    assert shell.euler_number == 0
    assert shell.is_watertight
    assert shell.is_winding_consistent


def test_a_boundary_is_a_cubic_spline_of_itself_and_a_grid_stays_flat() -> None:
    x, y = (index.ravel().astype(float) for index in np.indices((4, 4)))
    i, j = (index.ravel() for index in np.indices((3, 3)))
    quads = np.stack([i * 4 + j, (i + 1) * 4 + j, (i + 1) * 4 + j + 1, i * 4 + j + 1], axis=1)
    height = np.where(x == 0, y * y, 0.0)
    mesh = Polygons(np.stack([x, y, height], axis=1), quads.ravel(), np.full(9, 4))
    once = catmull_clark(mesh, 1).vertices
    # the side x = 0 keeps out of the inside: 1/8, 6/8, 1/8 of heights 0, 1, 4
    np.testing.assert_allclose(once[1], (0, 1, (0 + 6 * 1 + 4) / 8))
    flat = Polygons(mesh.vertices * (1, 1, 0), mesh.corners, mesh.sides)
    inner = catmull_clark(flat, 1).vertices[[5, 6, 9, 10]]
    np.testing.assert_allclose(inner, flat.vertices[[5, 6, 9, 10]], atol=1e-15)


def test_an_edge_of_three_polygons_is_refused() -> None:
    fin = of_triangles(np.eye(5, 3), np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]]))
    with pytest.raises(InputError, match="more than two polygons"):
        catmull_clark(fin, 1)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("v 0 0 0\n", "no polygons"),
        (CUBE + "f 1 2\n", "missing corners"),
        (CUBE + "f 1 2 9\n", "missing corners"),
        (CUBE + "f 1 2 x\n", "does not hold numbers"),
        (CUBE + "v 0 nan 0\n", "NaN"),
    ],
)
def test_a_damaged_original_is_refused(tmp_path: Path, text: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        cube(tmp_path, text)


REAL = [
    Path(part) for part in os.environ.get(VARIABLE, "").split(os.pathsep) if Path(part, "yeahright_cc1.ply").exists()
]


@pytest.mark.skipif(not REAL, reason=f"needs yeahright_cc1.ply and yeahright_cc2.ply in {VARIABLE}")
def test_yeahrights_second_level_is_that_of_its_first() -> None:
    coarse, fine = (read_mesh(REAL[0] / f"yeahright_cc{level}.ply") for level in (1, 2))
    half = len(coarse.faces) // 2
    quads = np.concatenate([coarse.faces[:half], coarse.faces[half:, 2:]], axis=1).astype(np.int64)
    mesh = as_triangles(catmull_clark(Polygons(coarse.vertices.astype(float), quads.ravel(), np.full(half, 4)), 1))
    np.testing.assert_array_equal(mesh.faces, fine.faces)
    # measured: 9.5e-7, one float32 step at the largest coordinate, 15.2
    assert np.abs(mesh.vertices - fine.vertices).max() < 2e-6


# --- repair and decimation -------------------------------------------------------------------------------------------


def assert_closed(mesh: Polygons, volume: float, rel: float) -> None:
    vertices, faces = cut_into_triangles(mesh)
    np.testing.assert_array_equal(vertices, vertices.astype(np.float32))
    for merged in (False, True):
        shell = trimesh.Trimesh(vertices, faces, process=merged)
        assert shell.is_watertight
        assert shell.is_winding_consistent
        assert shell.body_count == 1
        assert shell.volume == pytest.approx(volume, rel=rel)


def test_a_good_mesh_stays_as_it_is() -> None:
    vertices, faces = sphere()
    mended = solid(repair(of_triangles(vertices, faces)))
    np.testing.assert_array_equal(mended.vertices[mended.faces], vertices[faces])


def test_what_scans_have_is_repaired() -> None:
    vertices, faces = sphere()
    volume = trimesh.Trimesh(vertices, faces, process=False).volume
    rng = np.random.default_rng(5)
    below = np.flatnonzero(vertices[faces].mean(axis=1)[:, 2] < 0.5)
    broken = np.delete(faces, rng.choice(below, 300, replace=False), axis=0)  # holes, some touching in a vertex
    a, b, c = broken[vertices[broken].mean(axis=1)[:, 2].argmax()]
    n = len(vertices)
    extra = np.concatenate(
        [vertices, [[0.0, 0.0, 2.0], [3.0, 3.0, 3.0], [3.0, 4.0, 3.0], [4.0, 3.0, 3.0]], vertices[:9]]
    )
    fins = [
        *([a, b, n], [b, a, n], [b, c, n]),  # a fin from both sides, and one from one side
        *(broken[40][::-1], broken[20]),  # a face turned round, and one that is there twice
        [n + 1, n + 2, n + 3],  # debris
        *([a, a, b], [n, n, n]),  # no faces at all
    ]
    # nine vertices are there a second time, and half of the faces around them use the copy
    copied = np.where((broken < 9) & (rng.random(broken.shape) < 0.5), broken + n + 4, broken)
    mended = repair(of_triangles(extra, np.concatenate([copied, fins])))
    assert_closed(mended, volume, rel=5e-3)
    low, high = mended.vertices.min(axis=0), mended.vertices.max(axis=0)
    np.testing.assert_allclose([low, high], [vertices.min(axis=0), vertices.max(axis=0)], atol=5e-3)
    # a filled hole lies under the sphere by less than an edge's sagitta; measured: 0.987
    assert np.linalg.norm(solid(mended).triangles_center, axis=1).min() > 0.97


def test_a_hole_whose_diagonals_are_taken_gets_a_vertex_in_its_middle() -> None:
    # an octahedron's four faces above its equator are gone, and both diagonals of the equator are edges outside it
    equator, below = [0, 1, 2, 3], 4
    vertices = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, -1], [0, 0, -3], [0, 0, -2]], np.float64)
    faces = [[b, a, below] for a, b in zip(equator, equator[1:] + equator[:1], strict=True)]
    plain, _ = close_holes(vertices, np.array(faces))
    assert len(plain) == len(vertices)
    faces += [[0, 2, 5], [2, 0, 5], [1, 3, 6], [3, 1, 6]]
    closed, all_faces = close_holes(vertices, np.array(faces))
    np.testing.assert_array_equal(closed[len(vertices) :], [[0.0, 0.0, 0.0]])
    sides = np.concatenate([all_faces, np.roll(all_faces, -1, axis=1)]).reshape(2, -1).T
    there = set(map(tuple, sides.tolist()))
    assert len(there) == len(sides)
    assert there == {(b, a) for a, b in there}


def test_decimation_keeps_the_shape_and_repeats_itself() -> None:
    vertices, faces = sphere(5)
    first, again = (decimate(of_triangles(vertices, faces), 4000) for _ in range(2))
    np.testing.assert_array_equal(first.vertices, again.vertices)
    np.testing.assert_array_equal(first.corners, again.corners)
    assert abs(len(first.sides) - 4000) < 10
    assert_closed(repair(first), trimesh.Trimesh(vertices, faces).volume, rel=2e-3)
    with pytest.raises(InputError, match="cannot be decimated"):
        decimate(of_triangles(vertices, faces), len(faces))


def test_weld_tells_zero_from_nothing_and_keeps_the_order() -> None:
    points = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, -0.0, 0.0], [0.0, 1.0, 0.0]])
    welded, faces = weld(points, np.array([[0, 1, 3], [2, 3, 1]]))
    np.testing.assert_array_equal(welded, points[[0, 1, 3]])
    np.testing.assert_array_equal(faces, [[0, 1, 2], [0, 2, 1]])


def test_steps_are_recorded_with_what_came_out() -> None:
    told: list[str] = []
    steps = (Step("decimate", {"target": 1000}), Step("repair"))
    mesh, records = run_steps(of_triangles(*sphere()), steps, lambda step: told.append(str(step)))
    assert told == ["decimate(target=1000)", "repair()"]
    assert [record["step"] for record in records] == ["decimate", "repair"]
    assert records[0]["parameters"] == {"target": 1000}
    assert records[0]["made_by"]["fast-simplification"]
    assert records[1]["polygons"] == len(mesh.sides)
