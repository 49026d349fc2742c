"""The sensor of a scene file."""

from __future__ import annotations

import numpy as np

from scenes.errors import InputError
from scenes.model import Array, Camera
from scenes.xml_nodes import Node

LARGEST_SIDE = 16384


def load_camera(node: Node, size: tuple[int, int] | None, to_world: Array | None = None) -> tuple[Camera, Node | None]:
    """Read a sensor and its film; its size and its place are replaced by `size` and `to_world` where they are given.

    Returns
    -------
    camera : Camera
    medium : Node or None    the medium that the camera is in

    Raises
    ------
    InputError
        Another plugin, a property that airlight does not know, or values that no camera can have.
    """
    if node.plugin != "perspective":
        raise node.refuse("is not supported; use perspective.")
    film = node.child("Film")
    width, height = _film_size(node, film, size)
    if to_world is not None:
        node.place(to_world)
    to_world = node.transform()
    if not np.allclose(to_world[:3, :3].T @ to_world[:3, :3], np.eye(3), atol=1e-5):
        raise node.refuse("has a 'to_world' that scales or shears; use <lookat>, rotations and translations.")
    near, far = node.number("near_clip", 1e-2), node.number("far_clip", 1e4)
    if not 0 < near < far:
        raise node.refuse(f"has near_clip = {near} and far_clip = {far}; it should be 0 < near_clip < far_clip.")
    tan_half_x = _tan_half_x(node, width / height)
    medium = node.child("Medium")
    # nothing moves while the shutter is open
    node.ignore("shutter_open", "shutter_close")
    for name in ("principal_point_offset_x", "principal_point_offset_y"):
        if node.number(name, 0.0):
            raise node.refuse(f"has a '{name}', which is not supported; centre the camera.")
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
            check_size((width, height))
    else:
        width, height = size
    # how the film stores its pixels and reconstructs them: airlight evaluates pixel centres and writes float32 EXR
    film.ignore("file_format", "pixel_format", "component_format", "banner", "compensate", "sample_border")
    for name in ("crop_width", "crop_height", "crop_offset_x", "crop_offset_y"):
        if name in film.unread:
            raise film.refuse(f"has a '{name}', which is not supported; leave the crop out.")
    film.children("ReconstructionFilter")
    film.finish()
    film.props["width"], film.props["height"] = width, height
    return width, height


def check_size(size: tuple[int, int]) -> None:
    """Raise InputError where no image has this size."""
    width, height = size
    if not all(isinstance(side, int | np.integer) and 1 <= side <= LARGEST_SIDE for side in (width, height)):
        raise InputError(f"An image of {width} x {height} pixels cannot be made: use 1 to {LARGEST_SIDE} on each side.")


def _tan_half_x(node: Node, aspect: float) -> float:
    """Tangent of half the horizontal field of view, from Mitsuba's `fov` and `fov_axis`, or from its `focal_length`."""
    if "fov" not in node.unread:
        return _tan_half_x_of_lens(node, aspect)
    if "focal_length" in node.unread:
        raise node.refuse("has a 'focal_length' and a 'fov'; leave one out.")
    fov = node.number("fov")
    tan_half = float(np.tan(np.radians(fov) / 2))
    # near 180 degrees float32 has no digits left
    if not (0 < fov < 180 and 1e-6 < tan_half < 1e3):
        raise node.refuse(f"has 'fov' = {fov}, which should lie between 0 and 180 degrees.")
    axis = node.text("fov_axis", "x")
    if axis in ("smaller", "larger"):
        axis = "y" if (aspect > 1) == (axis == "smaller") else "x"
    if axis not in ("x", "y", "diagonal"):
        raise node.refuse(f"has fov_axis = '{axis}'; use x, y, diagonal, smaller or larger.")
    return tan_half * {"x": 1.0, "y": aspect, "diagonal": aspect / float(np.hypot(1, aspect))}[axis]


def _tan_half_x_of_lens(node: Node, aspect: float) -> float:
    """As above, from the focal length of a lens before a 36 x 24 mm film, whose diagonal the image keeps."""
    text = node.text("focal_length", "50mm")
    try:
        focal_length = float(text.removesuffix("mm"))
    except ValueError:
        focal_length = 0.0
    if not 0.02 < focal_length < 1e5:
        raise node.refuse(f"has 'focal_length' = '{text}', which should be a length such as 50mm.")
    return float(np.hypot(36, 24)) / 2 / focal_length * aspect / float(np.hypot(1, aspect))
