"""One run of the gate: its cases, a reference that is estimated anew, and pictures of what failed."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from random import Random
from typing import Literal

from experiments.gate import suite
from experiments.gate.agreement import FIRST_SEED, LAST_SEED, Agreement, check_reference
from experiments.gate.limits import Limits
from experiments.gate.measuring import gated
from experiments.gate.verdicts import Verdict, judge
from experiments.run.cluster import cluster
from experiments.run.folder import begin_run
from experiments.run.rows import Row
from experiments.run.suite_run import Plan, SuiteRun
from experiments.run.watcher import Watcher
from experiments.run.work import Bench
from experiments.suite import Case
from scenes.errors import InputError
from scenes.replacing import make_folder

Check = Literal["one", "all"]


@dataclass(frozen=True)
class Result:
    """What a run of the gate found.

    Attributes
    ----------
    verdicts : tuple of Verdict       of the cases that were measured
    broken : dict                     case or reference that could not be measured to the sentence that says why
    agreements : tuple of Agreement   of the references that were estimated anew
    """

    verdicts: tuple[Verdict, ...]
    broken: dict[str, str]
    agreements: tuple[Agreement, ...]

    @property
    def failed(self) -> list[Verdict]:
        """Values beyond their limits."""
        return [verdict for verdict in self.verdicts if not verdict.passes]

    @property
    def estimated_anew(self) -> bool:
        """Whether this machine could estimate a reference of the kind that is committed."""
        return any(one.comparison is not None for one in self.agreements)

    @property
    def passes(self) -> bool:
        """Whether nothing failed."""
        return not (self.failed or self.broken) and all(one.agrees for one in self.agreements)


def run_gate(cases: Sequence[Case], limits: Limits, check: Check, seed: int, watcher: Watcher) -> Result:
    """Measure cases, and estimate references of theirs anew: one that `seed` draws, or all."""
    values, broken = {}, {}
    for row in _rows(cases, watcher):
        if row["status"] == "done":
            values[row["case"]] = gated(row)
        else:
            broken[row["case"]] = row["reason"]
    agreements = []
    random = Random(seed)
    scenes = suite.gate_scenes(cases)
    drawn = [random.choice(sorted(scenes))] if check == "one" else sorted(scenes)
    for name in drawn:
        try:
            agreements.append(check_reference(suite.REFERENCES, scenes[name], random.randrange(FIRST_SEED, LAST_SEED)))
        except InputError as error:
            broken[name] = str(error)
    return Result(tuple(judge(values, limits)), broken, tuple(agreements))


def _rows(cases: Sequence[Case], watcher: Watcher) -> list[Row]:
    # its rows are judged at once, and nobody goes on with it
    with tempfile.TemporaryDirectory(prefix="airlight-gate-") as parent:
        folder, _ = begin_run(Path(parent), suite.SUITE, digest="", contents={})
        try:
            with cluster(None) as client:
                return SuiteRun(client, folder, Plan(suite.SUITE, (), cases), watcher).run()
        finally:
            folder.close()


def check_folder(folder: Path) -> None:
    """Raise InputError where a folder could not be made, or not be written to; it is not made."""
    nearest = next(one for one in (folder.absolute(), *folder.absolute().parents) if os.path.lexists(one))
    if not (nearest.is_dir() and os.access(nearest, os.W_OK | os.X_OK)):
        raise InputError(f"{folder} cannot be a folder for pictures: {nearest} is in the way; choose another --out.")


def write_pictures(cases: Sequence[Case], result: Result, folder: Path) -> list[Path]:
    """Draw the cases that failed once more, each as an EXR and a sheet beside its reference; makes no folder for none.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    names = {verdict.case for verdict in result.failed}
    if not names:
        return []
    make_folder(folder, "choose another --out")
    bench, written = Bench(), []
    try:
        for case in cases:
            if case.name in names:
                bench.measure(replace(case, pictures="all"), folder)
                written.append(folder / f"{case.name}.exr")
    finally:
        bench.release()
    return written
