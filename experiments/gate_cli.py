"""`airlight gate`."""

from __future__ import annotations

import os
import secrets
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from experiments.options import given_beside
from experiments.termination import terminated_cleanly
from scenes.errors import InputError

if TYPE_CHECKING:
    from experiments.suite import Case


def gate(
    context: typer.Context,
    case: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Only this case of the gate; repeatable.")
    ] = None,
    check: Annotated[
        Literal["one", "all"], typer.Option(help="How many of the references are estimated anew.")
    ] = "one",
    seed: Annotated[
        int | None, typer.Option(min=0, help="Draws that reference and its random numbers; by default by chance.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the pictures of what fails.")] = Path("gate-failures"),
    junit: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the result as JUnit XML too.")] = None,
    update: Annotated[
        bool, typer.Option("--update", help="Measure the limits anew, write them and say what changed.")
    ] = False,
    runs: Annotated[
        int,
        typer.Option(min=1, help="Of --update: runs on an idle machine, and on a loaded one; fewer than 10 to try it."),
    ] = 10,
    mutations: Annotated[
        bool, typer.Option("--mutations", help="Spoil the shaders on purpose: the gate must notice it.")
    ] = False,
) -> None:
    """Hold techniques against committed references and limits.

    Exits with 1 where a value is beyond its limit, a reference is missing, stale or no longer agrees with Mitsuba, or a
    mutation goes unnoticed. Half a minute; --mutations takes two minutes, and --update seven of one core.

    Example: airlight gate --junit gate.xml
    """
    from experiments.gate.suite import gate_cases, stand_in_meshes

    if update and mutations:
        raise InputError("--update and --mutations are two commands; leave one out.")
    allowed = ("update", "runs") if update else ("mutations", "case") if mutations else ()
    if allowed and (idle := given_beside(context, allowed)):
        raise InputError(f"{idle[0]} has no meaning beside --{allowed[0]}; leave it out.")
    cases = gate_cases(case or ())
    with terminated_cleanly(), stand_in_meshes():
        if update:
            _update(cases, runs)
        elif mutations:
            _mutate(cases)
        else:
            _gate(cases, check, secrets.randbelow(1 << 32) if seed is None else seed, out, junit)


def _gate(cases: Sequence[Case], check: Literal["one", "all"], seed: int, out: Path, junit: Path | None) -> None:
    from experiments.console import console, notices, say, warn
    from experiments.exr import check_writable
    from experiments.gate.gating import check_folder, run_gate, write_pictures
    from experiments.gate.junit import write_junit
    from experiments.gate.limits import limits_for
    from experiments.gate.suite import gate_cases
    from experiments.gate.tables import result_table
    from experiments.run.watcher import Watcher

    # better before the work than after it
    check_folder(out)
    if junit:
        check_writable(junit)
    limits = limits_for(gate_cases())
    with notices.status("gate"):
        result = run_gate(cases, limits, check, seed, Watcher())
    console.print(result_table(result))
    for agreement in result.agreements:
        (say if agreement.comparison and agreement.agrees else warn)(f"Reference {agreement} (--seed {seed}).")
    for verdict in result.verdicts:
        if verdict.is_better:
            say(f"Better: {verdict}; `airlight gate --update` lowers the limit.")
    for name, reason in result.broken.items():
        warn(f"Failed: {name}: {reason}")
    for verdict in result.failed:
        warn(f"Failed: {verdict}.")
    if result.passes:
        but = "" if result.estimated_anew else "; no reference was estimated anew"
        say(f"The gate holds: {len(result.verdicts)} values of {len(cases)} cases within their limits{but}.")
    # the verdict has been told, and its exit code stands whatever becomes of its files
    if junit:
        try:
            write_junit(result, junit)
        except InputError as error:
            if result.passes:
                raise
            warn(str(error))
    if result.passes:
        return
    try:
        if written := write_pictures(cases, result, out):
            say(f"Pictures: {', '.join(str(path) for path in written)}, and a sheet of each")
    except InputError as error:
        warn(str(error))
    raise typer.Exit(1)


def _mutate(cases: Sequence[Case]) -> None:
    from experiments.console import console, notices, say, warn
    from experiments.gate.limits import limits_for
    from experiments.gate.measuring import measure_cases
    from experiments.gate.mutations import MUTATIONS, try_mutation
    from experiments.gate.suite import gate_cases
    from experiments.gate.tables import mutation_table
    from experiments.gate.verdicts import judge

    limits = limits_for(gate_cases())
    with notices.status("control") as status:
        control = [verdict for verdict in judge(measure_cases(cases), limits) if not verdict.passes]
        outcomes = []
        for mutation in [] if control else MUTATIONS:
            status.update(mutation.name)
            outcomes.append(try_mutation(mutation, cases, limits))
    for verdict in control:
        warn(f"The shaders as they are fail already: {verdict}.")
    console.print(mutation_table(outcomes, len(cases)))
    unnoticed = [one.mutation.name for one in outcomes if one.mutation.must and not one.noticed]
    must, subtle = ([one for one in outcomes if one.mutation.must is kind] for kind in (True, False))
    if control or unnoticed:
        warn(f"Unnoticed: {', '.join(unnoticed) or 'all, for the control fails'}.")
        raise typer.Exit(1)
    seen = sum(one.noticed for one in subtle)
    say(f"The control passes; all {len(must)} mutations are noticed, and {seen} of {len(subtle)} subtler ones.")


def _update(cases: Sequence[Case], runs: int) -> None:
    from experiments.console import console, notices, say, warn
    from experiments.gate.limits import PATH, RUNS, read_limits, write_limits
    from experiments.gate.tables import change_table
    from experiments.gate.update import changes, measure_limits, renew_references
    from gpu_impl.device import shared_device

    load = os.getloadavg()[0]
    with notices.status("update") as status:
        for path, why in renew_references(cases, secrets.randbelow(1 << 32), status.update):
            say(f"{why}\nReference: {path}")
        new = measure_limits(cases, runs, status.update)
    try:
        old = read_limits()
    except InputError as error:
        say(f"{error} It is written now.")
        old = {}
    changed = list(changes(old, new))
    # what else ran meanwhile: idle is what this command leaves idle
    told = {"runs_idle": runs, "runs_loaded": runs, "load_average_before": f"{load:.1f}"}
    if runs < RUNS:
        told["note"] = f"fewer runs than {RUNS}: a trial, and not to be committed"
        warn(f"{runs} runs are a trial: limits that are committed need {RUNS}.")
    write_limits(new, told | {"gl_renderer": shared_device().info.renderer})
    if changed:
        console.print(change_table(changed))
    say(f"Limits: {PATH}, {len(changed)} of {sum(map(len, new.values()))} changed")
