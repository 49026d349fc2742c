"""Reads a Mitsuba 3 scene file into dataclasses, or refuses it with the place and the reason.

The file is parsed by `mitsuba.parser`, so everything Mitsuba's format offers (`<default>`, `<include>`, `<ref>`,
nested transforms) means here what it means there. Each property must be read by somebody: what is left over is
refused, because a picture that silently ignores part of its scene is wrong.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenes.camera import check_size, load_camera
from scenes.catalogue import scene_path
from scenes.errors import InputError
from scenes.file_names import is_text
from scenes.lights import load_light
from scenes.materials import load_material
from scenes.media import Fog, load_medium, load_phase, take_fog
from scenes.meshes.files import sha256
from scenes.model import Array, Mesh, Scene
from scenes.parsing import READ_FILES, drop, parse, reached
from scenes.shapes import Shape, instance_of, load_shape
from scenes.textures import load_texture
from scenes.xml_nodes import Node

# Mitsuba's parse_file takes parameters beside arguments of these names
RESERVED = ("config", "filename")

# properties of the scene that change how Mitsuba works, and not what it draws
OF_NO_BEARING = ("embree_use_robust_intersections", "allow_thread_reordering")
# Some GB of vertices, and of shadow maps at 1,024 texels: more would take minutes and then the machine.
MOST_TRIANGLES, MOST_LIGHTS = 20_000_000, 64


def load(scene: str | Path, /, size: tuple[int, int] | None = None, **parameters: object) -> Scene:
    """Load a scene.

    Parameters
    ----------
    scene : name of a shipped scene, or path of any Mitsuba XML file
    size : (width, height) [pixel]; the film's own by default
    parameters : values for the file's `$name` parameters

    Raises
    ------
    InputError
        The file is missing, is not a scene, or holds something outside the supported subset.
    """
    return load_seen_from(scene, None, size, parameters)


def load_seen_from(
    scene: str | Path,
    camera_to_world: Array | None,
    size: tuple[int, int] | None,
    parameters: Mapping[str, object],
) -> Scene:
    """Load a scene as `load` does, with its camera elsewhere.

    Parameters
    ----------
    camera_to_world : (4, 4)    None for its own; `scenes.orbit` makes others
    """
    path = scene_path(scene)
    if size is not None:
        check_size(size)
    texts = {name: str(value) for name, value in parameters.items()}
    for name, text in texts.items():
        # Mitsuba would take an empty number for 0
        if not text:
            raise InputError(f"The parameter {name} of {path} was given no value; give one or leave it out.")
        if not is_text(name + text):
            raise InputError(f"The parameter {name!a} of {path} is not UTF-8, or its value is not; correct it.")
        if name in RESERVED:
            raise InputError(f"{path} cannot be given a parameter called {name}; rename it in the scene.")
    state = parse(path, texts)
    root = Node(state, 0)
    root.ignore(*OF_NO_BEARING)
    replaced = tuple(node.plugin for node in root.children("Integrator") if node.plugin != "volpath")
    sensor = _only(root.children("Sensor"), "sensor", path)
    camera, around = load_camera(sensor, size, camera_to_world)
    shapes = root.children("Shape")
    fog = take_fog(sensor, camera, around, shapes, path.parent)
    medium, phase = load_medium(fog.medium)
    emitters = root.children("Emitter")
    if len(emitters) > MOST_LIGHTS:
        raise emitters[MOST_LIGHTS].refuse(f"is one light more than the {MOST_LIGHTS} that airlight takes.")
    lights = tuple(load_light(node, fog.medium, fog.boundary is not None, path.parent) for node in emitters)
    if not lights:
        raise InputError(f"{path} has no light: add a <emitter type='point'> or a <emitter type='spot'>.")
    meshes, normals = _meshes(shapes, fog, path.parent)
    _check_definitions(root, path.parent)
    root.finish()
    # what airlight replaces is not made
    drop(root, "Integrator")
    drop(sensor, "Sampler")
    for film in Node(state, sensor.index).children("Film"):
        drop(film, "ReconstructionFilter")
    return Scene(
        name=path.stem,
        path=path,
        parameters=texts,
        camera=camera,
        meshes=meshes,
        lights=lights,
        medium=medium,
        phase=phase,
        boundary=fog.boundary,
        normals=normals,
        replaced=replaced,
        parsed=state,
        digest=_digest(state),
    )


def _check_definitions(root: Node, folder: Path) -> None:
    """Hold definitions that others may refer to against the same rules, used or not: Mitsuba makes them all."""
    for node in root.children("Medium"):
        load_medium(node)
    for node in root.children("PhaseFunction"):
        load_phase(node)
    for node in root.children("Texture"):
        load_texture(node, folder)
    for node in root.children("BSDF"):
        if node.plugin == "null":
            node.finish()
        else:
            load_material(node, folder)


def _only(nodes: list[Node], what: str, path: Path) -> Node:
    if len(nodes) != 1:
        raise InputError(f"{path} has {len(nodes) or 'no'} {what}{'s' * (len(nodes) > 1)}: it should have exactly one.")
    return nodes[0]


def _meshes(shapes: list[Node], fog: Fog, folder: Path) -> tuple[tuple[Mesh, ...], dict[str, Array]]:
    """Meshes of all shapes, instances among them, and the normals that Mitsuba is handed."""
    meshes: list[Mesh] = []
    normals: dict[str, Array] = {}

    def keep(shape: Shape, name: str) -> None:
        if shape.computed_normals and shape.mesh.normals is not None:
            normals[f"{name}.vertex_normals"] = shape.mesh.normals.ravel()

    for number, node in enumerate(shapes):
        # Mitsuba would make a name up for each that has none
        if not node.props.id():
            node.props.set_id(f"shape_{number}")
    groups = {node.index: node for node in shapes if node.plugin == "shapegroup"}
    members = {index: _members(group, folder) for index, group in groups.items()}
    for index, group in groups.items():
        for shape in members[index]:
            keep(shape, f"{group.props.id()}.{shape.mesh.name}")
    total = 0
    for node in shapes:
        if node.plugin == "shapegroup":
            continue
        name = node.props.id()
        if node.plugin == "instance":
            held = node.child("Shape")
            if held is None or held.plugin != "shapegroup":
                raise node.refuse("should hold a <ref> to one shapegroup.")
            if held.index not in members:
                # Mitsuba finds a group only where it stands by itself
                raise held.refuse("stands inside an instance: move it out, give it an id and refer to it by <ref>.")
            to_world = node.transform()
            node.finish()
            total += sum(len(shape.mesh.faces) for shape in members[held.index])
            _check_total(node, total)
            placed = [instance_of(shape.mesh, to_world, f"{name}.{shape.mesh.name}") for shape in members[held.index]]
            for mesh in placed:
                fog.check_faces(node, mesh)
            meshes += placed
        else:
            fog.check_outside(node)
            shape = load_shape(node, folder, name)
            fog.check_faces(node, shape.mesh)
            total += len(shape.mesh.faces)
            _check_total(node, total)
            keep(shape, name)
            meshes.append(shape.mesh)
    return tuple(meshes), normals


def _check_total(node: Node, triangles: int) -> None:
    if triangles > MOST_TRIANGLES:
        raise node.refuse(
            f"brings the scene to {triangles:,} triangles (a sphere has 81,920), more than the {MOST_TRIANGLES:,} that "
            "airlight takes; leave some out."
        )


def _members(group: Node, folder: Path) -> list[Shape]:
    """Shapes of a shapegroup, in its own space."""
    nodes = group.children("Shape")
    if not nodes:
        raise group.refuse("holds no shape; put one in it or leave it out.")
    group.finish()
    for number, node in enumerate(nodes):
        if not node.props.id():
            node.props.set_id(f"member_{number}")
    return [load_shape(node, folder, node.props.id()) for node in nodes]


def _digest(state: Any) -> str:
    """Hash of the parsed scene, with the contents of meshes and pictures in place of their paths."""
    import mitsuba.parser as parser

    paths = {}
    # what was dropped names files that nobody reads
    for node in reached(state).values():
        if node.props.plugin_name() in READ_FILES and "filename" in node.props:
            # by content: the same mesh in another folder is the same scene
            paths[node] = node.props["filename"]
            node.props["filename"] = sha256(paths[node])
    text = parser.write_string(state)
    for node, path in paths.items():
        node.props["filename"] = path
    return hashlib.sha256(text.encode()).hexdigest()
