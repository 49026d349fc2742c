"""What is in the cache, told from the heads of the files: no array is read."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from stat import S_ISREG
from typing import Any, BinaryIO

from reference.cache import entry_file
from reference.cache.entry_file import DamagedError, OldFormatError, Record
from reference.cache.store import SET_ASIDE, folder, key
from scenes.errors import InputError

_ENTRY = re.compile(r"[0-9a-f]{64}\.npz")
_SET_ASIDE = re.compile(rf"[0-9a-f]{{64}}\{SET_ASIDE}")
# as scenes.replacing names what it writes beside an entry
_LEFTOVER = re.compile(r"\.[0-9a-f]{40}-[0-9a-f]{8}\.part\.npz")


@dataclass(frozen=True)
class Entry:
    """One reference in the cache; what its file does not say is None.

    Attributes
    ----------
    path : Path
    size : int                       of the file [byte]
    last_used : float                when it was last stored or loaded [seconds since 1970]
    damaged : str                    what is wrong with the file; empty where it is whole, as far as was looked
    stale : str                      why no present estimate would take it; empty where one would
    scene : str                      name, as people know it
    parameters : dict                the scene's `$` parameters that were given
    image_size : (width, height)     [pixel]
    estimator, variant : str         which one, and the variant of Mitsuba under which it ran
    estimator_version : int
    rel_error, asked : float         relative standard error that was reached and that was asked for
    percentile : float               of the lit pixels, at which both are; of what is not sampled there is no goal
    finished : bool                  whether it ended by itself; the others can go on
    """

    path: Path
    size: int
    last_used: float
    damaged: str
    stale: str
    scene: str | None = None
    parameters: dict[str, str] = field(default_factory=dict)
    image_size: tuple[int, int] | None = None
    estimator: str | None = None
    estimator_version: int | None = None
    variant: str | None = None
    rel_error: float | None = None
    asked: float | None = None
    percentile: float | None = None
    finished: bool | None = None


@dataclass(frozen=True)
class OtherFiles:
    """What else lies in the folder.

    Attributes
    ----------
    set_aside : list of Path    damaged entries that were renamed
    leftovers : list of Path    what is being written, or was by a program that was killed
    foreign : list of Path      whatever is not of airlight's making
    """

    set_aside: list[Path]
    leftovers: list[Path]
    foreign: list[Path]


def entries(check_bytes: bool = False) -> list[Entry]:
    """Every entry, the last used first.

    Parameters
    ----------
    check_bytes : hold every byte of every file against its checksum, which takes as long as reading them; otherwise a
                  file counts as whole if its record and its end are

    Raises
    ------
    InputError
        A file cannot be read.
    """
    present = _present_versions()
    found = []
    for path in _files(lambda path: _is_ours(path, _ENTRY)):
        try:
            with path.open("rb") as file:
                found.append(_describe(path, file, check_bytes, present))
        except FileNotFoundError:  # somebody else removes it
            continue
        except OSError as error:
            raise InputError(f"{path} cannot be read ({error.strerror}): make it readable, or remove it.") from None
    return sorted(found, key=lambda entry: entry.last_used, reverse=True)


def other_files() -> OtherFiles:
    """Whatever lies beside the entries."""
    return OtherFiles(
        _files(lambda path: _is_ours(path, _SET_ASIDE)),
        _files(lambda path: _is_ours(path, _LEFTOVER)),
        _files(lambda path: not any(_is_ours(path, name) for name in (_ENTRY, _SET_ASIDE, _LEFTOVER))),
    )


def _files(wanted: Callable[[Path], bool]) -> list[Path]:
    try:
        return sorted(path for path in folder().iterdir() if wanted(path))
    except (FileNotFoundError, NotADirectoryError):
        return []
    except OSError as error:
        raise InputError(f"{folder()} cannot be listed ({error.strerror}): make it readable.") from None


def _is_ours(path: Path, name: re.Pattern[str]) -> bool:
    """Whether it has such a name, and is a file in this folder and no link to one elsewhere."""
    try:
        return bool(name.fullmatch(path.name)) and S_ISREG(path.lstat().st_mode)
    except FileNotFoundError:
        return False


def _describe(path: Path, file: BinaryIO, check_bytes: bool, present: dict[str, Any]) -> Entry:
    status = path.stat()
    damaged, stale, record = "", "", None
    try:
        record = entry_file.read_record(file)
        if key(record["recipe"]) != path.stem:
            raise DamagedError("it is the entry of another recipe")
        if check_bytes:
            entry_file.check(file)
        stale = _why_stale(record["recipe"], present)
    except DamagedError as error:
        damaged = str(error)
    except OldFormatError:
        stale = "written by an earlier airlight"
    return Entry(path, status.st_size, status.st_mtime, damaged, stale, **_told(record))


def _told(record: Record | None) -> dict[str, Any]:
    """What a record tells, wherever in it or in its recipe that stands."""
    if record is None:
        return {}
    told = record | record["recipe"]
    return {
        "scene": told.get("scene_name"),
        "parameters": told.get("parameters", {}),
        "image_size": tuple(told["size"]) if "size" in told else None,
        "estimator": told.get("estimator"),
        "estimator_version": told.get("estimator_version"),
        "variant": told.get("variant"),
        "rel_error": told.get("rel_error"),
        "asked": told.get("goal", {}).get("rel_error"),
        "percentile": told.get("goal", {}).get("percentile"),
        "finished": told.get("finished"),
    }


def _present_versions() -> dict[str, Any]:
    """Versions that a recipe of today names; an estimator's under its own name."""
    # loads Mitsuba
    from reference.deterministic import Deterministic
    from reference.estimators import Equiangular, FilmVolpath

    estimators = {estimator.name: estimator.version for estimator in (Deterministic, Equiangular, FilmVolpath)}
    return estimators | {package: version(package) for package in ("mitsuba", "drjit")}


def _why_stale(recipe: Record, present: dict[str, Any]) -> str:
    """Which version of a recipe is not the present one; empty where all are."""
    made = {package: recipe.get(package) for package in ("mitsuba", "drjit")}
    made[str(recipe.get("estimator"))] = recipe.get("estimator_version")
    return ", ".join(
        f"{name} {made[name]}, now {present.get(name, 'gone')}" for name in made if made[name] != present.get(name)
    )
