"""Emitters of a scene file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scenes.model import Light
from scenes.textures import load_texture
from scenes.xml_nodes import Node, is_similarity


def load_light(node: Node, fog: Node, bounded: bool, scene_folder: Path) -> Light:
    """Read an emitter.

    Parameters
    ----------
    fog : the scene's medium, the only one in which a light may be
    bounded : whether the fog ends somewhere, as a directional light needs it

    Raises
    ------
    InputError
        Another plugin, a property that airlight does not know, or values that no light can have.
    """
    if node.plugin not in ("point", "spot", "directional"):
        raise node.refuse("is not supported; use point or spot, or directional with a bounded medium.")
    if node.plugin == "directional" and not bounded:
        raise node.refuse(
            "needs a bounded medium: through fog that fills space no light comes from infinitely far; put the fog into "
            "a cube with a null BSDF, or use a point light."
        )
    for one, other in (("position", "to_world"), ("direction", "to_world")):
        if {one, other} <= set(node.unread):
            raise node.refuse(f"has both a '{one}' and a '{other}'; leave one out.")
    to_world = node.transform()
    if not is_similarity(to_world):
        raise node.refuse("has a 'to_world' that scales unevenly or shears; use <lookat>, rotations and translations.")
    for medium in node.children("Medium"):
        if medium.index != fog.index:
            raise medium.refuse(f"around the {node.plugin} light is not the one that the camera looks into.")
    position = to_world[:3, 3]
    beam_width = cutoff_angle = np.pi
    texture = None
    if node.plugin == "point":
        position = node.point("position", position)
    elif node.plugin == "directional":
        if abs(np.linalg.norm(to_world[:3, 2]) - 1) > 1e-4:
            # Mitsuba's own integrators disagree about such a light
            raise node.refuse("has a 'to_world' that scales; use <lookat> or a 'direction'.")
        to_world = _directed(node, to_world)
    else:
        beam_width, cutoff_angle = _cone(node)
        if nested := node.nested("texture"):
            texture = load_texture(nested, scene_folder)
    node.ignore("sampling_weight")
    strength = "irradiance" if node.plugin == "directional" else "intensity"
    intensity = node.color(strength, 1.0)
    if not intensity.any():
        raise node.refuse(f"has no {strength}, so nothing would be seen.")
    node.finish()
    return Light(node.plugin, position, intensity, to_world, beam_width, cutoff_angle, texture)  # type: ignore[arg-type]


def _cone(node: Node) -> tuple[float, float]:
    """Half-angles of a spot [rad]: of its full intensity and of its end."""
    cutoff = node.number("cutoff_angle", 20.0)
    beam = node.number("beam_width", cutoff * 0.75)
    if not (0 < cutoff < 90 and 0 <= beam <= cutoff):
        raise node.refuse(f"has beam_width = {beam} and cutoff_angle = {cutoff}; use 0 <= beam <= cutoff < 90.")
    return float(np.radians(beam)), float(np.radians(cutoff))


def _directed(node: Node, to_world: np.ndarray) -> np.ndarray:
    """Frame of a directional light whose 'direction' may be given, (4, 4)."""
    if "direction" not in node.unread:
        return to_world
    direction = node.point("direction")
    length = np.linalg.norm(direction)
    if not length > 0:
        raise node.refuse("has a 'direction' without length.")
    frame = np.eye(4)
    frame[:3, 2] = direction / length
    # what lies across has no bearing on parallel light
    across = np.cross(frame[:3, 2], np.eye(3)[np.argmin(np.abs(direction))])
    frame[:3, 0] = across / np.linalg.norm(across)
    frame[:3, 1] = np.cross(frame[:3, 2], frame[:3, 0])
    return frame
