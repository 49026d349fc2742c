"""The scenes that airlight ships, and how a name becomes a file."""

from __future__ import annotations

from pathlib import Path

from scenes.errors import InputError

FOLDER = Path(__file__).parent


def shipped() -> list[str]:
    """Names of the shipped scenes."""
    return sorted(path.stem for path in FOLDER.glob("*.xml"))


def scene_path(scene: str | Path) -> Path:
    """Find a scene's file: any path, or the name of a shipped scene."""
    asked = Path(scene)
    if asked.is_file():
        return asked
    named = FOLDER / f"{asked.name.removesuffix('.xml')}.xml"
    if asked.name == str(scene) and named.is_file():
        return named
    raise InputError(
        f"There is no scene '{scene}': give the path of a Mitsuba XML file or one of {', '.join(shipped())}."
    )
