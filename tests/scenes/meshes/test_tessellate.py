"""The tessellated shapes against Mitsuba's analytic ones: the same rays meet the same surface."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mitsuba
import numpy as np
import pytest

from scenes.errors import InputError
from scenes.meshes import tessellate
from scenes.meshes.triangles import Triangles, ply_bytes

P0, P1, RADIUS = [0.3, -0.2, 0.1], [-0.4, 0.5, 0.9], 0.45


def placed_cylinder() -> Triangles:
    """The unit tube where `cylinder_frame` puts it."""
    tube, frame = tessellate.cylinder(), tessellate.cylinder_frame(np.array(P0), np.array(P1), RADIUS)
    assert tube.normals is not None
    vertices = tube.vertices @ frame[:3, :3].T + frame[:3, 3]
    normals = tube.normals @ np.linalg.inv(frame[:3, :3])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Triangles(vertices.astype(np.float32), tube.faces, normals.astype(np.float32))


SHAPES: dict[str, tuple[Triangles, dict[str, Any]]] = {
    "sphere": (tessellate.sphere(), {}),
    "rectangle": (tessellate.rectangle(), {}),
    "cube": (tessellate.cube(), {}),
    "disk": (tessellate.disk(), {}),
    "cylinder": (placed_cylinder(), {"p0": P0, "p1": P1, "radius": RADIUS}),
}


def corners(mesh: Triangles) -> np.ndarray:
    """(F, 3 corners, 3) float64."""
    return mesh.vertices[mesh.faces].astype(np.float64)


@pytest.mark.parametrize("name", SHAPES)
def test_rays_meet_the_triangles_where_they_meet_mitsubas_shape(name: str, tmp_path: Path) -> None:
    mesh, properties = SHAPES[name]
    mitsuba.set_variant("scalar_rgb")
    path = tmp_path / "mesh.ply"
    path.write_bytes(ply_bytes(mesh))
    ours = mitsuba.load_dict({"type": "scene", "shape": {"type": "ply", "filename": str(path)}})
    theirs = mitsuba.load_dict({"type": "scene", "shape": {"type": name, **properties}})
    random = np.random.default_rng(7)
    hits = misses = disagree = 0
    for _ in range(1500):
        start = random.normal(size=3)
        start *= 4.0 / np.linalg.norm(start)
        towards = random.uniform(-1.1, 1.1, size=3) - start
        towards /= np.linalg.norm(towards)
        ray = mitsuba.Ray3f(mitsuba.ScalarPoint3f(*start.tolist()), mitsuba.ScalarVector3f(*towards.tolist()))
        a, b = ours.ray_intersect(ray), theirs.ray_intersect(ray)
        if a.is_valid() != b.is_valid():
            disagree += 1
        elif not b.is_valid():
            misses += 1
        elif abs(np.dot(b.n, towards)) > 0.2:  # at grazing angles a small distance is a long way along the ray
            hits += 1
            assert a.t == pytest.approx(b.t, abs=1e-4 / 0.2)
            assert np.dot(a.sh_frame.n, b.sh_frame.n) > 1.0 - 1e-6
            assert np.dot(a.n, b.n) > 0.999  # the same side is outside
            if name == "rectangle":
                u, v = (np.array(b.p)[:2] + 1.0) / 2.0
                np.testing.assert_allclose(np.array(b.uv), [u, v], atol=1e-5)
    assert disagree <= 3  # rays that brush the outline
    assert hits > 150
    assert misses > 20


@pytest.mark.parametrize("name", SHAPES)
def test_area_is_mitsubas_and_faces_turn_as_their_normals_do(name: str) -> None:
    mesh, properties = SHAPES[name]
    mitsuba.set_variant("scalar_rgb")
    a, b, c = corners(mesh).transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    area = float(np.linalg.norm(normal, axis=1).sum()) / 2.0
    assert area == pytest.approx(mitsuba.load_dict({"type": name, **properties}).surface_area(), rel=2e-4)
    assert mesh.normals is not None
    stored = mesh.normals[mesh.faces].astype(np.float64)
    assert (np.einsum("fk,fck->fc", normal, stored) > 0.99 * np.linalg.norm(normal, axis=1)[:, None]).all()
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=2e-7)
    assert (mesh.vertices.dtype, mesh.faces.dtype, mesh.normals.dtype) == (np.float32, np.uint32, np.float32)


def test_chord_errors_are_those_stated() -> None:
    a, b, c = corners(tessellate.sphere()).transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    depth = np.einsum("fk,fk->f", normal, a) / np.linalg.norm(normal, axis=1)
    assert 1.0 - depth.min() == pytest.approx(7.1e-5, rel=0.01)
    rim = tessellate.disk().vertices[1:].astype(np.float64)
    middles = (rim + np.roll(rim, 1, axis=0)) / 2.0
    assert 1.0 - np.linalg.norm(middles, axis=1).min() == pytest.approx(7.5e-5, rel=0.01)
    start, axis = np.array(P0), np.array(P1) - np.array(P0)
    axis /= np.linalg.norm(axis)
    middle = corners(SHAPES["cylinder"][0]).mean(axis=1) - start
    from_axis = np.linalg.norm(middle - (middle @ axis)[:, None] * axis, axis=1)
    assert 1.0 - from_axis.min() / RADIUS < 1e-4


def test_rectangle_and_cube_are_exact() -> None:
    rectangle, cube = tessellate.rectangle(), tessellate.cube()
    assert rectangle.uv is not None
    np.testing.assert_array_equal(rectangle.uv * 2 - 1, rectangle.vertices[:, :2])
    assert cube.vertices.shape == (24, 3)
    assert {tuple(np.abs(vertex)) for vertex in cube.vertices.tolist()} == {(1.0, 1.0, 1.0)}


def test_a_shared_shape_cannot_be_changed() -> None:
    with pytest.raises(ValueError, match="read-only"):
        tessellate.sphere().vertices[0] = 0.0


@pytest.mark.parametrize("end", [P0, [np.inf, 0.0, 0.0]])
def test_a_cylinder_without_a_surface_is_refused(end: list[float]) -> None:
    with pytest.raises(InputError, match="no surface"):
        tessellate.cylinder_frame(np.array(P0), np.array(end), 1.0)
