"""A suite's cases: every combination that its products ask for, each with all that decides its result."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product as combinations
from pathlib import Path
from typing import Any, Literal

from experiments.suite.schema import CameraChoice, Product, ReferenceChoice, Suite, TechniqueChoice, Value
from experiments.technique_label import changed_settings
from gpu_impl.techniques import Technique
from scenes.errors import InputError

# file systems take names of 255 bytes, and the writer's temporary files need some of them
LONGEST_NAME = 180


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
        Two cases are the same.
    """
    cases: list[Case] = []
    for product in suite.products:
        cases += _cases_of(_with_paths(product, suite.folder), product.name if len(suite.products) > 1 else "")
    counted = Counter(case.name for case in cases)
    if twice := next((name for name, count in counted.items() if count > 1), None):
        raise InputError(
            f"The case {twice} stands in the suite twice: leave one out, or give its product another name."
        )
    return cases


def _with_paths(product: Product, folder: Path | None) -> Product:
    """Paths as the working directory has them: those of a suite's file count from its own folder."""
    if folder is None:
        return product
    scenes = [
        str(folder / scene) if not os.path.isfile(scene) and os.path.isfile(folder / scene) else scene
        for scene in product.scenes
    ]
    reference = product.reference
    if reference.folder is not None:
        reference = reference.model_copy(update={"folder": str(folder / reference.folder)})
    return product.model_copy(update={"scenes": scenes, "reference": reference})


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
