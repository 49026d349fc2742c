"""Shapes of a scene file as triangle meshes in world space."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenes import tessellate
from scenes.mesh_files import MeshFile, Triangles, find_mesh, read_mesh, vertex_normals
from scenes.model import Mesh
from scenes.xml_nodes import Node, is_similarity

Matrix = NDArray[np.float64]


def _sphere(node: Node) -> tuple[Triangles, Matrix]:
    placed = np.eye(4)
    placed[:3, :3] *= _radius(node)
    placed[:3, 3] = node.point("center", np.zeros(3))
    return tessellate.sphere(), placed


def _cylinder(node: Node) -> tuple[Triangles, Matrix]:
    start, end = node.point("p0", np.zeros(3)), node.point("p1", np.array([0.0, 0.0, 1.0]))
    radius = _radius(node)
    with node.located():
        return tessellate.cylinder(start, end, radius), np.eye(4)


def _radius(node: Node) -> float:
    radius = node.number("radius", 1.0)
    if not radius > 0:
        raise node.refuse(f"has 'radius' = {radius}, which should be positive.")
    return radius


def _plain(make: Callable[[], Triangles]) -> Callable[[Node], tuple[Triangles, Matrix]]:
    return lambda node: (make(), np.eye(4))


ANALYTIC: dict[str, Callable[[Node], tuple[Triangles, Matrix]]] = {
    "sphere": _sphere,
    "cylinder": _cylinder,
    "rectangle": _plain(tessellate.rectangle),
    "cube": _plain(tessellate.cube),
    "disk": _plain(tessellate.disk),
}
FROM_FILE = ("ply", "obj")
ROUND = ("sphere", "cylinder")


def load_shape(node: Node, scene_folder: Path, name: str) -> Mesh:
    """Turn one shape node into a mesh; the node's file name is replaced by the path of the mesh that was found.

    Raises
    ------
    InputError
        A plugin or property outside the supported subset; a mesh that is missing or damaged.
    """
    file: MeshFile | None = None
    if node.plugin in FROM_FILE:
        filename, flat = node.text("filename"), node.flag("face_normals")
        if not filename.lower().endswith(f".{node.plugin}"):
            raise node.refuse(f"reads .{node.plugin} files, and its 'filename' is '{filename}'.")
        with node.located():
            file = find_mesh(filename, scene_folder)
            triangles, local = read_mesh(file.path), np.eye(4)
        node.props["filename"] = str(file.path)
    elif node.plugin in ANALYTIC:
        # a cube is flat by nature: its normals come with it
        flat = False
        triangles, local = ANALYTIC[node.plugin](node)
    else:
        raise node.refuse(f"is not supported; use one of {', '.join([*FROM_FILE, *ANALYTIC])}.")
    to_world = node.transform()
    if node.plugin in ROUND and not is_similarity(to_world):
        raise node.refuse("has a 'to_world' that scales unevenly or shears, which Mitsuba does not draw; use a mesh.")
    flip = node.flag("flip_normals")
    # Mitsuba turns a mirrored sphere inside out
    if node.plugin == "sphere" and np.linalg.det(to_world[:3, :3]) < 0:
        flip = not flip
    to_world = to_world @ local
    for kind in ("Medium", "Emitter", "Sensor"):
        for nested in node.children(kind):
            raise nested.refuse("inside a shape is not supported yet; airlight takes fog that fills all of space.")
    reflectance, two_sided = _diffuse(node.child("BSDF"))
    node.finish()
    mesh = _place(triangles, to_world, flat, flip, name, reflectance, two_sided, file)
    if not np.isfinite(mesh.vertices).all():
        raise node.refuse("has vertices beyond what float32 holds; scale it down.")
    return mesh


def _place(
    triangles: Triangles,
    to_world: Matrix,
    flat: bool,
    flip: bool,
    name: str,
    reflectance: NDArray[np.float64],
    two_sided: bool,
    file: MeshFile | None,
) -> Mesh:
    linear = to_world[:3, :3]
    vertices = np.asarray(triangles.vertices, np.float64) @ linear.T + to_world[:3, 3]
    with np.errstate(over="ignore"):  # the caller refuses what becomes infinite
        placed = vertices.astype(np.float32)
    faces = triangles.faces
    if flat:
        normals = None
    elif triangles.normals is None:
        normals = np.asarray(vertex_normals(placed, faces), np.float64)
    else:
        # the transpose of the inverse, which keeps normals normal under uneven scaling
        normals = np.asarray(triangles.normals, np.float64) @ np.linalg.inv(linear)
        length = np.linalg.norm(normals, axis=-1, keepdims=True)
        # a file may hold a normal of length zero; it stays one, and its surface black
        normals /= np.where(length > 0, length, 1)
    if flip:
        faces = faces[:, ::-1]
        normals = None if normals is None else -normals
    return Mesh(
        name=name,
        vertices=placed,
        faces=np.ascontiguousarray(faces, dtype=np.uint32),
        normals=None if normals is None else normals.astype(np.float32),
        # Mitsuba turns flipped ones itself, as it reads them; its own differ from ours by less than 1e-4 rad
        computed_normals=file is not None and not flat and not flip and triangles.normals is None,
        reflectance=reflectance,
        two_sided=two_sided,
        file=file,
    )


def _diffuse(node: Node | None) -> tuple[NDArray[np.float64], bool]:
    """Reflectance and two-sidedness of a BSDF; Mitsuba's default is diffuse with 0.5."""
    if node is None:
        return np.full(3, 0.5), False
    if node.plugin == "twosided":
        inner = node.children("BSDF")
        node.finish()
        if len(inner) != 1 or inner[0].plugin == "twosided":
            raise node.refuse("should hold one diffuse BSDF for both sides.")
        return _diffuse(inner[0])[0], True
    if node.plugin != "diffuse":
        raise node.refuse("is not supported; use diffuse or twosided.")
    reflectance = node.color("reflectance", 0.5)
    if (reflectance > 1).any():
        raise node.refuse(f"has 'reflectance' = {reflectance.tolist()}, which should be at most 1.")
    node.finish()
    return reflectance, False
