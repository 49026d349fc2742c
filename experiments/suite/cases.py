"""A suite's cases: every combination that its products ask for, each with all that decides its result."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product as combinations
from math import prod
from pathlib import Path
from typing import Any, Literal

from experiments.suite.schema import CameraChoice, Product, ReferenceChoice, Suite, TechniqueChoice, Value
from experiments.technique_label import changed_settings
from gpu_impl.techniques import Technique
from scenes.errors import InputError
from scenes.messages import readable

# file systems take names of 255 bytes, and the writer's temporary files need some of them
LONGEST_NAME = 180
# A hundred times the largest shipped suite: a grid that asks for more has a key too many, and would fill the memory.
MOST_CASES = 100_000


@dataclass(frozen=True)
class Case:
    """One measurement: a scene with its parameters, seen by one camera, drawn by one technique.

    Attributes
    ----------
    name : str               unique in the suite, fit for a file name
    product : str            of which of the suite's products
    scene : str              name or path
    parameters : dict        of the scene, the phase function's among them
    triangles : int or None  budget of the meshes
    technique, baseline : Technique    with every setting
    measure : tuple          names of measurements
    rounds : int             of timing
    time_limit : float       [s]
    """

    name: str
    product: str
    scene: str
    size: tuple[int, int]
    parameters: Mapping[str, Value]
    camera: CameraChoice
    triangles: int | None
    technique: Technique
    measure: tuple[str, ...]
    reference: ReferenceChoice
    pictures: Literal["all", "sheets", "none"]
    rounds: int
    baseline: Technique
    time_limit: float

    @property
    def view(self) -> tuple[object, ...]:
        """What decides its pictures but the technique: cases that share it share scene and reference."""
        parameters = json.dumps(dict(self.parameters), sort_keys=True)
        return self.scene, self.size, parameters, self.camera, self.triangles, self.reference

    @property
    def phase(self) -> str:
        """The phase function with its parameters, for people: "hg 0.6"; empty where the scene's own is taken."""
        names = ("phase", "g", "k")
        return " ".join(str(self.parameters[name]) for name in names if name in self.parameters)


def cases_of(suite: Suite) -> list[Case]:
    """All cases in the order in which they run: those that share a scene and a reference one after the other.

    Raises
    ------
    InputError
        Two cases are the same or have one name, or there are too many.
    """
    total = 0
    for product in suite.products:
        total += _count(product)
        if total > MOST_CASES:
            raise InputError(
                f"The product '{readable(product.name)}' brings the suite to {total:,} cases, more than the "
                f"{MOST_CASES:,} that airlight takes; leave some values out."
            )
    cases: dict[str, Case] = {}
    for product in suite.products:
        prefix = product.name if len(suite.products) > 1 else ""
        for case in _cases_of(_with_paths(product, suite.folder), prefix):
            other = cases.setdefault(case.name, case)
            if other is case:
                continue
            if other == case:
                raise InputError(
                    f"The case {case.name} stands in the suite twice: leave one out, or give its product another name."
                )
            raise InputError(
                f"Two cases have the same name, {case.name}: rename a product or a scene, or your technique (`name`)."
            )
    return list(cases.values())


def _count(product: Product) -> int:
    """How many cases a product has, before any of them is made."""
    fogs = len(product.phases or [{}]) * prod(len(values) for values in product.parameters.values())
    views = len(product.scenes) * fogs * len(product.triangles or [None]) * len(product.size) * len(product.cameras)
    settings = [(product.settings.axes() | choice.axes()).values() for choice in product.techniques]
    return views * sum(prod(len(values) for values in axes) for axes in settings)


def _with_paths(product: Product, folder: Path | None) -> Product:
    """Paths that mean the same in every process: absolute, where they stand from here or else from the suite's folder.

    A shipped scene's name stays a name.
    """
    scenes = [_absolute(scene, folder, os.path.isfile) or scene for scene in product.scenes]
    reference = product.reference
    if reference.folder is not None:
        missing = str((folder or Path()).absolute() / reference.folder)
        found = _absolute(reference.folder, folder, os.path.isdir) or missing
        reference = reference.model_copy(update={"folder": found})
    return product.model_copy(update={"scenes": scenes, "reference": reference})


def _absolute(path: str, folder: Path | None, is_there: Callable[[Path], bool]) -> str | None:
    """A path from the working directory or else from a folder; None where it is in neither."""
    places = [Path.cwd(), folder.absolute()] if folder else [Path.cwd()]
    return next((str(place / path) for place in places if is_there(place / path)), None)


def _cases_of(product: Product, prefix: str) -> Iterator[Case]:
    fogs = [_merged(parts) for parts in combinations(product.phases or [{}], _grid(product.parameters))]
    techniques = [found for choice in product.techniques for found in _techniques(choice, product)]
    several = {key for key in (set().union(*fogs) if fogs else set()) if len({str(fog.get(key)) for fog in fogs}) > 1}
    budgets: list[int | None] = [*product.triangles] if product.triangles else [None]
    baseline = product.baseline.technique(**{name: values[0] for name, values in product.baseline.axes().items()})
    for scene, fog, triangles, size, camera in combinations(
        product.scenes, fogs, budgets, product.size, product.cameras
    ):
        for technique in techniques:
            parts = [
                prefix,
                Path(scene).stem,
                *(_told(key, value) for key, value in fog.items() if key in several),
                f"{triangles}-triangles" if len(product.triangles or []) > 1 else "",
                f"{size[0]}x{size[1]}" if len(product.size) > 1 else "",
                str(camera) if len(product.cameras) > 1 else "",
                technique.name,
                *(f"{name}-{value}" for name, value in changed_settings(technique.name, vars(technique)).items()),
            ]
            yield Case(
                name=_file_name(parts),
                product=product.name,
                scene=scene,
                size=size,
                parameters=fog,
                camera=camera,
                triangles=triangles,
                technique=technique,
                measure=tuple(product.measure),
                reference=product.reference,
                pictures=product.pictures,
                rounds=product.rounds,
                baseline=baseline,
                time_limit=product.time_limit,
            )


def _techniques(choice: TechniqueChoice, product: Product) -> Iterator[Technique]:
    """One technique with every combination of its settings, and of those for all that it does not have itself."""
    axes = product.settings.axes() | choice.axes()
    for values in combinations(*axes.values()):
        yield choice.technique(**dict(zip(axes, values, strict=True)))


def _grid(parameters: Mapping[str, list[Any]]) -> list[dict[str, Any]]:
    return [dict(zip(parameters, values, strict=True)) for values in combinations(*parameters.values())]


def _merged(tables: tuple[dict[str, Any], ...]) -> dict[str, Any]:
    return {key: value for table in tables for key, value in table.items()}


def _told(parameter: str, value: Value) -> str:
    """A parameter in a name; a phase function's go without saying."""
    return str(value) if parameter in ("phase", "g", "k") else f"{parameter}-{value}"


def _file_name(parts: list[str]) -> str:
    """Join what is there; signs that FAT, NTFS or scp cannot take in a name become hyphens."""
    name = re.sub(r"[^A-Za-z0-9._+=-]+", "-", "-".join(filter(None, parts)))
    if len(name) <= LONGEST_NAME:
        return name
    return f"{name[: LONGEST_NAME - 9]}-{hashlib.sha256(name.encode()).hexdigest()[:8]}"
