"""A technique of somebody's own: a TOML file that names registered parts and GLSL files (ADDING.md)."""

from __future__ import annotations

import hashlib
import json
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from gpu_impl.airlight_models import AIRLIGHT_MODELS, AirlightShader
from gpu_impl.lattices import LATTICES
from gpu_impl.own_files import DIGITS, OWN, OwnFiles
from gpu_impl.own_technique_schema import (
    NAMED,
    OF_A_FILE,
    AirlightPart,
    Described,
    LatticePart,
    Part,
    VisibilityPart,
)
from gpu_impl.techniques import Technique
from gpu_impl.visibilities import VISIBILITIES, Visibility
from scenes.errors import InputError
from scenes.messages import readable
from scenes.toml_places import Key, is_there, line_of


@dataclass(frozen=True)
class OwnTechnique(Technique):
    """A technique of somebody's own; it travels with the texts of its files, and so means the same in every process.

    Attributes
    ----------
    file : str     absolute path of the TOML file
    texts : str    JSON object: absolute path to text of it and of every GLSL file that it takes
    """

    file: str = ""
    texts: str = field(default="", repr=False)

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpacked, ({one.name: getattr(self, one.name) for one in fields(self)},)


def load_technique(path: Path) -> OwnTechnique:
    """Read a technique's file and make its parts known under names of their own.

    Raises
    ------
    InputError
        The file, or one of those that it names, is missing, or holds what no technique takes: in one sentence with the
        key and the line.
    """
    # one path for one file: a technique is the same wherever it is named from
    path = Path(os.path.normpath(path.absolute()))
    return _load(path, OwnFiles(path.parent))


def make_known(file: str, texts: str) -> None:
    """Make the parts of a technique known from the texts that it travels with, whatever its files hold now.

    Raises
    ------
    InputError, ValueError
        The texts are not those of a technique.
    """
    given = json.loads(texts)
    if not isinstance(given, dict) or not all(isinstance(text, str) for text in given.values()):
        raise ValueError("texts must be a JSON object of texts")
    path = Path(file)
    _load(path, OwnFiles(path.parent, given))


def _unpacked(values: Mapping[str, Any]) -> OwnTechnique:
    """What `OwnTechnique.__reduce__` packed, in a process that may not know its parts."""
    make_known(values["file"], values["texts"])
    return OwnTechnique(**values)


def _load(path: Path, files: OwnFiles) -> OwnTechnique:
    text = files.read(path)
    try:
        found = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path} is not TOML: {str(error).rstrip('.')}.") from None
    try:
        described = Described.model_validate(found)
    except ValidationError as error:
        # a key that is wrong explains one that is missing
        first = min(error.errors(), key=lambda one: one["type"] != "extra_forbidden")
        # without the kind of part that pydantic put between
        key = tuple(part for part in first["loc"] if part not in (NAMED, OF_A_FILE))
        while first["type"] != "missing" and len(key) > 1 and not is_there(found, key):
            key = key[:-1]
        raise _wrong(path, text, key, first["msg"].removeprefix("Value error, ")) from None
    technique = OwnTechnique(
        described.name,
        _visibility(described.visibility, path.parent, files),
        _airlight(described.airlight, path.parent, files),
        lattice=_lattice(described.lattice, path.parent, files),
        file=str(path),
    )
    for setting, value in described.settings.items():
        technique = replace(technique, **{setting: value})
        try:
            technique.check()
        except InputError as error:
            raise _wrong(path, text, ("settings", setting), str(error)) from None
    try:
        technique.check()
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    return replace(technique, texts=json.dumps(files.texts))


def _wrong(path: Path, text: str, key: Key, message: str) -> InputError:
    line = line_of(text, key)
    where = f" (line {line})" if line else ""
    named = f"the key '{readable('.'.join(map(str, key)))}': " if key else ""
    return InputError(f"{path}{where}: {named}{message.rstrip('.')}.")


def _visibility(part: str | VisibilityPart, folder: Path, files: OwnFiles) -> str:
    """Name of a visibility strategy, made known where it is a file."""
    if isinstance(part, str):
        return part
    source = files.shader(_path(folder, part.file))
    like = VISIBILITIES[part.supply] if part.supply else Visibility(source, part.what)
    said = part.model_dump(include={"reads_shadow_map", "asks_points"}, exclude_none=True)
    VISIBILITIES[_name(part, source)] = replace(like, source=source, what=part.what, **said)
    return _name(part, source)


def _airlight(part: str | AirlightPart, folder: Path, files: OwnFiles) -> str:
    """Name of an airlight model, made known where it is a file."""
    if isinstance(part, str):
        return part
    source = files.shader(_path(folder, part.file))
    like = AIRLIGHT_MODELS[part.supply] if part.supply else AirlightShader(source, part.what)
    said = part.model_dump(include={"phases", "any_light", "point_samples"}, exclude_none=True)
    if "phases" in said:
        said["phases"] = tuple(said["phases"])
    AIRLIGHT_MODELS[_name(part, source)] = replace(like, source=source, what=part.what, **said)
    return _name(part, source)


def _lattice(part: str | LatticePart, folder: Path, files: OwnFiles) -> str:
    """Name of a lattice, made known where it is a file."""
    if isinstance(part, str):
        return part
    source, back = files.shader(_path(folder, part.file)), files.shader(_path(folder, part.reconstruction))
    kind = replace(LATTICES[part.supply], source=source, what=part.what, reconstruction=back)
    LATTICES[_name(part, source, back)] = kind
    return _name(part, source, back)


def _path(folder: Path, file: str) -> Path:
    return Path(os.path.normpath(folder / file))


def _name(part: Part, *sources: str) -> str:
    """Name of a part by all that it is made of: the same file with another declaration is another part."""
    made_of = "\0".join((part.model_dump_json(exclude={"file", "reconstruction"}), *sources))
    return f"{Path(part.file).name}{OWN}{hashlib.sha256(made_of.encode()).hexdigest()[:DIGITS]}"
