"""Instantiates a loaded scene in Mitsuba, from Mitsuba's own parse of the file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import reference.plugins  # noqa: F401 - registers what scenes may name
from scenes.errors import InputError
from scenes.messages import one_sentence
from scenes.mitsuba_setup import mitsuba, parser_config
from scenes.model import Scene


@dataclass(frozen=True)
class MitsubaScene:
    """A scene inside Mitsuba."""

    scene: Any
    sensor: Any
    medium: Any


def instantiate(scene: Scene) -> MitsubaScene:
    """Make Mitsuba's objects; those made from one loaded scene share shapes, media and lights.

    Nothing of the loader's interpretation enters but the vertex normals of meshes whose files have none: there the
    normals are a choice, and both renderers make the same one.
    """
    mi = mitsuba()
    import mitsuba.parser as parser

    if not mi.variant().startswith("cuda"):
        # otherwise a ray slips through where triangles meet, once in some 10,000 pixels, and fog would never end there
        scene.parsed.nodes[0].props["embree_use_robust_intersections"] = True
    try:
        made: Any = parser.instantiate(parser_config(), scene.parsed)
    except (RuntimeError, ValueError) as error:
        # what airlight replaces (integrator, sampler, filter) or does not use still has to exist
        raise InputError(one_sentence(scene.path, str(error))) from None
    parameters = mi.traverse(made)
    for name, normals in scene.normals.items():
        parameters[name] = normals
    parameters.update()
    sensor = made.sensors()[0]
    return MitsubaScene(made, sensor, sensor.get_medium())
