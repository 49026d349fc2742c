"""What a worker does with one case: load, draw, measure, keep."""

from __future__ import annotations

import os
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from distributed import get_worker

from experiments.measurements import find_measurement
from experiments.measurements.shot import Shot
from experiments.metrics import Metrics
from experiments.pictures import write_case
from experiments.provenance import describe_frame, describe_reference, describe_scene
from experiments.renderers import open_renderer
from experiments.run.folder import RunError, code_digest, keep_row
from experiments.run.rows import Row, identity
from experiments.run.truth import Truth
from experiments.sheet import summary, write_sheet
from experiments.suite.cases import Case
from experiments.technique_benchmark.budget import load_within
from experiments.technique_label import technique_label
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import SETTINGS
from reference.convergence import Progress
from scenes.errors import InputError
from scenes.loader import load
from scenes.model import Scene
from scenes.orbit import orbited

# within which what a worker tells is on its way [s]: then its process may hang, and it is known at what
TOLD_SECONDS = 0.02


class Bench:
    """Measures cases in one process, and keeps the last scene for the next case.

    Parameters
    ----------
    tell : callable    given a dictionary for each step and each pass of a reference
    """

    def __init__(self, tell: Callable[[dict[str, Any]], None] = lambda event: None) -> None:
        self.tell = tell
        self.truth = Truth(self._reference)
        self._case = ""
        self._key: tuple[object, ...] | None = None
        self._renderer: Renderer | None = None

    def measure(self, case: Case, keep: Path | None = None) -> Row:
        """Measure a case; its row has what it is, its columns and what made them, or why its technique refuses.

        Parameters
        ----------
        keep : folder for its pictures

        Raises
        ------
        InputError
            The scene, its reference or the folder cannot be used.
        """
        self._case = case.name
        renderer = self._ready(case)
        scene = renderer.scene
        row = identity(case) | describe_scene(scene)
        try:
            case.technique.check_scene(scene)
        except InputError as error:
            return row | {"status": "refused", "reason": str(error)}
        shot = Shot(case, scene, renderer, self.truth)
        for name in case.measure:
            row |= find_measurement(name).measure(shot)
        row |= _made_by(shot, row)
        if keep:
            self.tell({"case": case.name, "step": "pictures"})
            try:
                _keep_pictures(keep, shot, row)
            except InputError as error:
                raise RunError(str(error)) from None
        return row | {"status": "done", "reason": ""}

    def release(self) -> None:
        """Give back what the last scene holds on the GPU."""
        if self._renderer:
            self._renderer.release()
        self._renderer, self._key = None, None

    def _ready(self, case: Case) -> Renderer:
        """The renderer of a case's scene: the last one where it is the same."""
        key = case.view[:-1]
        if self._renderer is None or key != self._key:
            self.release()
            self._renderer, self._key = open_renderer(load_case(case)), key
        return self._renderer

    def _reference(self, progress: Progress) -> None:
        self.tell(
            {
                "case": self._case,
                "step": "reference",
                "error": progress.rel_error,
                "seconds": progress.seconds,
                "seconds_left": progress.seconds_left,
            }
        )


def load_case(case: Case) -> Scene:
    """The scene of a case as its camera's first frame sees it."""
    if case.triangles is not None:
        return load_within(case.scene, case.triangles, case.size, **case.parameters)
    return orbited(load(case.scene, case.size, **case.parameters), case.camera.orbit)


def topic(folder: str) -> str:
    """The topic under which workers tell how far they are with a run."""
    return f"airlight {folder}"


_bench: Bench | None = None


def run_case(case: Case, folder: str, code: str, stands_for: Row) -> Row:
    """Run one case in a worker's process and keep its row; the task that is handed to dask.

    Whatever goes wrong with the case becomes a row of status "failed". What would go wrong with every case is raised.

    Parameters
    ----------
    folder : of the run, which this machine must see too
    code : digest of the program that asks; see `code_digest`
    stands_for : columns of every row, such as the command that runs the case alone

    Raises
    ------
    RunError
        The folder takes no more, or the worker has another airlight.
    """
    global _bench
    worker = get_worker()
    if code_digest() != code:
        raise RunError(
            f"The worker {worker.address} has other sources of airlight than this program; bring it up to date."
        )
    _bench = _bench or Bench()
    _bench.tell = lambda event: worker.log_event(topic(folder), event | {"worker": worker.address})
    _bench.tell({"case": case.name})
    time.sleep(TOLD_SECONDS)
    begin = time.perf_counter()
    row: Row
    try:
        row = _bench.measure(case, Path(folder) if case.pictures != "none" else None)
    except RunError:
        raise
    except Exception as error:
        _bench.release()
        known = isinstance(error, InputError)
        row = identity(case) | {
            "status": "failed",
            "reason": str(error) if known else f"{type(error).__name__}: {error}",
            "traceback": "" if known else traceback.format_exc(),
        }
    row |= stands_for | {"seconds": round(time.perf_counter() - begin, 3), "process": os.getpid()}
    keep_row(Path(folder), row)
    return row


def _made_by(shot: Shot, row: Row) -> Row:
    """What drew the picture and what estimated its reference, where either was asked for."""
    made: Row = {}
    lazily = vars(shot)
    if "frame" in lazily:
        # settings stand in the row as numbers already
        made |= {key: value for key, value in describe_frame(shot.frame).items() if key not in row}
    else:
        info = shot.renderer.device.info
        made |= {"gl_renderer": info.renderer, "gl_version": info.version}
    if "reference" in lazily:
        made |= describe_reference(shot.reference)
    return made


def _keep_pictures(folder: Path, shot: Shot, row: Row) -> None:
    """Write a case's sheet, and its EXR where the suite keeps all."""
    case, scene = shot.case, shot.scene
    if case.pictures == "all":
        write_case(folder / f"{case.name}.exr", scene, shot.frame, shot.reference)
    label = technique_label(case.technique.name, {name: getattr(case.technique, name) for name in SETTINGS})
    title = f"{scene.name}, {label}: scattering, {scene.camera.width} x {scene.camera.height}"
    stand_ins = f"stand-in for {', '.join(scene.stand_ins)}" if scene.stand_ins else ""
    numbers = {name: row.get(f"scattering.{name}") for name in Metrics.__dataclass_fields__}
    write_sheet(
        folder / f"{case.name}.png",
        title,
        shot.frame.scattering,
        shot.reference.scattering,
        summary(numbers) if "errors" in case.measure else "",
        stand_ins,
        standard_error=shot.reference.standard_error("scattering"),
    )
