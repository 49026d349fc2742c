"""Reads a Mitsuba 3 scene file into dataclasses, or refuses it with the place and the reason.

The file is parsed by `mitsuba.parser`, so everything Mitsuba's format offers (`<default>`, `<include>`, `<ref>`,
nested transforms) means here what it means there. Each property must be read by somebody: what is left over is
refused, because a picture that silently ignores part of its scene is wrong.
"""

from __future__ import annotations

import hashlib
import os
import re
from pathlib import Path
from typing import Any

from scenes.camera import check_size, load_camera
from scenes.catalogue import scene_path
from scenes.errors import InputError
from scenes.lights import load_light
from scenes.media import Fog, load_medium, take_fog
from scenes.mesh_files import sha256
from scenes.mitsuba_setup import mitsuba, parser_config
from scenes.model import Array, Mesh, Scene
from scenes.shapes import FROM_FILE, Shape, instance_of, load_shape
from scenes.xml_nodes import Node

# Mitsuba's parse_file takes parameters beside arguments of these names
RESERVED = ("config", "filename")
# plugins that read a file
FILES = (*FROM_FILE, "bitmap")


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
    path = scene_path(scene)
    if size is not None:
        check_size(size)
    texts = {name: str(value) for name, value in parameters.items()}
    for name, text in texts.items():
        # Mitsuba would take an empty number for 0
        if not text:
            raise InputError(f"The parameter {name} of {path} was given no value; give one or leave it out.")
        if name in RESERVED:
            raise InputError(f"{path} cannot be given a parameter called {name}; rename it in the scene.")
    state = _parse(path, texts)
    root = Node(state, 0)
    replaced = tuple(node.plugin for node in root.children("Integrator") if node.plugin != "volpath")
    sensor = _only(root.children("Sensor"), "sensor", path)
    camera, around = load_camera(sensor, size)
    shapes = root.children("Shape")
    fog = take_fog(sensor, camera, around, shapes, path.parent)
    medium, phase = load_medium(fog.medium)
    emitters = root.children("Emitter")
    lights = tuple(load_light(node, fog.medium, fog.boundary is not None, path.parent) for node in emitters)
    if not lights:
        raise InputError(f"{path} has no light: add a <emitter type='point'> or a <emitter type='spot'>.")
    meshes, normals = _meshes(shapes, fog, path.parent)
    # definitions that others refer to; who uses them has read them
    root.children("Medium", "BSDF", "PhaseFunction", "Texture")
    root.finish()
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


def _parse(path: Path, parameters: dict[str, str]) -> Any:
    config = parser_config()
    import mitsuba.parser as parser

    # <path> elements add folders to Mitsuba's list, which would serve every later scene of this process too
    resolver = mitsuba().file_resolver()
    before = [str(folder) for folder in resolver]
    try:
        state = parser.parse_file(config, str(path), **parameters)
        parser.transform_all(config, state)
        _find_in(list(resolver)[: len(list(resolver)) - len(before)], state)
        # text of another encoding passes the parser, and breaks whoever reads it
        for node in state.nodes:
            node.props.id()
    except UnicodeDecodeError:
        raise InputError(f"{path} is not UTF-8; save it as UTF-8.") from None
    except (RuntimeError, ValueError) as error:
        raise InputError(_sentence(path, str(error))) from None
    finally:
        resolver.clear()
        for folder in before:
            resolver.append(folder)
    return state


def _find_in(folders: list[Any], state: Any) -> None:
    """Spell out the path of each file that is found in one of the folders that the scene names by <path>."""
    for node in state.nodes:
        name = node.props["filename"] if node.props.plugin_name() in FILES and "filename" in node.props else None
        if isinstance(name, str) and not Path(name).is_absolute():
            found = [path for path in (Path(str(folder), name) for folder in folders) if os.path.isfile(path)]
            if found:
                node.props["filename"] = str(found[0].absolute())


def _sentence(path: Path, message: str) -> str:
    """Boil a message of Mitsuba's parser down to one sentence that names the file."""
    lines = [re.sub(r"^\[[^\]]*\]\s*", "", line.strip()) for line in message.splitlines()]
    if any("unused parameters" in line for line in lines):
        names = ", ".join(line.removeprefix("- ").split("=")[0] for line in lines if line.startswith("- "))
        return f"{path} has no use for the parameter {names} with these settings; correct its name or leave it out."
    innermost = [line for line in lines if line][-1].removeprefix("Error while loading ").rstrip(".")
    return innermost + "." if path.name in innermost else f"{path}: {innermost}."


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
    for node in shapes:
        if node.plugin == "shapegroup":
            continue
        name = node.props.id()
        if node.plugin == "instance":
            held = node.child("Shape")
            if held is None or held.plugin != "shapegroup":
                raise node.refuse("should hold a <ref> to one shapegroup.")
            if held.index not in members:
                members[held.index] = _members(held, folder)
            to_world = node.transform()
            node.finish()
            meshes += [instance_of(shape.mesh, to_world, f"{name}.{shape.mesh.name}") for shape in members[held.index]]
        else:
            fog.check_outside(node)
            shape = load_shape(node, folder, name)
            keep(shape, name)
            meshes.append(shape.mesh)
    return tuple(meshes), normals


def _members(group: Node, folder: Path) -> list[Shape]:
    """Shapes of a shapegroup, in its own space."""
    nodes = group.children("Shape")
    group.finish()
    for number, node in enumerate(nodes):
        if not node.props.id():
            node.props.set_id(f"member_{number}")
    return [load_shape(node, folder, node.props.id()) for node in nodes]


def _digest(state: Any) -> str:
    """Hash of the parsed scene, with the contents of meshes and pictures in place of their paths."""
    import mitsuba.parser as parser

    paths = {}
    for node in state.nodes:
        if node.props.plugin_name() in FILES and "filename" in node.props:
            # by content: the same mesh in another folder is the same scene
            paths[node] = node.props["filename"]
            node.props["filename"] = sha256(paths[node])
    text = parser.write_string(state)
    for node, path in paths.items():
        node.props["filename"] = path
    return hashlib.sha256(text.encode()).hexdigest()
