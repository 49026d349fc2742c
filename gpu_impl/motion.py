"""A scene whose eye and lights move a little from frame to frame, so that a timed frame has nothing to reuse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scenes.model import Scene

Array = np.ndarray
# Farthest turn about the middle of the scene. A degree moves the eye by a sixtieth of its distance: every pixel and
# every texel sees something else, and the picture costs what it cost before.
SWAY = np.radians(1.0)


def moved(scene: Scene, number: int, bounds: Array) -> Scene:
    """Return the scene of frame `number`: the eye turned about the middle of the bounds, the lights the other way.

    The turn is `SWAY` sin(number), which no two frames share.

    Parameters
    ----------
    number : int       of the frame; 0 is the scene as it is
    bounds : (8, 3)    corners of the box around the surfaces [scene unit]
    """
    middle, axis = bounds.mean(axis=0), scene.camera.to_world[:3, 1]
    turn = _turn(axis / np.linalg.norm(axis), SWAY * np.sin(number), middle)
    back = np.linalg.inv(turn)
    return replace(
        scene,
        camera=replace(scene.camera, to_world=turn @ scene.camera.to_world),
        lights=tuple(
            replace(light, to_world=back @ light.to_world, position=back[:3, :3] @ light.position + back[:3, 3])
            for light in scene.lights
        ),
    )


def _turn(axis: Array, angle: float, middle: Array) -> Array:
    """Rotation about an axis through a point, (4, 4) (Rodrigues 1840)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn = np.eye(4)
    turn[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    turn[:3, 3] = middle - turn[:3, :3] @ middle
    return turn
