"""Suites: which scenes, which techniques, how large, how accurate a reference. One TOML file each."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from gpu_impl.techniques import Technique, find_technique
from reference.goal import Goal
from scenes.errors import InputError

FOLDER = Path(__file__).parent / "suites"
Side = Annotated[int, Field(ge=1, le=16384)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class TechniqueChoice(_Strict):
    """A technique by name, with settings that differ from its own."""

    name: str
    steps: int | None = None
    shadow_map: int | None = None
    downsample: int | None = None

    def technique(self) -> Technique:
        """Look it up."""
        return find_technique(**self.model_dump())


class ReferenceChoice(_Strict):
    """How accurate the references have to be."""

    rel_error: Annotated[float, Field(gt=0, lt=1)] = 0.005
    time_limit: Annotated[float, Field(gt=0)] = 600.0

    def goal(self) -> Goal:
        """As the estimator takes it."""
        return Goal(self.rel_error, self.time_limit)


class Suite(_Strict):
    """A product of scenes and techniques."""

    scenes: Annotated[list[str], Field(min_length=1)]
    techniques: Annotated[list[TechniqueChoice], Field(min_length=1)]
    size: tuple[Side, Side]
    parameters: dict[str, str | int | float] = {}
    reference: ReferenceChoice = ReferenceChoice()


def shipped() -> list[str]:
    """Names of the shipped suites."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load_suite(suite: str) -> tuple[str, Suite]:
    """Read a suite by name or path.

    Returns
    -------
    name, suite

    Raises
    ------
    InputError
        The file is missing, is not TOML, or holds a key or a value that a suite does not take.
    """
    path = Path(suite) if Path(suite).is_file() else FOLDER / f"{suite}.toml"
    if not path.is_file():
        raise InputError(f"There is no suite '{suite}': give the path of a TOML file or one of {', '.join(shipped())}.")
    try:
        loaded = Suite.model_validate(tomllib.loads(path.read_text()))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not a suite: {error}.") from None
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path}: the key '{key}': {first['msg']}.") from None
    return path.stem, loaded
