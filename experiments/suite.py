"""Suites: which scenes, which techniques, how large, how accurate a reference. One TOML file each."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import Annotated, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from gpu_impl.techniques import Technique, find_technique
from reference.goal import Goal
from scenes.errors import InputError
from scenes.file_names import check_name

FOLDER = Path(__file__).parent / "suites"
Item = TypeVar("Item")
# TOML knows numbers from texts and from true: nothing is turned into a number that is none
Whole = Annotated[int, Field(strict=True)]
Side = Annotated[Whole, Field(ge=1, le=16384)]
Number = Annotated[float, Field(strict=True)]
Value = str | Whole | Number


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class TechniqueChoice(_Strict):
    """A technique by name, with parts and settings that differ from its own: those of `gpu_impl.techniques`."""

    name: str
    visibility: str | None = None
    airlight: str | None = None
    steps: Whole | None = None
    shadow_map: Whole | None = None
    downsample: Whole | None = None
    upsample: str | None = None
    surface_shadows: str | None = None
    shadow_storage: str | None = None
    composition: str | None = None

    def technique(self) -> Technique:
        """Look it up."""
        return find_technique(**self.model_dump())


class ReferenceChoice(_Strict):
    """How accurate the references have to be."""

    rel_error: Annotated[Number, Field(gt=0, lt=1)] = 0.005
    time_limit: Annotated[Number, Field(gt=0)] = 600.0

    def goal(self) -> Goal:
        """As the estimator takes it."""
        return Goal(self.rel_error, self.time_limit)


class Suite(_Strict):
    """A product of scenes and techniques."""

    scenes: Annotated[list[str], Field(min_length=1)]
    techniques: Annotated[list[TechniqueChoice], Field(min_length=1)]
    size: tuple[Side, Side]
    parameters: dict[str, Value] = {}
    reference: ReferenceChoice = ReferenceChoice()

    @field_validator("scenes")
    @classmethod
    def _names_differ(cls, scenes: list[str]) -> list[str]:
        # the files of a case are called after its scene
        if name := _repeated([Path(scene).stem for scene in scenes]):
            raise ValueError(f"two scenes are called {name}")
        return scenes

    @field_validator("techniques")
    @classmethod
    def _cases_differ(cls, techniques: list[TechniqueChoice]) -> list[TechniqueChoice]:
        # as they will run: a setting that is spelt out may be the technique's own
        if technique := _repeated([choice.technique() for choice in techniques]):
            raise ValueError(f"{technique.name} stands there twice with the same settings")
        return techniques

    @field_validator("parameters")
    @classmethod
    def _size_is_apart(cls, parameters: dict[str, Value]) -> dict[str, Value]:
        if "size" in parameters:
            raise ValueError("size is a key of the suite itself, and no scene can have a parameter of that name")
        return parameters


def _repeated(items: list[Item]) -> Item | None:
    """The first that stands there more than once."""
    return next((item for item in items if items.count(item) > 1), None)


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
    check_name(suite)
    path = Path(suite) if os.path.isfile(suite) else FOLDER / f"{suite}.toml"
    if not os.path.isfile(path):
        raise InputError(f"There is no suite '{suite}': give the path of a TOML file or one of {', '.join(shipped())}.")
    try:
        loaded = Suite.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path} is not a suite: {error}.") from None
    except RecursionError:
        raise InputError(f"{path} is not a suite: its values are nested too deeply.") from None
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        # pydantic's preface to what a validator above says
        message = first["msg"].removeprefix("Value error, ")
        raise InputError(f"{path}: the key '{key}': {message}.") from None
    return path.stem, loaded
