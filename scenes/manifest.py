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

from scenes.errors import InputError
from scenes.meshes.files import sha256
from scenes.model import Scene

PATH = Path(__file__).with_name("manifest.toml")


@dataclass(frozen=True)
class FrozenMesh:
    """The files that serve under one mesh's name, by the SHA-256 of their bytes, hexadecimal.

    Attributes
    ----------
    reference : str or None    the mesh that the scene means, where it is not of our making
    fetched : str or None      what `airlight meshes fetch` made of its original, on the machine that froze it; None
                               where no original was at hand
    ours : str or None         the one that scenes.meshes.procedural makes: the mesh itself, or a stand-in
    """

    reference: str | None = None
    fetched: str | None = None
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
    """Read the manifest.

    Raises
    ------
    InputError   it is missing, or is not what scripts/freeze_scenes.py writes
    """
    # here, as its import takes longer than that of the rest of this module
    from pydantic import TypeAdapter, ValidationError

    try:
        held = tomllib.loads(path.read_text(encoding="utf-8"))
        return TypeAdapter(Manifest).validate_python(held)
    except OSError as error:
        reason = f"cannot be read ({error.strerror})"
    except (ValueError, RecursionError) as error:
        where = error.errors()[0]["loc"] if isinstance(error, ValidationError) else ()
        reason = f"is damaged ({'.'.join(map(str, where)) or error})"
    raise InputError(f"{path} {reason}: restore it from the repository, or install airlight again with `make setup`.")


def frozen_version(scene: Scene) -> str:
    """Name the version of a shipped scene, or say that it is none.

    Returns
    -------
    str
        "dragon 1 (reference meshes)", "dragon 1 (fetched meshes)", "dragon 1 (stand-ins)"; where they are mixed, which
        are not the reference: "many_objects 1 (fetched dragon_res3_fixed.ply; stand-ins for spot.ply)"; "slit 1" for a
        scene whose meshes are all our own; or "unfrozen: " and the reason

    Raises
    ------
    InputError
        The manifest, or a file of the scene, cannot be read.
    """
    frozen = manifest()
    if scene.name not in frozen.versions:
        return "unfrozen: no shipped scene"
    name = f"{scene.name} {frozen.versions[scene.name]}"
    if text_sha256(scene.path) != frozen.files.get(f"{scene.name}.xml"):
        return f"unfrozen: {scene.path.name} differs from {name}"
    for file in included(scene):
        if text_sha256(scene.path.parent / file) != frozen.files.get(file):
            return f"unfrozen: {file} differs from {name}"
    reference: list[str] = []
    fetched: list[str] = []
    stand_ins: list[str] = []
    for mesh in {mesh.file.name: mesh.file for mesh in scene.meshes if mesh.file}.values():
        known, found = frozen.meshes.get(mesh.name, FrozenMesh()), sha256(mesh.path)
        if found not in (known.reference, known.fetched, known.ours):
            return f"unfrozen: {mesh.name} differs from {name}"
        if known.reference:
            kind = {known.ours: stand_ins, known.fetched: fetched, known.reference: reference}[found]
            kind.append(mesh.name)
    return f"{name}{_kinds_of_meshes(reference, fetched, stand_ins)}"


def _kinds_of_meshes(reference: list[str], fetched: list[str], stand_ins: list[str]) -> str:
    """In brackets, of which kind the meshes are that are not of our making: of one kind, or which are not reference."""
    if not fetched and not stand_ins:
        return " (reference meshes)" if reference else ""
    if not reference and not (fetched and stand_ins):
        return " (fetched meshes)" if fetched else " (stand-ins)"
    kinds = (("fetched", fetched), ("stand-ins for", stand_ins))
    parts = [f"{kind} {', '.join(sorted(names))}" for kind, names in kinds if names]
    return f" ({'; '.join(parts)})"


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
