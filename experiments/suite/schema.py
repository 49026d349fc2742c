"""What a suite's TOML file may hold: products of scenes, cameras, fog, techniques and their settings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationInfo, field_validator, model_validator

from experiments.measurements import MEASUREMENTS
from experiments.studies import STUDIES
from gpu_impl.techniques import SETTINGS, TECHNIQUES, Technique, find_technique
from reference.goal import Goal
from scenes.errors import InputError

Item = TypeVar("Item")
# TOML knows numbers from texts and from true: nothing is turned into a number that is none
Whole = Annotated[int, Field(strict=True)]
Side = Annotated[Whole, Field(ge=1, le=16384)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Value = str | Whole | Number
Size = tuple[Side, Side]

# a technique to try a setting on: what it may be is the same for all
ANY = next(iter(TECHNIQUES))


def _look_up(name: str, **changes: Any) -> None:
    """Find a technique; what is wrong as pydantic takes it, which then knows the place."""
    try:
        find_technique(name, **changes)
    except InputError as error:
        raise ValueError(str(error)) from None


def _several(value: Any) -> Any:
    """One value as a list of one."""
    return value if isinstance(value, list) else [value]


def _sizes(value: Any) -> Any:
    """One pair of numbers as a list of one size."""
    return value if isinstance(value, list) and value and isinstance(value[0], list) else [value]


Several = Annotated[list[Item], BeforeValidator(_several), Field(min_length=1)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Settings(_Strict):
    """Settings of techniques: each one value or a list of them, of which every combination is drawn."""

    steps: Several[Whole] | None = None
    shadow_map: Several[Whole] | None = None
    lattice: Several[str] | None = None
    downsample: Several[Whole] | None = None
    upsample: Several[str] | None = None
    surface_shadows: Several[str] | None = None
    shadow_storage: Several[str] | None = None
    shadow_source: Several[str] | None = None
    composition: Several[str] | None = None

    @field_validator(*SETTINGS)
    @classmethod
    def _can_be_used(cls, values: list[Any] | None, info: ValidationInfo) -> list[Any] | None:
        for value in values or []:
            _look_up(ANY, **{str(info.field_name): value})
        return values

    def axes(self) -> dict[str, list[Any]]:
        """The settings that are given."""
        return {name: values for name in SETTINGS if (values := getattr(self, name)) is not None}


class TechniqueChoice(Settings):
    """A technique by name, with parts and settings that differ from its own: those of `gpu_impl.techniques`.

    One of somebody's own is named by the path of its file, from the working directory or else from the suite's folder.
    """

    name: str
    visibility: str | None = None
    airlight: str | None = None

    @field_validator("name")
    @classmethod
    def _is_known(cls, name: str, info: ValidationInfo) -> str:
        if name.endswith(".toml"):
            # which means the same in every process, and is there by now or never
            beside = (info.context or {}).get("folder", Path()) / name
            name = str((beside if beside.is_file() and not Path(name).is_file() else Path(name)).absolute())
        _look_up(name)
        return name

    @field_validator("visibility", "airlight")
    @classmethod
    def _part_is_known(cls, part: str | None, info: ValidationInfo) -> str | None:
        _look_up(ANY, **{str(info.field_name): part})
        return part

    def technique(self, **settings: Any) -> Technique:
        """Look it up, with one value of each setting."""
        return find_technique(self.name, visibility=self.visibility, airlight=self.airlight, **settings)


class CameraChoice(_Strict):
    """The scene's camera, turned about what it looks at (`scenes.orbit`); with several frames, a path of such turns.

    Attributes
    ----------
    orbit : float     of the first frame [degree]
    frames : int      1 is a still
    step : float      between frames [degree]
    """

    orbit: Annotated[Number, Field(ge=-360, le=360)] = 0.0
    frames: Annotated[Whole, Field(ge=1, le=1000)] = 1
    step: Annotated[Number, Field(ge=-90, le=90)] = 0.25

    def angles(self) -> list[float]:
        """Turn of each frame [degree]."""
        return [self.orbit + number * self.step for number in range(self.frames)]

    def __str__(self) -> str:
        """As it stands in tables and file names; empty for the scene's own."""
        if self.frames == 1:
            return f"orbit {_degrees(self.orbit)}" if self.orbit else ""
        # so many digits that sums such as 0.1 + 2 x 0.1 are as short as they are written
        last = round(self.angles()[-1], 12)
        return f"path {_degrees(self.orbit)} to {_degrees(last)} in {self.frames}"


class ReferenceChoice(_Strict):
    """How accurate the references have to be, or where they are kept.

    Attributes
    ----------
    rel_error : float         relative standard error to reach
    time_limit : float        [s] after which one stops where it is
    deterministic : bool      by ray casting and quadrature instead of samples, without noise
    folder : str or None      take committed ones from this folder, a path as those of scenes; see `experiments.gate`
    """

    rel_error: Annotated[Number, Field(gt=0, lt=1)] = 0.005
    time_limit: Annotated[Number, Field(gt=0)] = 600.0
    deterministic: Annotated[bool, Field(strict=True)] = False
    folder: str | None = None

    def goal(self) -> Goal:
        """As the estimator takes it."""
        return Goal(self.rel_error, self.time_limit)


class Product(_Strict):
    """Every combination of what its keys list.

    Attributes
    ----------
    name : str             stands in the column `product`
    scenes : names, or paths from the working directory or else from the suite's own folder
    size : [width, height] or a list of them
    phases : names of phase functions, or tables such as {name = "hg", g = 0.6}
    parameters : of the scenes, each a value or a list
    cameras : see `CameraChoice`
    triangles : budgets that the scenes' meshes are decimated to, where the camera is the scene's own and stands still;
        see `experiments.technique_benchmark.budget`
    techniques, settings : a technique's own settings go before those for all
    measure : names in `experiments.measurements.MEASUREMENTS`
    reference : see `ReferenceChoice`
    pictures : "all" keeps an EXR and a sheet of each case, "sheets" the sheet, "none" neither
    rounds : of timing that count
    baseline : what timings are ratios to
    time_limit : [s] of a case, its reference included
    """

    name: str = ""
    scenes: Several[str]
    size: Annotated[list[Size], BeforeValidator(_sizes), Field(min_length=1)]
    phases: Several[dict[str, Value]] | None = None
    parameters: dict[str, Several[Value]] = {}
    cameras: Several[CameraChoice] = [CameraChoice()]
    triangles: Several[Annotated[Whole, Field(ge=1)]] | None = None
    techniques: Annotated[list[TechniqueChoice], Field(min_length=1)]
    settings: Settings = Settings()
    measure: Several[str] = ["errors"]
    reference: ReferenceChoice = ReferenceChoice()
    pictures: Literal["all", "sheets", "none"] = "all"
    rounds: Annotated[Whole, Field(ge=3, le=1000)] = 11
    baseline: TechniqueChoice = TechniqueChoice(name="Nishita1987")
    time_limit: Annotated[Number, Field(gt=0)] = 1800.0

    @field_validator("scenes")
    @classmethod
    def _names_differ(cls, scenes: list[str]) -> list[str]:
        # the files of a case are called after its scene
        stems = [Path(scene).stem for scene in scenes]
        for scene, stem in zip(scenes, stems, strict=True):
            if stem in ("", ".."):
                raise ValueError(f"'{scene}' is neither a scene's name nor the path of its file")
        if name := _repeated(stems):
            raise ValueError(f"two scenes are called {name}")
        return scenes

    @field_validator("phases", mode="before")
    @classmethod
    def _phases_are_tables(cls, phases: Any) -> Any:
        return None if phases is None else [_phase_table(phase) for phase in _several(phases)]

    @field_validator("triangles")
    @classmethod
    def _camera_is_the_scenes_own(cls, triangles: list[int] | None, info: ValidationInfo) -> list[int] | None:
        # a turned camera loads the scene again, and would find its whole meshes
        if triangles and any(camera.orbit or camera.frames > 1 for camera in info.data.get("cameras", [])):
            raise ValueError("a budget of triangles goes with the scene's own camera only: leave it or the cameras out")
        return triangles

    @field_validator("techniques")
    @classmethod
    def _cases_differ(cls, techniques: list[TechniqueChoice]) -> list[TechniqueChoice]:
        # as they will run: a setting that is spelt out may be the technique's own
        if technique := _repeated([choice.technique() for choice in techniques if not choice.axes()]):
            raise ValueError(f"{technique.name} stands there twice with the same settings")
        return techniques

    @field_validator("parameters")
    @classmethod
    def _size_is_apart(cls, parameters: dict[str, list[Value]]) -> dict[str, list[Value]]:
        if "size" in parameters:
            raise ValueError("'size' cannot be a parameter of a scene: use the suite's own key 'size'")
        return parameters

    @field_validator("measure")
    @classmethod
    def _measurements_are_known(cls, names: list[str]) -> list[str]:
        for name in names:
            if name not in MEASUREMENTS:
                raise ValueError(f"there is no measurement '{name}'; use {', '.join(MEASUREMENTS)}")
        return names

    @field_validator("baseline")
    @classmethod
    def _baseline_is_one(cls, baseline: TechniqueChoice) -> TechniqueChoice:
        if name := next((name for name, values in baseline.axes().items() if len(values) > 1), None):
            raise ValueError(f"a baseline has one value of each setting, and its '{name}' has several")
        return baseline

    @model_validator(mode="after")
    def _phase_stands_once(self) -> Product:
        if self.phases and "phase" in self.parameters:
            raise ValueError("phase functions stand in 'phases' and in 'parameters.phase'; leave one out")
        return self


class Suite(_Strict):
    """One or several products, and the study that says what came of them.

    A file has a product's keys at its top, and any number of `[[products]]`, each of which takes those keys from the
    top that it does not give itself.
    """

    products: Annotated[list[Product], Field(min_length=1)]
    study: str = "errors"
    # of the file, which paths in it are relative to; where it lies decides nothing
    folder: Annotated[Path | None, Field(exclude=True)] = None

    @field_validator("study")
    @classmethod
    def _study_is_known(cls, name: str) -> str:
        if name not in STUDIES:
            raise ValueError(f"there is no study '{name}'; use {', '.join(STUDIES)}")
        return name


def _phase_table(phase: Any) -> Any:
    """A phase function's parameters as the scenes call them: {phase = "hg", g = 0.6}."""
    if isinstance(phase, str):
        return {"phase": phase}
    if isinstance(phase, dict) and isinstance(phase.get("name"), str):
        return {"phase": phase["name"], **{key: value for key, value in phase.items() if key != "name"}}
    raise ValueError('a phase function is a name, or a table such as {name = "hg", g = 0.6}')


def _degrees(angle: float) -> str:
    """An angle with all its digits, and no more."""
    return repr(angle).removesuffix(".0")


def _repeated(items: list[Item]) -> Item | None:
    """The first that stands there more than once."""
    return next((item for item in items if items.count(item) > 1), None)
