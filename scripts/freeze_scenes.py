"""Writes scenes/manifest.toml: the versions of the shipped scenes, and the hashes by which they are known again.

    AIRLIGHT_MESH_DIR=folder/of/the/meshes .venv/bin/python scripts/freeze_scenes.py

A scene of which anything differs from what the manifest has (its file, a mesh, a phase function) gets the next
number; they count from the first release of the manifest.
Without AIRLIGHT_MESH_DIR the meshes that are not of our making keep the hashes they have. The hash of a fetched mesh
comes from the one in the user's data folder, where its note says that it was made as the catalogue has it today; one
that was not known before changes no number.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

from scenes import InputError, load
from scenes.catalogue import FOLDER, shipped
from scenes.manifest import PATH, FrozenMesh, Manifest, manifest, text_sha256
from scenes.meshes.catalogue import made_as_now
from scenes.meshes.files import sha256, user_folder
from scenes.meshes.notes import read_note
from scenes.meshes.procedural import RECIPES
from scenes.replacing import replacing


def main() -> None:
    """Freeze the scenes as they are."""
    try:
        old = manifest() if PATH.is_file() else Manifest({}, {}, {})
        new = freeze(old)
    except InputError as error:
        print(error, file=sys.stderr)
        raise SystemExit(2) from None
    with replacing(PATH) as beside:
        beside.write_text(to_toml(new), encoding="utf-8")
    for name, number in new.versions.items():
        print(f"{name} {number}{'' if number == old.versions.get(name) else ' (new)'}")


def freeze(old: Manifest) -> Manifest:
    """The manifest of the scenes as they are, numbered on from `old`.

    Raises
    ------
    InputError
        A scene cannot be loaded, or a mesh that it means was never seen.
    """
    texts = sorted([*FOLDER.glob("*.xml"), *FOLDER.glob("phase/*.xml")])
    files = {path.relative_to(FOLDER).as_posix(): text_sha256(path) for path in texts}
    shared = any(files.get(name) != known for name, known in old.files.items() if "/" in name)
    versions: dict[str, int] = {}
    meshes: dict[str, FrozenMesh] = {}
    for name in shipped():
        used = {mesh.file.name: mesh.file.path for mesh in load(name).meshes if mesh.file}
        here = {mesh: _frozen(mesh, path, old) for mesh, path in used.items()}
        same = (
            not shared
            and files[f"{name}.xml"] == old.files.get(f"{name}.xml")
            and all(_same_mesh(old.meshes.get(mesh), frozen) for mesh, frozen in here.items())
        )
        versions[name] = old.versions.get(name, 0) + (not same)
        meshes |= here
    return Manifest(versions, files, dict(sorted(meshes.items())))


def _frozen(name: str, path: Path, old: Manifest) -> FrozenMesh:
    recipe = RECIPES.get(name)
    ours = recipe.sha256 if recipe else None
    if recipe and not recipe.stands_in:
        return FrozenMesh(ours=ours)
    known, fetched, found = old.meshes.get(name, FrozenMesh()), _fetched(name), sha256(path)
    reference = known.reference if found in (ours, fetched, known.fetched) else found
    if reference is None:
        raise InputError(
            f"The mesh '{name}' is here only as a stand-in or as it is fetched; set AIRLIGHT_MESH_DIR to the folder of "
            "the one that is meant."
        )
    return FrozenMesh(reference, fetched or known.fetched, ours)


def _fetched(name: str) -> str | None:
    """Hash of the fetched mesh in the user's data folder, if it was made from the original by the steps of today."""
    path = user_folder() / name
    note = read_note(path) if path.is_file() else None
    return note.sha256 if note and note.name == name and made_as_now(note) else None


def _same_mesh(old: FrozenMesh | None, new: FrozenMesh) -> bool:
    # where no original had been at hand, nobody can hold a result under the hash that is known now
    return old is not None and old in (new, replace(new, fetched=None))


def to_toml(frozen: Manifest) -> str:
    """The manifest as text."""
    lines = ["# Frozen scenes; written by scripts/freeze_scenes.py, read by scenes/manifest.py.", "", "[versions]"]
    lines += [f"{name} = {number}" for name, number in frozen.versions.items()]
    lines += ["", "# SHA-256 of the text", "[files]"]
    lines += [f'"{name}" = "{found}"' for name, found in frozen.files.items()]
    lines += [
        "",
        "# SHA-256 of the bytes of the mesh that is meant, of the fetched one, of the one that our code makes",
    ]
    for name, mesh in frozen.meshes.items():
        lines += ["", f'[meshes."{name}"]']
        lines += [f'{key} = "{value}"' for key in ("reference", "fetched", "ours") if (value := getattr(mesh, key))]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
