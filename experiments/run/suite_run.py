"""Runs what is left of a suite's cases as tasks of a cluster, and keeps what comes of each."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass, field
from typing import Any

from distributed import Client, Future, KilledWorker, wait
from distributed.client import FIRST_COMPLETED, FuturesCancelledError
from distributed.comm import CommClosedError

from experiments.measurements import find_measurement
from experiments.run.cluster import QUIET, slots
from experiments.run.folder import RunError, RunFolder, code_digest, keep_row, ordered
from experiments.run.rows import Row, alone, finished, identity
from experiments.run.watcher import Watcher
from experiments.run.work import run_case, topic
from experiments.suite.cases import Case
from scenes.errors import InputError

# how often time limits are looked at, and how often tables are written while cases go on [s]
LOOK_SECONDS, TABLE_SECONDS = 0.25, 15.0
# within which a scheduler notices that a worker has been ended
KILL_SECONDS = 30


@dataclass(frozen=True)
class Plan:
    """What is to be run.

    Attributes
    ----------
    suite : str          as it was named on the command line
    changes : tuple      of `--set`
    cases : sequence     all of the suite's, or those that were chosen
    max_failures : int or None    after which the rest is left
    """

    suite: str
    changes: tuple[str, ...]
    cases: Sequence[Case]
    max_failures: int | None = None

    @property
    def quiet(self) -> bool:
        """Whether anything is timed, so that each case holds its machine for itself."""
        return any(find_measurement(name).needs_quiet for case in self.cases for name in case.measure)


@dataclass
class _Running:
    case: Case
    future: Future
    # when its worker said that it began, and which that is; None while it waits for one
    begun: float | None = None
    worker: str = ""


@dataclass
class SuiteRun:
    """One run, while it goes on."""

    client: Client
    folder: RunFolder
    plan: Plan
    watcher: Watcher
    rows: dict[str, Row] = field(default_factory=dict)
    _running: dict[str, _Running] = field(default_factory=dict)
    _written: float = 0.0
    _failures: int = 0

    def run(self) -> list[Row]:
        """Run what is left; rows of all cases that are there then, in the suite's order.

        Raises
        ------
        RunError
            The folder takes no more.
        """
        names = [case.name for case in self.plan.cases]
        there = self.folder.rows()
        left = [case for case in self.plan.cases if not (case.name in there and finished(there[case.name]))]
        at_once = slots(self.client, self.plan.quiet) if left else 0
        # what failed before stays told until it is tried again
        self.rows = {name: there[name] for name in names if name in there}
        self.watcher.begin(len(names) - len(left), len(names))
        told = topic(self._path)
        self.client.subscribe_topic(told, self._event)
        try:
            left.reverse()
            while left or self._running:
                while left and len(self._running) < at_once and not self._too_many_failures():
                    self._submit(left.pop())
                if not self._running:
                    break
                self._collect()
            self.client.unsubscribe_topic(told)
        except (CommClosedError, FuturesCancelledError):
            raise RunError(
                "The scheduler does not answer any more. What is finished is kept; the same command goes on from there."
            ) from None
        finally:
            with suppress(CommClosedError, OSError, RuntimeError):
                self.client.cancel([one.future for one in self._running.values()], force=True)
            rows = ordered(self.rows, names)
            # an error that is on its way says more than this one would
            with suppress(InputError) if sys.exc_info()[0] else nullcontext():
                if rows:
                    self.folder.write_tables(rows)
        return rows

    @property
    def _path(self) -> str:
        return str(self.folder.path.resolve())

    def _submit(self, case: Case) -> None:
        future = self.client.submit(
            run_case,
            case,
            self._path,
            code_digest(),
            {"command": alone(self.plan.suite, self.plan.changes, case)},
            key=f"airlight-{self.folder.path.name}-{case.name}-{time.monotonic_ns()}",
            pure=False,
            retries=0,
            resources={QUIET: 1} if self.plan.quiet else None,
        )
        self._running[case.name] = _Running(case, future)

    def _collect(self) -> None:
        """Wait a little, and keep what has come."""
        futures = [one.future for one in self._running.values()]
        with suppress(TimeoutError):
            wait(futures, timeout=LOOK_SECONDS, return_when=FIRST_COMPLETED)
        for one in list(self._running.values()):
            if one.future.done():
                self._keep(one, self._row(one))
            elif one.begun is not None and time.monotonic() - one.begun > one.case.time_limit:
                self._end(one)
        if time.monotonic() - self._written > TABLE_SECONDS and self.rows:
            self.folder.write_tables(ordered(self.rows, [case.name for case in self.plan.cases]))
            self._written = time.monotonic()

    def _row(self, one: _Running) -> Row:
        """What a task that is over has given."""
        error = one.future.exception() if one.future.status != "finished" else None
        if error is None:
            return one.future.result()
        if isinstance(error, RunError):
            raise error
        if isinstance(error, KilledWorker):
            why = "its process ended without a word (a crash of a driver or of Dr.Jit, no memory, or a full disk)"
        else:
            why = f"{type(error).__name__}: {error}"
        return self._failed(one.case, why)

    def _end(self, one: _Running) -> None:
        """End the process of a case that takes too long: nothing else stops a driver's call."""
        if one.future.key in self.client.processing().get(one.worker, ()):
            # dask's own restart asks such a process to go, and has been seen to wait for it for ever
            self.client.run(_kill_worker, workers=[one.worker], nanny=True)
            # until the scheduler knows: or the next case would be handed to the dead
            with suppress(TimeoutError, KilledWorker):
                one.future.result(timeout=KILL_SECONDS)
        one.future.cancel(force=True)
        self._keep(one, self._failed(one.case, f"it took longer than its time limit of {one.case.time_limit:g} s"))

    def _failed(self, case: Case, why: str) -> Row:
        row = identity(case) | {
            "status": "failed",
            "reason": why,
            "command": alone(self.plan.suite, self.plan.changes, case),
        }
        keep_row(self.folder.path, row)
        return row

    def _keep(self, one: _Running, row: Row) -> None:
        del self._running[one.case.name]
        self.rows[one.case.name] = row
        self._failures += row["status"] == "failed"
        self.watcher.case(row)

    def _too_many_failures(self) -> bool:
        limit = self.plan.max_failures
        return limit is not None and self._failures >= limit

    def _event(self, event: Any) -> None:
        """A worker's word, in dask's own thread: (time, what it told)."""
        _, told = event
        one = self._running.get(told["case"])
        if one and one.begun is None:
            one.begun, one.worker = time.monotonic(), told["worker"]
        self.watcher.step(told)


def _kill_worker(dask_worker: Any) -> None:
    """End the process that a nanny looks after; it starts another, as after a crash."""
    os.kill(dask_worker.process.pid, signal.SIGKILL)
