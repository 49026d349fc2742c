"""Runs a suite: each scene's reference once, each technique beside it, every number and picture kept."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict
from datetime import datetime
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from experiments.metrics import Metrics, measure
from experiments.pictures import LAYERS, write_case
from experiments.provenance import describe_frame, describe_reference, describe_scene
from experiments.sheet import prepare_sheets, summary, write_sheet
from experiments.suite import Suite
from gpu_impl.frame import Frame
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import SETTINGS, find_technique
from reference.convergence import Progress
from reference.estimate import Reference, estimate_reference
from scenes.errors import InputError
from scenes.file_names import check_name
from scenes.loader import load
from scenes.model import Scene
from scenes.replacing import replacing

Row = dict[str, Any]


class Watcher:
    """Told how a run goes; the terminal shows it, tests ignore it."""

    def case(self, name: str, number: int, total: int) -> None:
        """Case `number` of `total` begins."""

    def scene(self, scene: Scene) -> None:
        """A scene was loaded."""

    def reference(self, progress: Progress) -> None:
        """A reference got further."""

    def estimated(self, reference: Reference) -> None:
        """A scene's reference is there."""


def run_suite(name: str, suite: Suite, parent: Path, watcher: Watcher) -> tuple[list[Row], Path]:
    """Run every case.

    Parameters
    ----------
    name : of the suite
    parent : where the folder of this run is made

    Returns
    -------
    rows : one per case and layer
    folder : with results.csv, results.parquet, and an EXR and a sheet per case

    Raises
    ------
    InputError
        A scene, a technique or the folder cannot be used.
    """
    techniques = [choice.technique() for choice in suite.techniques]
    # what cannot be used is said before the first reference is estimated
    scenes = [load(scene, size=suite.size, **suite.parameters) for scene in suite.scenes]
    for scene in scenes:
        for technique in techniques:
            technique.check_scene(scene)
    folder = _make_folder(parent, name)
    rows: list[Row] = []
    total, number = len(suite.scenes) * len(techniques), 0
    # matplotlib takes as long as OpenGL: a second process draws one case's sheet while the next case renders
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as drawer:
        with _interrupts_blocked():
            sheets = [drawer.submit(prepare_sheets)]
        for scene in scenes:
            watcher.scene(scene)
            watcher.case(f"{scene.name}: reference", number, total)
            reference = estimate_reference(scene, suite.reference.goal(), watcher.reference)
            watcher.estimated(reference)
            with Renderer(scene) as renderer:
                for technique in techniques:
                    watcher.case(f"{scene.name}: {technique_label(technique.name, vars(technique))}", number, total)
                    frame = renderer.render(technique)
                    case = keep_case(folder, scene, frame, reference)
                    sheets.append(drawer.submit(write_sheet, *_sheet(folder, scene, frame, reference, case)))
                    rows += case
                    number += 1
            # each finished scene is in the tables before the next begins; a case's EXR is there at once
            write_tables(folder, rows)
        for sheet in sheets:
            sheet.result()
    watcher.case("done", total, total)
    return rows, folder


@contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """A process that is started inside never hears Ctrl-C: the terminal sends it to all, and ours alone answers it."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def keep_case(folder: Path, scene: Scene, frame: Frame, reference: Reference) -> list[Row]:
    """Measure one case and write its EXR; a row per layer."""
    write_case(folder / f"{case_name(scene, frame)}.exr", scene, frame, reference)
    return [
        _row(
            scene,
            frame,
            reference,
            layer,
            measure(getattr(frame, layer), getattr(reference, layer), reference.standard_error(layer)),
        )
        for layer in LAYERS
    ]


def changed_settings(name: str, given: Mapping[str, Any]) -> dict[str, str]:
    """Those of the settings `given` that are not what the technique of this name has by itself, as text."""
    own = find_technique(name)
    return {setting: str(given[setting]) for setting in SETTINGS if str(given[setting]) != str(getattr(own, setting))}


def technique_label(name: str, given: Mapping[str, Any]) -> str:
    """Name of a technique and its changed settings, for people: "Nishita1987, steps 5"."""
    changed = changed_settings(name, given)
    return ", ".join([name, *(f"{setting} {value}" for setting, value in changed.items())])


def case_name(scene: Scene, frame: Frame) -> str:
    """Name of a case's files; settings that are not the technique's own are part of it.

    A colon becomes a hyphen: FAT and NTFS have none in names, and scp takes what stands before one for a host.
    """
    technique = frame.technique
    changed = changed_settings(technique.name, vars(technique))
    settings = "".join(f"-{setting}-{value}" for setting, value in changed.items())
    return f"{scene.name}-{technique.name.replace(':', '-')}{settings}"


def write_tables(folder: Path, rows: list[Row]) -> None:
    """Write all rows as CSV and Parquet."""
    import polars

    table = polars.DataFrame(rows, infer_schema_length=None)
    for ending, write in ((".csv", table.write_csv), (".parquet", table.write_parquet)):
        with replacing(folder / f"results{ending}") as beside:
            write(beside)


def _row(scene: Scene, frame: Frame, reference: Reference, layer: str, metrics: Metrics) -> Row:
    return {
        "scene": scene.name,
        "technique": frame.technique.name,
        "layer": layer,
        "phase": scene.phase.name,
        **asdict(metrics),
        **describe_scene(scene),
        **describe_frame(frame),
        **describe_reference(reference),
    }


def _sheet(folder: Path, scene: Scene, frame: Frame, reference: Reference, rows: list[Row]) -> tuple[Any, ...]:
    """Arguments of `write_sheet` for the scattering layer of a case."""
    label = technique_label(frame.technique.name, vars(frame.technique))
    title = f"{scene.name}, {label}: scattering, {scene.camera.width} x {scene.camera.height}"
    stand_ins = f"stand-in for {', '.join(scene.stand_ins)}" if scene.stand_ins else ""
    path = folder / f"{case_name(scene, frame)}.png"
    row = next(row for row in rows if row["layer"] == "scattering")
    return path, title, frame.scattering, reference.scattering, summary(row), stand_ins


def _make_folder(parent: Path, name: str) -> Path:
    """Make a new folder for this run; none before it is touched."""
    check_name(parent.absolute())
    stem = f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
    try:
        parent.mkdir(parents=True, exist_ok=True)
        for attempt in range(1000):
            folder = parent / (f"{stem}-{attempt}" if attempt else stem)
            try:
                folder.mkdir()
            except FileExistsError:
                continue
            return folder
    except OSError as error:
        raise InputError(f"{parent} cannot hold the results ({os.strerror(error.errno or 0)}); choose --out.") from None
    raise InputError(f"{parent} is full of runs of {name}; remove some or choose another --out.")
