"""Instantiates a loaded scene in Mitsuba, from Mitsuba's own parse of the file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scenes.mitsuba_setup import mitsuba
from scenes.model import Scene


@dataclass(frozen=True)
class MitsubaScene:
    """A scene inside Mitsuba."""

    scene: Any
    sensor: Any
    medium: Any


def instantiate(scene: Scene) -> MitsubaScene:
    """Make Mitsuba's objects.

    Nothing of the loader's interpretation enters but the vertex normals of meshes whose files have none: there the
    normals are a choice, and both renderers make the same one.
    """
    mi = mitsuba()
    import mitsuba.parser as parser

    config = parser.ParserConfig(mi.variant())
    config.merge_meshes = False
    config.merge_equivalent = False
    made: Any = parser.instantiate(config, scene.parsed)
    parameters = mi.traverse(made)
    for mesh in scene.meshes:
        if mesh.computed_normals and mesh.file and mesh.file.path.suffix == ".ply":
            parameters[f"{mesh.name}.vertex_normals"] = mesh.normals.ravel()  # type: ignore[union-attr]
    parameters.update()
    sensor = made.sensors()[0]
    return MitsubaScene(made, sensor, sensor.get_medium())
