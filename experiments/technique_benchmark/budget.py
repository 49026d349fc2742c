"""A scene within a budget of triangles: its meshes decimated, for its frames and its reference alike."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import platformdirs

from scenes.errors import InputError
from scenes.loader import load
from scenes.meshes.files import VARIABLE, MeshFile, sha256
from scenes.meshes.polygons import as_triangles, read_polygons
from scenes.meshes.steps import decimate
from scenes.meshes.triangles import ply_bytes
from scenes.model import Mesh, Scene
from scenes.replacing import CACHE_CURE, make_folder, replacing

# a closed surface has no fewer
FEWEST_TRIANGLES = 4


def triangle_count(scene: Scene) -> int:
    """Triangles of all meshes."""
    return sum(len(mesh.faces) for mesh in scene.meshes)


def load_within(name: str | Path, triangles: int, size: tuple[int, int] | None = None, **parameters: Any) -> Scene:
    """Load a scene as `scenes.loader.load` does, with meshes from files decimated to about `triangles` in all.

    Each mesh keeps the same share of its triangles (Garland and Heckbert 1997, see `scenes.meshes.steps.decimate`). The
    decimated files are kept in the user's cache folder, where the scene finds them by AIRLIGHT_MESH_DIR's rules: both
    renderers get them as they get any mesh; a decimated stand-in is still called one. Analytic shapes stay as they are,
    and so does a scene within the budget.

    Raises
    ------
    InputError
        As `load`; or what is no file has more triangles than the budget, or a mesh is named with its folder or is no
        PLY file.
    """
    scene = load(name, size, **parameters)
    count = triangle_count(scene)
    if count <= triangles:
        return scene
    files = {mesh.file.name: mesh.file for mesh in scene.meshes if mesh.file}
    from_files = sum(len(mesh.faces) for mesh in scene.meshes if mesh.file)
    share = (triangles - (count - from_files)) / max(from_files, 1)
    if share <= 0:
        raise InputError(
            f"{scene.name} has {count - from_files} triangles that are in no mesh file, and the budget is {triangles}: "
            "raise it, or leave the scene out."
        )
    for file in files.values():
        if file.origin == "scene" or file.path.suffix.lower() != ".ply":
            raise InputError(
                f"{file.path} stays as it is: only PLY files that a scene names without a folder can be decimated."
            )
    with _searched_first(_decimated(list(files.values()), share)):
        coarse = load(name, size, **parameters)
    return replace(coarse, meshes=tuple(_with_origin(mesh, files) for mesh in coarse.meshes))


def _with_origin(mesh: Mesh, files: dict[str, MeshFile]) -> Mesh:
    """Say of a decimated file where the whole one came from."""
    return replace(mesh, file=replace(mesh.file, origin=files[mesh.file.name].origin)) if mesh.file else mesh


def _decimated(files: list[MeshFile], share: float) -> Path:
    """Folder in which each mesh has `share` of its triangles."""
    key = hashlib.sha256(repr((share, sorted((file.name, sha256(file.path)) for file in files))).encode()).hexdigest()
    folder = platformdirs.user_cache_path("airlight") / "decimated" / key[:16]
    make_folder(folder, CACHE_CURE)
    for file in files:
        if (path := folder / file.name).is_file():
            continue
        mesh = read_polygons(file.path)
        coarse = decimate(mesh, max(int(share * len(mesh.sides)), FEWEST_TRIANGLES))
        with replacing(path, CACHE_CURE) as beside:
            beside.write_bytes(ply_bytes(as_triangles(coarse)))
    return folder


@contextmanager
def _searched_first(folder: Path) -> Iterator[None]:
    """Meanwhile a mesh that is named alone is looked for in a folder before all others."""
    before = os.environ.get(VARIABLE)
    os.environ[VARIABLE] = os.pathsep.join(filter(None, (str(folder), before)))
    try:
        yield
    finally:
        if before is None:
            del os.environ[VARIABLE]
        else:
            os.environ[VARIABLE] = before
