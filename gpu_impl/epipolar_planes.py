"""Planes through the axis from the eye to a light: the slices of the lattice `epipolar`, the rows of `min_max`.

Each ray of the eye lies in one half-plane that ends in the axis, at the angle alpha around it, and so do the light rays
that cross it. That holds wherever the light is: in the picture, beside it, behind the eye, or infinitely far. In the
picture the axis is a point, the epipole, and the half-planes are lines that run from it; where the axis is parallel to
the image they are parallel lines. Angles in space need none of these cases.

Source: Engelhardt and Dachsbacher 2010, "Epipolar Sampling for Shadows and Crepuscular Rays in Participating Media with
Single Scattering"; Chen, Baran, Durand and Jarosz 2011, "Real-Time Volumetric Shadows using 1D Min-Max Mipmaps", whose
alpha this is.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from scenes.model import Array, Camera, Light

# how much of a pixel is cut off the image's borders: the centres of its pixels stay inside, by a hair
INSET = 0.49


def border_pixels(camera: Camera, step: int) -> int:
    """How many planes serve an image: one for every `step`-th pixel of its border, and two at least.

    Engelhardt and Dachsbacher 2010 end their slices in evenly spread pixels of the border. Planes are evenly spread in
    angle instead, and neighbours are furthest apart in the corner that is furthest from the epipole: in a narrow view
    of a square image by pi / 2^1.5 = 1.11 steps with the epipole in its middle, by twice that with it in a corner.
    """
    return max(2, -(-2 * (camera.width + camera.height) // step))


@dataclass(frozen=True)
class EpipolarPlanes:
    """Evenly spread half-planes that cover what the eye sees; read by shaders/epipolar_planes.glsl.

    Attributes
    ----------
    axis : (3,)           unit length, from the eye towards the light
    sides : (2, 3)        unit vectors across it, at alpha = 0 and at alpha = pi / 2
    first, step : float   alpha of the first plane, and from each to the next [rad]
    count : int           how many there are
    is_closed : bool      whether they go all around, so that the first is the last one's neighbour
    """

    axis: Array
    sides: Array
    first: float
    step: float
    count: int
    is_closed: bool

    @classmethod
    def of(cls, camera: Camera, light: Light, count: int) -> EpipolarPlanes:
        """Spread `count` planes over the image that a camera takes."""
        rotation = camera.to_world[:3, :3]
        to_light = -light.direction if light.kind == "directional" else light.position - camera.origin
        distance = np.linalg.norm(to_light)
        # a light in the eye has any axis: all light rays are rays of the eye
        axis = to_light / distance if distance > 0 else rotation[:, 0]
        sides = _across(axis, rotation[:, 2])
        edges = _edges(camera)
        local = axis @ rotation
        if np.all(np.abs(local[:2]) <= abs(local[2]) * edges):
            # the picture has the light in it, or the point that is opposite
            return cls(axis, sides, -np.pi, 2 * np.pi / count, count, is_closed=True)
        # Without the axis in it the image spans less than half a turn, and the middle of it is at alpha = 0.
        corners = np.array([(x, y, 1.0) for x, y in itertools.product(*([-edge, edge] for edge in edges))])
        across = corners @ rotation.T @ sides.T
        alpha = np.arctan2(across[:, 1], across[:, 0])
        return cls(axis, sides, alpha.min(), np.ptp(alpha) / (count - 1), count, is_closed=False)

    @property
    def uniforms(self) -> dict[str, Any]:
        """Uniforms of shaders/epipolar_planes.glsl."""
        return {
            "epipolar_axis": tuple(self.axis),
            "plane_sides": [tuple(side) for side in self.sides],
            "plane_angles": (self.first, self.step),
            "plane_count": self.count,
            "planes_closed": int(self.is_closed),
        }


def _across(axis: Array, view: Array) -> Array:
    """Two unit vectors across the axis, the first towards the middle of the image, (2, 3)."""
    side = view - axis * (view @ axis)
    if np.linalg.norm(side) < 1e-6:
        # the eye looks along the axis, and any will do
        side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    side = side / np.linalg.norm(side)
    return np.stack([side, np.cross(axis, side)])


def _edges(camera: Camera) -> Array:
    """Half the image's width and height on the plane at distance 1, less `INSET` of a pixel on each side, (2,)."""
    pixels = np.array([camera.width, camera.height])
    return np.array([camera.tan_half_x, camera.tan_half_y]) * (1 - 2 * INSET / pixels)
