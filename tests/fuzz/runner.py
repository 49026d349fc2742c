"""Shares cases out to worker processes, and goes on where one dies or hangs.

By hand, from the repository's root, 20,000 scenes and 2,000 meshes with another seed:

    PYTHONPATH=. python tests/fuzz/runner.py --seed 7 --scenes 20000 --meshes 2000 --keep /tmp/fuzz
"""

from __future__ import annotations

import argparse
import json
import os
import queue
import select
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

WORKERS = 2
LOCK = threading.Lock()
# for a worker to start, and for a case: the slowest took 5 s, where an LLVM compiled its first kernels
START = 120.0
PATIENCE = 60.0
# for a run, however slow the machine: it has to end where every case hangs
LIMIT = 900.0


@dataclass
class Report:
    """What came of a run.

    Attributes
    ----------
    ends : Counter        "scene picture", "scene sentence", "mesh picture" ... to how many
    faults : list         (case, what happened)
    slowest : list        (seconds, case), the longest first
    seconds : float       of wall clock
    left : int            cases for which there was no time
    """

    ends: Counter[str] = field(default_factory=Counter)
    faults: list[tuple[str, str]] = field(default_factory=list)
    slowest: list[tuple[float, str]] = field(default_factory=list)
    seconds: float = 0.0
    left: int = 0


class Worker:
    """A process that runs cases until one ends it."""

    def __init__(self, folder: Path, seed: int) -> None:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        self.folder = folder
        self.started = False
        # a thread each, as many as there are workers
        threads = {"LP_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        self.process = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("worker.py")), str(folder), str(seed)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=os.environ | threads | {"PYTHONPATH": str(Path(__file__).parents[2])},
        )

    def run(self, case: str, patience: float) -> dict:
        """Run one case, and say how it ended, also where it ended the process."""
        assert self.process.stdin
        assert self.process.stdout
        if not self.started:
            # the line with which it says that it is ready
            select.select([self.process.stdout], [], [], START)
            self.process.stdout.readline()
            self.started = True
        begin = time.perf_counter()
        try:
            self.process.stdin.write(f"{case}\n".encode())
            self.process.stdin.flush()
        except BrokenPipeError:
            pass
        ready, _, _ = select.select([self.process.stdout], [], [], patience)
        line = self.process.stdout.readline() if ready else b""
        if line:
            return json.loads(line)
        fault = "ended the process" if ready else f"hung for {patience:.0f} s"
        self.process.kill()
        fault += f" (exit code {self.process.wait()})" if ready else ""
        printed = self.folder / "printed"
        said = printed.read_text(errors="replace")[-3000:] if printed.exists() else ""
        return {"end": "", "fault": f"{fault}\n{said}", "seconds": time.perf_counter() - begin}

    def close(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.communicate()


def fuzz(cases: list[str], seed: int, keep: Path | None, patience: float = PATIENCE, limit: float = LIMIT) -> Report:
    """Run cases such as "scene 17", each reproducible from its number and the seed.

    Parameters
    ----------
    keep : folder for the files of the cases that failed, and all that they name
    patience : how long a case may take [s]
    limit : after which no case is begun [s]
    """
    waiting: queue.SimpleQueue[str] = queue.SimpleQueue()
    for case in cases:
        waiting.put(case)
    report = Report()
    begin = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        threads = [
            threading.Thread(
                target=_work, args=(Path(folder, str(n)), seed, waiting, report, keep, patience, begin + limit)
            )
            for n in range(WORKERS)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    report.left = waiting.qsize()
    report.seconds = time.perf_counter() - begin
    report.slowest = sorted(report.slowest, reverse=True)[:10]
    return report


def _work(
    folder: Path,
    seed: int,
    waiting: queue.SimpleQueue[str],
    report: Report,
    keep: Path | None,
    patience: float,
    deadline: float,
) -> None:
    worker = Worker(folder, seed)
    try:
        while time.perf_counter() < deadline:
            try:
                case = waiting.get_nowait()
            except queue.Empty:
                return
            answer = worker.run(case, patience)
            kind, fault = case.split()[0], answer["fault"]
            with LOCK:
                report.ends[f"{kind} {'fault' if fault else answer['end']}"] += 1
                report.slowest.append((answer["seconds"], case))
                if fault:
                    report.faults.append((case, fault))
            if fault and keep:
                _keep(folder, keep / f"{seed}-{case.replace(' ', '-')}", case, fault)
            if worker.process.poll() is not None:
                worker = Worker(folder, seed)
    finally:
        worker.close()


def _keep(folder: Path, target: Path, case: str, fault: str) -> None:
    """Move what a case wrote to where it is kept, with copies of the files that scenes name."""
    shutil.copytree(folder, target, dirs_exist_ok=True)
    for file in folder.glob(f"{case.replace(' ', '')}.*"):
        file.unlink()
    (target / "fault.txt").write_text(fault, encoding="utf-8")


def main() -> int:
    """Run the fuzzer from the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=2000)
    parser.add_argument("--meshes", type=int, default=200)
    parser.add_argument("--case", action="append", help='only this one, such as "scene 17"; may be repeated')
    parser.add_argument("--keep", type=Path, help="folder for the cases that failed, each with all that it names")
    given = parser.parse_args()
    cases = given.case or all_cases(given.scenes, given.meshes)
    report = fuzz(cases, given.seed, given.keep, limit=float("inf"))
    for case, fault in report.faults:
        print(f"--- {case}\n{fault}")
    print(f"{report.seconds:.1f} s", dict(report.ends), report.slowest, sep="\n")
    return 1 if report.faults else 0


def all_cases(scenes: int, meshes: int) -> list[str]:
    """Names of the cases of a run, the meshes first."""
    return [*(f"mesh {number}" for number in range(meshes)), *(f"scene {number}" for number in range(scenes))]


if __name__ == "__main__":
    raise SystemExit(main())
