"""The scenes that airlight ships, and how a name becomes a file."""

from __future__ import annotations

import os
from pathlib import Path

from scenes.errors import InputError
from scenes.file_names import check_name

FOLDER = Path(__file__).parent


def shipped() -> list[str]:
    """Names of the shipped scenes."""
    return sorted(path.stem for path in FOLDER.glob("*.xml"))


def scene_path(scene: str | Path) -> Path:
    """Find a scene's file: any path, or the name of a shipped scene."""
    check_name(scene)
    asked = Path(scene)
    # os.path's answer to a name that is too long or holds a zero byte is no, where Path's is an exception
    if os.path.isfile(asked):
        # its folder's name too: what a scene names is looked for beside it
        check_name(asked.absolute())
        return asked
    if asked.name == str(scene) and asked.name.removesuffix(".xml") in shipped():
        return FOLDER / f"{asked.name.removesuffix('.xml')}.xml"
    raise InputError(
        f"There is no scene '{scene}': give the path of a Mitsuba XML file or one of {', '.join(shipped())}."
    )
