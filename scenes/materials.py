"""BSDFs of a scene file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scenes.model import Array, Material, Texture
from scenes.textures import load_texture
from scenes.xml_nodes import Node

SUPPORTED = ("diffuse", "phong", "twosided")


def load_material(node: Node | None, scene_folder: Path) -> Material:
    """Read a BSDF; Mitsuba's default is diffuse with 0.5.

    Raises
    ------
    InputError
        Another plugin, a property that airlight does not know, or one that reflects more than it receives.
    """
    if node is None:
        return Material(np.full(3, 0.5), np.zeros(3), 0.0, two_sided=False)
    if node.plugin == "twosided":
        inner = node.children("BSDF")
        node.finish()
        if len(inner) != 1 or inner[0].plugin == "twosided":
            raise node.refuse("should hold one diffuse or phong BSDF for both sides.")
        return _one_sided(inner[0], scene_folder, two_sided=True)
    return _one_sided(node, scene_folder, two_sided=False)


def _one_sided(node: Node, scene_folder: Path, two_sided: bool) -> Material:
    if node.plugin == "null":
        raise node.refuse("bounds a medium, and this shape has none as its 'interior': add <ref name='interior' .../>.")
    if node.plugin not in SUPPORTED:
        raise node.refuse(f"is not supported; use {', '.join(SUPPORTED[:-1])} or {SUPPORTED[-1]}.")
    if node.plugin == "diffuse":
        diffuse, specular, exponent = _diffuse(node, "reflectance", scene_folder), np.zeros(3), 0.0
    else:
        diffuse = _diffuse(node, "diffuse_reflectance", scene_folder)
        specular = node.color("specular_reflectance", 0.2)
        exponent = node.number("exponent", 30.0)
        if not 0 <= exponent <= 1e4:
            raise node.refuse(f"has 'exponent' = {exponent}, which should lie between 0 and 10000.")
    node.finish()
    brightest = diffuse.pixels.max(axis=(0, 1)) if isinstance(diffuse, Texture) else diffuse
    # the rounding of 8-bit and float32 pictures is no gain of energy
    if (brightest + specular > 1 + 1e-6).any():
        what = "reflectance" if node.plugin == "diffuse" else "reflectances, diffuse and specular together,"
        raise node.refuse(f"has {what} of {(brightest + specular).tolist()}, which should be at most 1.")
    return Material(diffuse, specular, exponent, two_sided)


def _diffuse(node: Node, name: str, scene_folder: Path) -> Array | Texture:
    texture = node.nested(name)
    return node.color(name, 0.5) if texture is None else load_texture(texture, scene_folder)
