"""Reads a Mitsuba 3 scene file into dataclasses, or refuses it with the place and the reason.

The file is parsed by `mitsuba.parser`, so everything Mitsuba's format offers (`<default>`, `<include>`, `<ref>`,
nested transforms) means here what it means there. Each property must be read by somebody: what is left over is
refused, because a picture that silently ignores part of its scene is wrong.
"""

from __future__ import annotations

import hashlib
import re
from pathlib import Path
from typing import Any

import numpy as np

import analytic
from analytic.phase import Phase
from scenes.catalogue import scene_path
from scenes.errors import InputError
from scenes.mesh_files import sha256
from scenes.mitsuba_setup import parser_config
from scenes.model import Camera, Light, Mesh, Scene
from scenes.shapes import FROM_FILE, load_shape
from scenes.xml_nodes import Node, is_similarity

LARGEST_SIDE = 16384
# Mitsuba's parse_file takes parameters beside arguments of these names
RESERVED = ("config", "filename")


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
        _check_size(size)
    texts = {name: str(value) for name, value in parameters.items()}
    for name, text in texts.items():
        # Mitsuba would take an empty number for 0
        if not text:
            raise InputError(f"The parameter {name} of {path} was given no value; give one or leave it out.")
        if name in RESERVED:
            raise InputError(f"{path} cannot be given a parameter called {name}; rename it in the scene.")
    state = _parse(path, texts)
    root = Node(state, 0)
    replaced = [node.plugin for node in root.children("Integrator") if node.plugin != "volpath"]
    camera, medium_node = _camera(_only(root.children("Sensor"), "sensor", path), size)
    medium, phase = _medium(medium_node)
    lights = tuple(_light(node, medium_node) for node in root.children("Emitter"))
    if not lights:
        raise InputError(f"{path} has no light: add a <emitter type='point'> or a <emitter type='spot'>.")
    meshes = _meshes(root, path)
    # definitions that others refer to; who uses them has read them
    root.children("Medium", "BSDF", "PhaseFunction")
    root.finish()
    return Scene(path.stem, path, texts, camera, meshes, lights, medium, phase, tuple(replaced), state, _digest(state))


def _parse(path: Path, parameters: dict[str, str]) -> Any:
    config = parser_config()
    import mitsuba.parser as parser

    try:
        state = parser.parse_file(config, str(path), **parameters)
        parser.transform_all(config, state)
        # text of another encoding passes the parser, and breaks whoever reads it
        for node in state.nodes:
            node.props.id()
    except UnicodeDecodeError:
        raise InputError(f"{path} is not UTF-8; save it as UTF-8.") from None
    except (RuntimeError, ValueError) as error:
        raise InputError(_sentence(path, str(error))) from None
    return state


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


def _camera(node: Node, size: tuple[int, int] | None) -> tuple[Camera, Node]:
    if node.plugin != "perspective":
        raise node.refuse("is not supported; use perspective.")
    film = node.child("Film")
    width, height = _film_size(node, film, size)
    to_world = node.transform()
    if not np.allclose(to_world[:3, :3].T @ to_world[:3, :3], np.eye(3), atol=1e-5):
        raise node.refuse("has a 'to_world' that scales or shears; use <lookat>, rotations and translations.")
    near, far = node.number("near_clip", 1e-2), node.number("far_clip", 1e4)
    if not 0 < near < far:
        raise node.refuse(f"has near_clip = {near} and far_clip = {far}; it should be 0 < near_clip < far_clip.")
    tan_half_x = _tan_half_x(node, width / height)
    medium = node.child("Medium")
    if medium is None:
        raise node.refuse(
            "is not inside a medium, so there is no fog to render: put <ref id='...'/> of a medium in it."
        )
    node.children("Sampler")
    node.finish()
    return Camera(to_world, tan_half_x, near, far, width, height), medium


def _film_size(sensor: Node, film: Node | None, size: tuple[int, int] | None) -> tuple[int, int]:
    if film is None:
        raise sensor.refuse("has no film; add <film type='hdrfilm'/> with a width and a height.")
    if film.plugin != "hdrfilm":
        raise film.refuse("is not supported; use hdrfilm.")
    width, height = film.integer("width", 768), film.integer("height", 576)
    if size is None:
        with film.located():
            _check_size((width, height))
    else:
        width, height = size
    # how the film stores its pixels and reconstructs them: airlight evaluates pixel centres and writes float32 EXR
    film.ignore("file_format", "pixel_format", "component_format", "banner", "compensate", "sample_border")
    film.children("ReconstructionFilter")
    film.finish()
    film.props["width"], film.props["height"] = width, height
    return width, height


def _check_size(size: tuple[int, int]) -> None:
    width, height = size
    if not all(isinstance(side, int | np.integer) and 1 <= side <= LARGEST_SIDE for side in (width, height)):
        raise InputError(f"An image of {width} x {height} pixels cannot be made: use 1 to {LARGEST_SIDE} on each side.")


def _tan_half_x(node: Node, aspect: float) -> float:
    """Tangent of half the horizontal field of view, from Mitsuba's `fov` and `fov_axis`."""
    fov = node.number("fov")
    tan_half = float(np.tan(np.radians(fov) / 2))
    # near 180 degrees float32 has no digits left
    if not (0 < fov < 180 and tan_half < 1e3):
        raise node.refuse(f"has 'fov' = {fov}, which should lie between 0 and 180 degrees.")
    axis = node.take("fov_axis", "x")
    if axis in ("smaller", "larger"):
        axis = "y" if (aspect > 1) == (axis == "smaller") else "x"
    if axis not in ("x", "y", "diagonal"):
        raise node.refuse(f"has fov_axis = '{axis}'; use x, y, diagonal, smaller or larger.")
    return tan_half * {"x": 1.0, "y": aspect, "diagonal": aspect / float(np.hypot(1, aspect))}[axis]


def _medium(node: Node) -> tuple[analytic.Medium, Phase]:
    if node.plugin != "homogeneous":
        raise node.refuse("is not supported; use homogeneous.")
    scale = node.number("scale", 1.0)
    sigma_t, albedo = node.color("sigma_t", 1.0) * scale, node.color("albedo", 0.75)
    phase_node = node.child("PhaseFunction")
    node.ignore("sample_emitters", "has_spectral_extinction")
    node.finish()
    try:
        return analytic.Medium.from_albedo(albedo, sigma_t), _phase(phase_node)
    except ValueError as error:
        raise node.refuse(f"cannot be used: {error}.") from None


def _phase(node: Node | None) -> Phase:
    if node is None:
        return analytic.phase("isotropic")
    settings = {}
    if node.plugin == "hg":
        settings["g"] = node.number("g", 0.8)
    elif node.plugin not in ("isotropic", "rayleigh"):
        raise node.refuse("is not supported; use isotropic, rayleigh or hg.")
    node.finish()
    try:
        return analytic.phase(node.plugin, **settings)
    except ValueError as error:
        raise node.refuse(f"cannot be used: {error}.") from None


def _light(node: Node, fog: Node) -> Light:
    if node.plugin not in ("point", "spot"):
        raise node.refuse("is not supported; use point or spot.")
    if node.plugin == "point" and {"position", "to_world"} <= set(node.unread):
        raise node.refuse("has both a 'position' and a 'to_world'; leave one out.")
    to_world = node.transform()
    if not is_similarity(to_world):
        raise node.refuse("has a 'to_world' that scales unevenly or shears; use <lookat>, rotations and translations.")
    position = to_world[:3, 3]
    beam_width = cutoff_angle = np.pi
    if node.plugin == "point":
        position = node.point("position", position)
    else:
        cutoff = node.number("cutoff_angle", 20.0)
        beam = node.number("beam_width", cutoff * 0.75)
        if not (0 < cutoff < 90 and 0 <= beam <= cutoff):
            raise node.refuse(f"has beam_width = {beam} and cutoff_angle = {cutoff}; use 0 <= beam <= cutoff < 90.")
        beam_width, cutoff_angle = np.radians([beam, cutoff])
    intensity = node.color("intensity", 1.0)
    if not intensity.any():
        raise node.refuse("has no intensity, so nothing would be seen.")
    for medium in node.children("Medium"):
        if medium.index != fog.index:
            raise medium.refuse(f"around the {node.plugin} light is not the one that fills space.")
    node.finish()
    axis = to_world[:3, 2] / np.linalg.norm(to_world[:3, 2])
    return Light(node.plugin, position, intensity, axis, float(beam_width), float(cutoff_angle))  # type: ignore[arg-type]


def _meshes(root: Node, path: Path) -> tuple[Mesh, ...]:
    meshes = []
    for number, node in enumerate(root.children("Shape")):
        if not node.props.id():
            node.props.set_id(f"shape_{number}")
        meshes.append(load_shape(node, path.parent, node.props.id()))
    return tuple(meshes)


def _digest(state: Any) -> str:
    """Hash of the parsed scene, with the contents of meshes in place of their paths."""
    import mitsuba.parser as parser

    paths = {}
    for node in state.nodes:
        if node.props.plugin_name() in FROM_FILE and "filename" in node.props:
            # by content: the same mesh in another folder is the same scene
            paths[node] = node.props["filename"]
            node.props["filename"] = sha256(paths[node])
    text = parser.write_string(state)
    for node, path in paths.items():
        node.props["filename"] = path
    return hashlib.sha256(text.encode()).hexdigest()
