"""The meshes that our code makes: closed, placed and as intricate as those they stand in for, the same bytes always."""

from __future__ import annotations

import hashlib
from pathlib import Path

import mitsuba
import numpy as np
import pytest
import trimesh

from scenes.meshes import dragon, standins, wire_mesh
from scenes.meshes.implicit import Capsule, Part, smooth_curve, surface
from scenes.meshes.procedural import RECIPES, torus
from scenes.meshes.triangles import Triangles, ply_bytes, vertex_normals

BOUNDS = {
    "torus.ply": ((-1.35, -0.35, -1.35), (1.35, 0.35, 1.35)),
    "wire_mesh.ply": wire_mesh.BOUNDS,
    "dragon_97k_fixed.ply": dragon.FINE_BOUNDS,
    "dragon_res3_fixed.ply": dragon.COARSE_BOUNDS,
    "yeahright_cc2.ply": standins.YEAHRIGHT_CC2,
    "yeahright_cc1.ply": standins.YEAHRIGHT_CC1,
    "bunny_hr.ply": standins.BUNNY,
    "armadillo_29k.ply": standins.ARMADILLO,
    "spot.ply": standins.SPOT,
    "scorpion.ply": standins.SCORPION,
    "fertility.ply": standins.FERTILITY,
    "teapot.ply": standins.TEAPOT,
}
# what the real meshes have, which a stand-in's number has to be near
REAL_TRIANGLES = {
    **{"dragon_97k_fixed.ply": 97_716, "dragon_res3_fixed.ply": 44_894, "yeahright_cc2.ply": 188_672},
    **{"yeahright_cc1.ply": 47_168, "bunny_hr.ply": 59_664, "armadillo_29k.ply": 29_170, "spot.ply": 23_062},
    **{"scorpion.ply": 12_626, "fertility.ply": 9_000, "teapot.ply": 6_320},
}


@pytest.mark.parametrize("name", RECIPES)
def test_a_recipe_gives_its_recorded_bytes_and_a_closed_solid(name: str) -> None:
    recipe = RECIPES[name]
    mesh = recipe.make()
    assert hashlib.sha256(ply_bytes(mesh)).hexdigest() == recipe.sha256
    assert len(mesh.faces) == recipe.triangles
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    assert solid.volume > 0
    assert solid.body_count == 1
    assert (solid.area_faces > 0).all()
    np.testing.assert_allclose(solid.bounds, BOUNDS[name], rtol=1e-6)
    assert recipe.make.__doc__


def test_every_mesh_but_two_stands_in_for_one_of_about_as_many_triangles() -> None:
    assert {name for name, recipe in RECIPES.items() if recipe.stands_in} == set(REAL_TRIANGLES)
    for name, real in REAL_TRIANGLES.items():
        assert abs(RECIPES[name].triangles / real - 1) < 0.02, name


def test_the_wires_have_about_the_genus_of_yeahright() -> None:
    mesh = RECIPES["yeahright_cc2.ply"].make()
    euler = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).euler_number
    assert abs((2 - euler) / 2 - 131) < 15


def changes_per_row(mesh: Triangles, folder: Path, direction: tuple[float, float, float]) -> float:
    """Mean number of lit/dark changes along the rows of a parallel light's view that meet the mesh."""
    mitsuba.set_variant("scalar_rgb")
    path = folder / "mesh.ply"
    path.write_bytes(ply_bytes(mesh))
    scene = mitsuba.load_dict({"type": "scene", "mesh": {"type": "ply", "filename": str(path)}})
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    centre, radius = (low + high) / 2.0, float(np.linalg.norm(high - low)) / 2.0
    forward = np.array(direction) / np.linalg.norm(direction)
    right = np.cross(forward, [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    towards = mitsuba.ScalarVector3f(*forward.tolist())
    counts = []
    for y in np.linspace(-1, 1, 33):
        starts = centre - 2 * radius * forward + radius * (y * up + np.linspace(-1, 1, 301)[:, None] * right)
        dark = [scene.ray_test(mitsuba.Ray3f(mitsuba.ScalarPoint3f(*start), towards)) for start in starts.tolist()]
        if any(dark):
            counts.append(np.count_nonzero(np.diff(dark)))
    return float(np.mean(counts))


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [
        ("torus.ply", 2.0, 4.0),
        ("dragon_97k_fixed.ply", 2.5, 5.5),  # 12 directions at 512 x 512: 4.2 on average, the real dragon 3.2
        ("yeahright_cc2.ply", 8.0, 17.0),  # 13.6, and YeahRight 12.5
    ],
)
def test_a_light_sees_about_as_many_changes_as_on_the_real_mesh(
    name: str, least: float, most: float, tmp_path: Path
) -> None:
    found = [changes_per_row(RECIPES[name].make(), tmp_path, d) for d in ((-1.0, -1.0, -0.6), (0.3, -0.5, -1.0))]
    assert least <= np.mean(found) <= most


def test_the_torus_keeps_its_chord_error_and_has_exact_normals() -> None:
    mesh = torus()
    assert mesh.normals is not None

    def distance(points: np.ndarray) -> np.ndarray:
        return np.hypot(np.hypot(points[..., 0], points[..., 2]) - 1.0, points[..., 1]) - 0.35

    np.testing.assert_allclose(distance(mesh.vertices.astype(np.float64)), 0.0, atol=1e-7)
    # edge middles and centroids, where a triangle is farthest from a smooth surface
    weights = np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [1 / 3, 1 / 3, 1 / 3]])
    corners = mesh.vertices[mesh.faces].astype(np.float64)
    chord = max(float(np.abs(distance(np.tensordot(corners, w, axes=(1, 0)))).max()) for w in weights)
    assert chord == pytest.approx(9.2e-5, rel=0.01)
    x, y, z = mesh.vertices.astype(np.float64).T
    ring = np.hypot(x, z)
    exact = np.stack([x / ring * (ring - 1.0), y, z / ring * (ring - 1.0)], axis=1) / 0.35
    np.testing.assert_allclose(mesh.normals, exact, atol=3e-7)
    computed = vertex_normals(mesh.vertices, mesh.faces)
    assert float((computed * mesh.normals).sum(axis=1).min()) > 0.9999  # the faces turn outward as the normals do


def test_a_capsule_has_its_own_distances() -> None:
    # A straight capsule of radius 1 from (0, 0, 0) to (2, 0, 0), in the box it has.
    bounds = ((-1.0, -1.0, -1.0), (3.0, 1.0, 1.0))
    mesh = surface([Part([Capsule((0.0, 0.0, 0.0), (2.0, 0.0, 0.0), 1.0, 1.0)], 0.1)], 0.05, bounds)
    points = mesh.vertices.astype(np.float64)
    nearest = np.stack([np.clip(points[:, 0], 0.0, 2.0), *np.zeros((2, len(points)))], axis=1)
    np.testing.assert_allclose(np.linalg.norm(points - nearest, axis=1), 1.0, atol=4e-3)
    volume = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume
    assert volume == pytest.approx(np.pi * 2.0 + 4.0 / 3.0 * np.pi, rel=5e-3)


def test_a_smooth_curve_passes_through_its_beads() -> None:
    beads = [(0.0, 0.0, 0.0, 1.0), (1.0, 2.0, 0.0, 2.0), (3.0, 1.0, 1.0, 0.5)]
    curve = smooth_curve(beads, 4)
    assert len(curve) == 9
    assert [curve[0], curve[4], curve[8]] == beads
