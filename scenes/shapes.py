"""Shapes of a scene file as triangle meshes in world space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from scenes.materials import load_material
from scenes.meshes import tessellate
from scenes.meshes.files import MeshFile, find_mesh, read_mesh
from scenes.meshes.triangles import Triangles, vertex_normals
from scenes.model import Array, Mesh, Texture
from scenes.xml_nodes import Node, is_similarity

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Shape:
    """One shape node, read.

    Attributes
    ----------
    mesh : Mesh
    computed_normals : bool   the file had none: `mesh.normals` are ours, and Mitsuba can be handed the same
    to_world : (4, 4)         of an analytic shape, its own radius and centre included
    """

    mesh: Mesh
    computed_normals: bool
    to_world: Matrix


def _sphere(node: Node) -> tuple[Triangles, Matrix]:
    placed = np.eye(4)
    placed[:3, :3] *= _radius(node)
    placed[:3, 3] = node.point("center", np.zeros(3))
    return tessellate.sphere(), placed


def _cylinder(node: Node) -> tuple[Triangles, Matrix]:
    start, end = node.point("p0", np.zeros(3)), node.point("p1", np.array([0.0, 0.0, 1.0]))
    radius = _radius(node)
    with node.located():
        return tessellate.cylinder(), tessellate.cylinder_frame(start, end, radius)


def _radius(node: Node) -> float:
    radius = node.number("radius", 1.0)
    # Mitsuba squares it in float32
    if not 1e-15 < radius < 1e15:
        raise node.refuse(f"has 'radius' = {radius}, which should be positive (1e-15 to 1e15).")
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
SUPPORTED = (*FROM_FILE, *ANALYTIC)


def load_shape(node: Node, scene_folder: Path, name: str) -> Shape:
    """Turn one shape node into a mesh; the node's file name is replaced by the path of the mesh that was found.

    Raises
    ------
    InputError
        A plugin or property outside the supported subset; a mesh that is missing or damaged.
    """
    file: MeshFile | None = None
    if node.plugin in FROM_FILE:
        file, triangles, flat = _from_file(node, scene_folder)
        local = np.eye(4)
    elif node.plugin in ANALYTIC:
        # a cube is flat by nature: its normals come with it
        flat = False
        triangles, local = ANALYTIC[node.plugin](node)
    else:
        raise node.refuse(f"is not supported; use one of {', '.join(SUPPORTED)}, or instance with a shapegroup.")
    to_world = node.transform()
    if node.plugin in ROUND and not is_similarity(to_world):
        raise node.refuse("has a 'to_world' that scales unevenly or shears, which Mitsuba does not draw; use a mesh.")
    flip = node.flag("flip_normals")
    # Mitsuba turns a mirrored sphere inside out
    if node.plugin == "sphere" and np.linalg.det(to_world[:3, :3]) < 0:
        flip = not flip
    material = load_material(node.child("BSDF"), scene_folder)
    node.finish()
    mapping, coordinates = _coordinates(node.plugin, triangles)
    if isinstance(material.diffuse, Texture) and coordinates is None:
        raise node.refuse("has a picture as reflectance, and its file no texture coordinates; use an <rgb>.")
    vertices, faces, normals = _place(node, triangles, to_world @ local, flat, flip)
    # Mitsuba turns flipped ones itself, as it reads them; its own differ from ours by less than 1e-4 rad
    computed = node.plugin == "ply" and not flat and not flip and triangles.normals is None
    mesh = Mesh(name, vertices, faces, normals, material, file, mapping, coordinates)
    return Shape(mesh, computed, to_world @ local)


def instance_of(mesh: Mesh, to_world: Matrix, name: str) -> Mesh:
    """Move a mesh of a shapegroup to where an instance has it.

    Mitsuba turns the normals of the group with the instance; so a mirrored one keeps them on the outside, and its
    triangles are turned over here to agree.
    """
    linear = to_world[:3, :3]
    vertices = (mesh.vertices.astype(np.float64) @ linear.T + to_world[:3, 3]).astype(np.float32)
    normals = None if mesh.normals is None else _unit(mesh.normals.astype(np.float64) @ np.linalg.inv(linear))
    faces = mesh.faces[:, ::-1] if np.linalg.det(linear) < 0 else mesh.faces
    return replace(mesh, name=name, vertices=vertices, faces=np.ascontiguousarray(faces), normals=normals)


def _from_file(node: Node, scene_folder: Path) -> tuple[MeshFile, Triangles, bool]:
    filename, flat = node.text("filename"), node.flag("face_normals")
    if not filename.lower().endswith(f".{node.plugin}"):
        raise node.refuse(f"reads .{node.plugin} files, and its 'filename' is '{filename}'.")
    # read_mesh turns v as Mitsuba's plugins do by default: that of an OBJ, and not that of a PLY
    turned = node.flag("flip_tex_coords", node.plugin == "obj") != (node.plugin == "obj")
    with node.located():
        file = find_mesh(filename, scene_folder)
        triangles = read_mesh(file.path)
    node.props["filename"] = str(file.path)
    if turned and triangles.uv is not None:
        triangles = replace(triangles, uv=np.stack([triangles.uv[:, 0], 1 - triangles.uv[:, 1]], axis=1))
    return file, triangles, flat


def _coordinates(plugin: str, triangles: Triangles) -> tuple[Literal["uv", "sphere", "cylinder", "disk"], Array | None]:
    """What a picture on the shape is looked up by; see `Mesh.mapping`."""
    if plugin in ("sphere", "cylinder", "disk"):
        return plugin, triangles.vertices  # type: ignore[return-value]
    if triangles.uv is None:
        return "uv", None
    return "uv", np.column_stack([triangles.uv, np.zeros(len(triangles.uv), np.float32)])


def _place(
    node: Node, triangles: Triangles, to_world: Matrix, flat: bool, flip: bool
) -> tuple[Array, Array, Array | None]:
    """Vertices, faces and normals in world space."""
    linear = to_world[:3, :3]
    vertices = np.asarray(triangles.vertices, np.float64) @ linear.T + to_world[:3, 3]
    with np.errstate(over="ignore"):  # what becomes infinite is refused
        placed = vertices.astype(np.float32)
    if not np.isfinite(placed).all():
        raise node.refuse("has vertices beyond what float32 holds; scale it down.")
    faces = triangles.faces
    if flat:
        normals = None
    elif triangles.normals is None:
        normals = vertex_normals(placed, faces)
    else:
        # the transpose of the inverse, which keeps normals normal under uneven scaling
        normals = _unit(np.asarray(triangles.normals, np.float64) @ np.linalg.inv(linear))
    if flip:
        faces = faces[:, ::-1]
        normals = None if normals is None else -normals
    return placed, np.ascontiguousarray(faces, dtype=np.uint32), normals


def _unit(normals: Matrix) -> NDArray[np.float32]:
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    # a file may hold a normal of length zero; it stays one, and its surface black
    return (normals / np.where(length > 0, length, 1)).astype(np.float32)
