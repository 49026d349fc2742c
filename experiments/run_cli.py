"""`airlight run` and `airlight page`."""

from __future__ import annotations

import json
import shlex
import sys
from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from experiments.termination import terminated_cleanly
from scenes.errors import InputError
from scenes.messages import readable

if TYPE_CHECKING:
    from experiments.suite import Case


def run(
    suite: Annotated[
        str, typer.Argument(metavar="SUITE", help="A shipped suite's name or the path of a TOML file.")
    ] = "quick",
    out: Annotated[Path, typer.Option(help="Folder in which the folder of this run is made.")] = Path("runs"),
    change: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="As if the file had it: --set size=[128,128]; repeatable."),
    ] = None,
    case: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Only this case, or those of a pattern; repeatable.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A cluster of dask that is already there.")
    ] = None,
    max_failures: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Leave the rest once so many cases have failed.")
    ] = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Begin anew, even where a stopped run could go on.")] = False,
    resume: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Go on with the run in this folder, and no other.")
    ] = None,
) -> Path:
    """Run a suite: techniques beside references, with a table, a report, a sheet and an EXR per case.

    Each finished case is kept at once. The same command again goes on with a run that was stopped, or whose cases
    failed, where nothing has changed since. Exits with 1 where a case failed.

    Example: airlight run quick --set size=[128,128]
    """
    from experiments.console import console, say, warn
    from experiments.suite import cases_of, load_suite
    from experiments.terminal import RunWatcher, announce_variant, results_table

    if fresh and resume:
        raise InputError(f"--fresh begins anew and --resume goes on with {resume}; leave one out.")
    changes = tuple(change or ())
    name, loaded = load_suite(suite, changes)
    cases = _chosen(cases_of(loaded), case, suite)
    # says which Mitsuba serves before anything is computed
    announce_variant()
    from experiments.run.cluster import cluster
    from experiments.run.folder import begin_run, digest_of, finish_run, resume_run
    from experiments.run.rows import finished
    from experiments.run.scenes_of import look_at_scenes
    from experiments.run.suite_run import Plan, SuiteRun
    from gpu_impl.own_technique import OwnTechnique

    seen = look_at_scenes(cases)
    for notice in seen.notices:
        warn(notice)
    digest = digest_of(loaded, cases, seen.digests)
    command = shlex.join([Path(sys.argv[0]).name, *sys.argv[1:]])
    techniques = [case.technique for case in cases]
    contents = {
        "command": command,
        "study": loaded.study,
        "cases": len(cases),
        "contents": loaded.model_dump(mode="json"),
        # what files hold, by the technique's file: no table has it
        "own_techniques": {one.file: json.loads(one.texts) for one in techniques if isinstance(one, OwnTechnique)},
    }
    if resume:
        folder = resume_run(resume, name, digest)
    else:
        folder, notice = begin_run(out, name, digest, contents, fresh)
        if notice:
            warn(notice)
    plan = Plan(suite, changes, cases, max_failures)
    try:
        with terminated_cleanly(), cluster(scheduler) as client, RunWatcher(folder.path) as watcher:
            rows = SuiteRun(client, folder, plan, watcher).run()
        from experiments.report import write_report

        report = write_report(folder.path) if rows else None
        # not before the report is there: the same command would begin anew
        if len(rows) == len(cases) and all(map(finished, rows)):
            finish_run(folder)
    except KeyboardInterrupt:
        warn(f"Stopped. What is finished is kept in {folder.path}; the same command goes on from there.")
        raise typer.Exit(130) from None
    finally:
        folder.close()
    if any(row["status"] == "done" for row in rows):
        console.print(results_table(rows))
    failed = [row for row in rows if row["status"] == "failed"]
    for row in failed:
        warn(f"Failed: {row['case']}: {row['reason']}\n    {row['command']}")
    say(f"Results: {folder.path.resolve()}")
    if report:
        say(f"Report: {report.resolve()}")
    if left := len(cases) - len(rows):
        warn(
            f"{left} of {len(cases)} cases were left after {len(failed)} failures; the same command goes on with them."
        )
    if failed or left:
        raise typer.Exit(1)
    return folder.path


def page(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a run.")],
    out: Annotated[Path, typer.Option(help="Folder for README.md, the table and the plots.")],
) -> None:
    """Write a run's table, plots and what they say as a page of results.

    Example: airlight page runs/aliasing-20261122-180000 --out results/aliasing
    """
    from experiments.console import say
    from experiments.run.page import write_page

    say(f"Page: {write_page(folder, out).resolve()}")


def _chosen(cases: Sequence[Case], patterns: Sequence[str] | None, suite: str) -> list[Case]:
    """Those of the cases that the command line names."""
    if not patterns:
        return list(cases)
    for pattern in patterns:
        if not any(_matches(case.name, pattern) for case in cases):
            raise InputError(
                f"The suite {suite} has no case '{readable(pattern)}'; its first of {len(cases)} is {cases[0].name}."
            )
    return [case for case in cases if any(_matches(case.name, pattern) for pattern in patterns)]


def _matches(name: str, pattern: str) -> bool:
    return name == pattern or fnmatchcase(name, pattern)
