"""The same scene seen from another place: its camera turned about the middle of what it looks at."""

from __future__ import annotations

import numpy as np

from scenes.loader import load_seen_from
from scenes.model import Array, Scene


def orbited(scene: Scene, degrees: float) -> Scene:
    """Load a scene again with its camera turned about its own vertical.

    The axis goes through the point of the viewing axis that is nearest to the middle of the meshes: what the camera
    looks at stays where it is in the image, and everything before and behind it moves. Positive angles take the eye to
    the right.

    Parameters
    ----------
    degrees : float    0 gives the scene as it is

    Raises
    ------
    InputError
        As `scenes.loader.load`.
    """
    camera = scene.camera
    if degrees == 0:
        return scene
    return load_seen_from(scene.path, orbit_to_world(scene, degrees), (camera.width, camera.height), scene.parameters)


def orbit_to_world(scene: Scene, degrees: float) -> Array:
    """Where the camera is after the turn, (4, 4)."""
    to_world = scene.camera.to_world
    up, forward, eye = to_world[:3, 1], to_world[:3, 2], to_world[:3, 3]
    middle = eye + max(_depth_of_middle(scene), scene.camera.near) * forward
    x, y, z = up
    cross, angle = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]), np.radians(degrees)
    # Rodrigues 1840
    turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    moved = np.eye(4)
    moved[:3, :3] = turn @ to_world[:3, :3]
    moved[:3, 3] = middle + turn @ (eye - middle)
    return moved


def _depth_of_middle(scene: Scene) -> float:
    """How far along the viewing axis the middle of the meshes' box lies; of the lights' without meshes."""
    points = [mesh.vertices for mesh in scene.meshes] or [light.position[None] for light in scene.lights]
    low = np.min([found.min(axis=0) for found in points], axis=0)
    high = np.max([found.max(axis=0) for found in points], axis=0)
    return float(((low + high) / 2 - scene.camera.origin) @ scene.camera.to_world[:3, 2])
