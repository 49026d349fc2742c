"""A scene whose eye and lights move a little from frame to frame, so that a timed frame has nothing to reuse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scenes.model import Light, Scene

Array = np.ndarray
# Farthest turn about the middle of the scene. A degree moves the eye by a sixtieth of its distance: every pixel and
# every texel sees something else, and the picture costs what it cost before.
SWAY = np.radians(1.0)


def moved(scene: Scene, number: int, bounds: Array) -> Scene:
    """Return the scene of frame `number`: the eye and each light turned about the middle of the bounds.

    The turn is `SWAY` sin(number), which no two frames share. The eye's is about its own vertical. A light's is about
    an axis at right angles to its arm, the line from the middle to it, so that one overhead moves as far as any other.

    Parameters
    ----------
    number : int       of the frame; 0 is the scene as it is
    bounds : (8, 3)    corners of the box around the surfaces [scene unit]
    """
    middle, angle = bounds.mean(axis=0), SWAY * np.sin(number)
    # right, up and forward
    axes = (scene.camera.to_world[:3, :3] / np.linalg.norm(scene.camera.to_world[:3, :3], axis=0)).T
    turn = _turn(axes[1], angle, middle)
    return replace(
        scene,
        camera=replace(scene.camera, to_world=turn @ scene.camera.to_world),
        lights=tuple(_moved_light(light, angle, middle, axes) for light in scene.lights),
    )


def _moved_light(light: Light, angle: float, middle: Array, axes: Array) -> Light:
    """Turn a light about the middle, towards that of the eye's axes, (3, 3), from which its arm is farthest."""
    arm = -light.direction if light.kind == "directional" else light.position - middle
    # a light in the middle itself stays there, and a spot's frame turns with it
    length = np.linalg.norm(arm)
    arm = arm / length if length > 0 else axes[1]
    axis = np.cross(arm, axes[np.argmin(np.abs(axes @ arm))])
    turn = _turn(axis / np.linalg.norm(axis), angle, middle)
    return replace(light, to_world=turn @ light.to_world, position=turn[:3, :3] @ light.position + turn[:3, 3])


def _turn(axis: Array, angle: float, middle: Array) -> Array:
    """Rotation about an axis through a point, (4, 4) (Rodrigues 1840)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = np.eye(4)
    turn[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    turn[:3, 3] = middle - turn[:3, :3] @ middle
    return turn
