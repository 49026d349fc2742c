"""Suites: which scenes, which techniques, how large, how accurate a reference. One TOML file each."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

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

    @field_validator("scenes")
    @classmethod
    def _names_differ(cls, scenes: list[str]) -> list[str]:
        names = [Path(scene).stem for scene in scenes]
        for name in names:
            # the files of a case are called after its scene
            if names.count(name) > 1:
                raise ValueError(f"two scenes are called {name}")
        return scenes

    @field_validator("techniques")
    @classmethod
    def _cases_differ(cls, techniques: list[TechniqueChoice]) -> list[TechniqueChoice]:
        # as they will run: a setting that is spelt out may be the technique's own
        resolved = [choice.technique() for choice in techniques]
        for technique in resolved:
            if resolved.count(technique) > 1:
                raise ValueError(f"{technique.name} stands there twice with the same settings")
        return techniques

    @field_validator("parameters")
    @classmethod
    def _size_is_apart(cls, parameters: dict[str, str | int | float]) -> dict[str, str | int | float]:
        if "size" in parameters:
            raise ValueError("size is a key of the suite itself, and no scene can have a parameter of that name")
        return parameters


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
    path = Path(suite) if os.path.isfile(suite) else FOLDER / f"{suite}.toml"
    if not os.path.isfile(path):
        raise InputError(f"There is no suite '{suite}': give the path of a TOML file or one of {', '.join(shipped())}.")
    try:
        loaded = Suite.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not a suite: {error}.") from None
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path}: the key '{key}': {first['msg']}.") from None
    return path.stem, loaded
