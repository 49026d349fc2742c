"""Scenes that have no reference, refused before the work: a light or the camera shut in."""

from __future__ import annotations

import numpy as np

from reference.checks.solids import Array, closed_parts
from scenes.model import Camera, Scene
from scenes.xml_nodes import Node


def check_scene(scene: Scene) -> None:
    """Refuse a scene of whose lights one could never be seen, or in which nothing could be.

    Only what is certain is refused. A closed surface that the camera's near plane cuts shows its inside, an open one
    lets light through, and so does one with a null BSDF.

    Raises
    ------
    InputError
        A light is inside a closed surface and the camera is not; or the camera is, and every light is outside.
    """
    camera, root = scene.camera, Node(scene.parsed, 0)
    lamps = [number for number, light in enumerate(scene.lights) if light.kind != "directional"]
    # rays begin on the near plane
    eye = camera.origin + camera.near * camera.to_world[:3, 2]
    points = np.array([eye, *(scene.lights[number].position for number in lamps)])
    for mesh in scene.meshes:
        for part in closed_parts(mesh, points):
            if _cuts_the_view(part.triangles, camera):
                continue
            eye_inside, lamps_inside = part.holds[0], part.holds[1:]
            if not eye_inside:
                emitter = root.children("Emitter")[lamps[int(np.argmax(lamps_inside))]]
                raise emitter.refuse(
                    f"is inside the closed surface of the shape '{mesh.name}', and the camera is outside it: none of "
                    "its light could be seen; move one of them, or leave the light out."
                )
            if not lamps_inside.any():
                raise root.children("Sensor")[0].refuse(
                    f"is inside the closed surface of the shape '{mesh.name}', and every light is outside it: nothing "
                    "could be seen; move the camera or the shape."
                )


def _cuts_the_view(triangles: Array, camera: Camera) -> bool:
    """Whether triangles, (T, 3, 3), meet the rectangle on the near plane on which the camera's rays begin."""
    local = (triangles - camera.origin) @ camera.to_world[:3, :3]
    half = camera.near * np.array([camera.tan_half_x, camera.tan_half_y])
    beyond = local[..., 2] > camera.near
    crossing = beyond.any(axis=1) & ~beyond.all(axis=1)
    local, beyond = local[crossing], beyond[crossing]
    # the corner that is alone on its side of the plane comes first: a segment joins the two edges from it
    alone = np.argmax(beyond == (beyond.sum(axis=1) == 1)[:, None], axis=1)
    first, second, third = (local[np.arange(len(local)), (alone + turn) % 3] for turn in range(3))
    begin, end = (_at_depth(first, other, camera.near) / half for other in (second, third))
    return bool(_meet_square(begin, end).any())


def _at_depth(a: Array, b: Array, depth: float) -> Array:
    """Where the lines from a to b, (T, 3), reach a depth; x and y, (T, 2)."""
    share = (depth - a[:, 2]) / (b[:, 2] - a[:, 2])
    return a[:, :2] + share[:, None] * (b[:, :2] - a[:, :2])


def _meet_square(begin: Array, end: Array) -> Array:
    """Whether segments, (T, 2), meet [-1, 1]^2; (T,) bool.

    Source: Liang and Barsky 1984, "A New Concept and Method for Line Clipping".
    """
    way = end - begin
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = (-1 - begin) / way, (1 - begin) / way
    # a segment along a side of the square runs beside it all the way, or in it
    within = (np.abs(begin) <= 1) | (way != 0)
    enter = np.where(way != 0, np.minimum(low, high), 0).max(axis=1).clip(0)
    leave = np.where(way != 0, np.maximum(low, high), 1).min(axis=1).clip(max=1)
    return within.all(axis=1) & (enter <= leave)
