"""Pages of results: a folder with a README.md that a command writes anew each time."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

from experiments.provenance import environment, package_version
from scenes.errors import InputError
from scenes.replacing import make_folder

__all__ = ["made_by", "prepare_page"]


def prepare_page(folder: Path, title: str) -> None:
    """Make the folder before the work begins, and see that its README.md, if it has one, is of the same title.

    Raises
    ------
    InputError
        If the folder cannot be made or written to, or its README.md is somebody else's.
    """
    cure = "choose another --out"
    make_folder(folder, cure)
    page = folder / "README.md"
    if page.exists() and not page.read_text(encoding="utf-8", errors="replace").startswith(f"# {title}\n"):
        raise InputError(f"{page} is another page, and would be lost: {cure}.")


def made_by(command: str, *packages: str) -> str:
    """Lines of a page that say which command made it, when, and with what."""
    known = environment()
    versions = ", ".join(f"{name} {package_version(name)}" for name in packages)
    return (
        f"Made on {datetime.now(UTC):%Y-%m-%d} at commit {known['commit']} by\n\n    {command}\n\n"
        f"with airlight {known['airlight']}, Python {known['python']}, {versions}."
    )
