"""Where a mesh named in a scene comes from: the scene's folder, the user's meshes, or one made by our own code."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Literal

import platformdirs

from scenes.errors import InputError
from scenes.meshes import procedural
from scenes.meshes.readers import read_mesh
from scenes.meshes.triangles import Triangles, ply_bytes, vertex_normals
from scenes.replacing import CACHE_CURE, make_folder, replacing

__all__ = ["MeshFile", "Triangles", "available", "find_mesh", "read_mesh", "sha256", "vertex_normals"]

VARIABLE = "AIRLIGHT_MESH_DIR"
Origin = Literal["scene", "mesh folder", "user data", "generated", "stand-in"]


@dataclass(frozen=True)
class MeshFile:
    """A mesh file that exists.

    Attributes
    ----------
    name : str      the bare file name, as scenes write it
    path : Path     absolute path
    origin : str    "scene" (named by its own path), "mesh folder" (AIRLIGHT_MESH_DIR), "user data", "generated" (made
                    by our code and meant to be), "stand-in" (made by our code in place of a mesh that is not here)
    """

    name: str
    path: Path
    origin: Origin

    @property
    def is_stand_in(self) -> bool:
        """Whether this is not the mesh that the scene's author meant."""
        return self.origin == "stand-in"


def find_mesh(filename: str, scene_folder: Path) -> MeshFile:
    """The file that `filename` of a scene stands for.

    In this order: `filename` itself, relative to the scene's folder; its bare name in the folders of
    AIRLIGHT_MESH_DIR; in the user's data folder for airlight; made by scenes.meshes.procedural, in the
    user's cache folder.
    An absolute path is taken at its word: a missing file is an error, never replaced.

    Raises
    ------
    InputError   there is no such mesh, a folder of meshes cannot be read or AIRLIGHT_MESH_DIR names a missing one, or
                 the cache cannot be written
    """
    own = Path(scene_folder, filename).absolute()
    if os.path.isfile(own):
        return MeshFile(own.name, own, "scene")
    if Path(filename).is_absolute():
        raise InputError(f"{filename}: there is no such file; correct the scene, or name the mesh without a folder.")
    found = _find_by_name(own.name)
    if found is None:
        places = ", ".join(str(folder) for folder in [own.parent, *(folder for folder, _ in _folders())])
        raise InputError(
            f"The mesh '{filename}' is in none of {places} and is none that airlight makes "
            f"({', '.join(sorted(procedural.RECIPES))}); put the file there or set {VARIABLE} to its folder."
        )
    if found.origin in ("generated", "stand-in"):
        _make(found)
    return found


def available() -> list[MeshFile]:
    """Every mesh that a scene can name without a folder, by name, each from where it would come now.

    A mesh of our own making is listed with the path it has, or will have once a scene asks for it.

    Raises
    ------
    InputError   a folder of meshes cannot be read, or AIRLIGHT_MESH_DIR names a missing one
    """
    names = set(procedural.RECIPES)
    for folder, _ in _folders():
        if os.path.isdir(folder):
            names |= {entry.name for entry in folder.iterdir() if entry.suffix.lower() in (".ply", ".obj")}
    found = [_find_by_name(name) for name in sorted(names)]
    return [mesh for mesh in found if mesh is not None]


def sha256(path: Path | str) -> str:
    """Hexadecimal SHA-256 of a file's bytes, computed again only when its size or time of change differ."""
    try:
        status = os.stat(path)
        return _sha256(str(path), status.st_size, status.st_mtime_ns)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path and its permissions.") from None


@lru_cache(maxsize=256)
def _sha256(path: str, size: int, modified: int) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def user_folder() -> Path:
    """The user's own folder of meshes, into which `airlight meshes fetch` puts them; it need not exist."""
    return platformdirs.user_data_path("airlight") / "meshes"


def _folders() -> list[tuple[Path, Origin]]:
    """Folders that are searched by bare name, in order. Those of the variable must exist; the user's own need not."""
    folders: list[tuple[Path, Origin]] = []
    for part in filter(None, os.environ.get(VARIABLE, "").split(os.pathsep)):
        if not os.path.isdir(part):
            raise InputError(f"{VARIABLE} names the folder {part}, which does not exist; correct it or unset it.")
        _check_readable(Path(part), f"make it so, or correct {VARIABLE}, which names it")
        folders.append((Path(part).absolute(), "mesh folder"))
    own = user_folder()
    if os.path.isdir(own):
        _check_readable(own, "make it so, or set XDG_DATA_HOME to another folder")
    return [*folders, (own, "user data")]


def _check_readable(folder: Path, cure: str) -> None:
    # the meshes in it would seem not to be there, and stand-ins would serve without a word
    if not os.access(folder, os.R_OK | os.X_OK):
        raise InputError(f"The folder {folder} is not readable for you: {cure}.")


def _find_by_name(name: str) -> MeshFile | None:
    for folder, origin in _folders():
        if os.path.isfile(folder / name):
            return MeshFile(name, folder / name, origin)
    if name in procedural.RECIPES:
        path = platformdirs.user_cache_path("airlight") / "meshes" / name
        return MeshFile(name, path, "stand-in" if procedural.RECIPES[name].stands_in else "generated")
    return None


def _make(mesh: MeshFile) -> None:
    """Write a mesh of ours into the user's cache folder, unless the recorded bytes are there already."""
    name, path, recipe = mesh.name, mesh.path, procedural.RECIPES[mesh.name]
    if path.is_file() and sha256(path) == recipe.sha256:
        return
    data = ply_bytes(recipe.make())
    if hashlib.sha256(data).hexdigest() != recipe.sha256:
        # Results would be compared under one name for two meshes.
        raise InputError(
            f"The mesh '{name}' came out different from the recorded one on this machine; install the versions of "
            f"requirements.lock (marching cubes are scikit-image's), or put a mesh of that name into {VARIABLE}."
        )
    make_folder(path.parent, CACHE_CURE)
    with replacing(path, CACHE_CURE) as beside:
        beside.write_bytes(data)
