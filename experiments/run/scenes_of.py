"""The scenes of a run, looked at before its first case."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from experiments.scene_notices import scene_notices
from experiments.suite.cases import Case
from scenes.errors import InputError
from scenes.loader import load
from scenes.meshes.files import sha256


@dataclass(frozen=True)
class ScenesOf:
    """What the scenes of some cases hold.

    Attributes
    ----------
    digests : tuple    of each scene with its parameters, meshes and pictures, and of committed references
    notices : tuple    what is not as the files have it, such as stand-in meshes, as sentences
    """

    digests: tuple[str, ...]
    notices: tuple[str, ...]


def look_at_scenes(cases: Sequence[Case]) -> ScenesOf:
    """Load every scene once with each of its parameters, as large as its first case has it.

    Raises
    ------
    InputError
        A scene cannot be loaded, or a folder with committed references is missing.
    """
    digests: dict[str, str] = {}
    notices: dict[str, None] = {}
    for case in cases:
        key = json.dumps([case.scene, dict(case.parameters)], sort_keys=True)
        if key not in digests:
            scene = load(case.scene, case.size, **case.parameters)
            digests[key] = scene.digest
            notices.update(dict.fromkeys(scene_notices(scene)))
        if (folder := case.reference.folder) and folder not in digests:
            digests[folder] = _digest_of_folder(Path(folder))
    return ScenesOf(tuple(digests.values()), tuple(notices))


def _digest_of_folder(folder: Path) -> str:
    if not folder.is_dir():
        raise InputError(f"There is no folder {folder} with committed references; correct 'reference.folder'.")
    return " ".join(sha256(path) for path in sorted(folder.iterdir()) if path.is_file())
