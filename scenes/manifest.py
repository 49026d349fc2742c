"""Which frozen version of a shipped scene a loaded one is, so that a result can name what it was made from.

`manifest.toml`, written by scripts/freeze_scenes.py, holds the hashes of the scene files, of the files they include and
of their meshes. Parameters and size are no part of a version: a result states them beside it.
"""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

from scenes.meshes.files import sha256
from scenes.model import Scene

PATH = Path(__file__).with_name("manifest.toml")


@dataclass(frozen=True)
class FrozenMesh:
    """The files that serve under one mesh's name, by the SHA-256 of their bytes, hexadecimal.

    Attributes
    ----------
    reference : str or None    the mesh that the scene means, where it is not of our making
    ours : str or None         the one that scenes.meshes.procedural makes: the mesh itself, or a stand-in
    """

    reference: str | None = None
    ours: str | None = None


@dataclass(frozen=True)
class Manifest:
    """What was frozen.

    Attributes
    ----------
    versions : dict   scene name to version number
    files : dict      XML file, relative to the scenes' folder, to the SHA-256 of its text
    meshes : dict     bare file name to FrozenMesh
    """

    versions: Mapping[str, int]
    files: Mapping[str, str]
    meshes: Mapping[str, FrozenMesh]


@lru_cache(maxsize=1)
def manifest(path: Path = PATH) -> Manifest:
    """Read the manifest."""
    held = tomllib.loads(path.read_text(encoding="utf-8"))
    meshes = {name: FrozenMesh(**hashes) for name, hashes in held["meshes"].items()}
    return Manifest(held["versions"], held["files"], meshes)


def frozen_version(scene: Scene) -> str:
    """Name the version of a shipped scene, or say that it is none.

    Returns
    -------
    str
        "dragon 1 (reference meshes)", "dragon 1 (stand-ins)", "many_objects 1 (stand-ins for spot.ply)", "slit 1" for
        a scene whose meshes are all our own; or "unfrozen: " and the reason
    """
    frozen = manifest()
    if scene.name not in frozen.versions:
        return "unfrozen: no shipped scene"
    name = f"{scene.name} {frozen.versions[scene.name]}"
    if text_sha256(scene.path) != frozen.files[f"{scene.name}.xml"]:
        return f"unfrozen: {scene.path.name} differs from {name}"
    for file in included(scene):
        if text_sha256(scene.path.parent / file) != frozen.files.get(file):
            return f"unfrozen: {file} differs from {name}"
    reference: set[str] = set()
    stand_ins: set[str] = set()
    for mesh in {mesh.file.name: mesh.file for mesh in scene.meshes if mesh.file}.values():
        known, found = frozen.meshes.get(mesh.name, FrozenMesh()), sha256(mesh.path)
        if found not in (known.reference, known.ours):
            return f"unfrozen: {mesh.name} differs from {name}"
        if known.reference:
            (reference if found == known.reference else stand_ins).add(mesh.name)
    if not reference and not stand_ins:
        return name
    if not stand_ins:
        return f"{name} (reference meshes)"
    return f"{name} (stand-ins)" if not reference else f"{name} (stand-ins for {', '.join(sorted(stand_ins))})"


def included(scene: Scene) -> list[str]:
    """Files that a scene's own file includes with the parameters it was loaded with, relative to its folder."""
    root = ElementTree.parse(scene.path).getroot()
    values = {default.get("name", ""): default.get("value", "") for default in root.iter("default")}
    names = []
    for include in root.iter("include"):
        name = include.get("filename", "")
        # the longest first, as $g begins $gamma too
        for parameter, value in sorted((values | scene.parameters).items(), key=lambda item: -len(item[0])):
            name = name.replace(f"${parameter}", value)
        names.append(name)
    return names


def text_sha256(path: Path) -> str:
    """Hexadecimal SHA-256 of a file's text; line ends of another system make no difference."""
    return hashlib.sha256(path.read_bytes().replace(b"\r\n", b"\n")).hexdigest()
