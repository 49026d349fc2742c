"""What `airlight agree` prints: a line for each pair and test, one for each mutation."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, SpinnerColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from experiments.agree.cases import OWN_POWER, Case, Finding, examine, failed
from experiments.agree.page import convention_line, met_no_light, noticed_by, percent, pooled_line, write_page
from experiments.bars import Bars
from experiments.console import console, notices, plain_table, say, warn
from experiments.terminal import announce_scene
from reference.agreement.witnesses import IMAGE_POWER
from reference.convergence import Progress
from scenes.errors import InputError
from scenes.loader import load


class _WitnessBar(Bars):
    """One bar, of the witness at work; none where standard error is no terminal."""

    def __init__(self) -> None:
        super().__init__(
            SpinnerColumn(),
            TextColumn("{task.description:<24}"),
            BarColumn(),
            TaskProgressColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.fields[note]}"),
        )
        self._task: Any = None
        self._of = ""

    def about(self, of: str) -> None:
        """Say what the witnesses are called for."""
        self._of = f"{of}: " if of else ""

    def tell(self, witness: str, progress: Progress) -> None:
        """Move the bar."""
        if not notices.is_terminal:
            return
        if self._task is None:
            self._progress.start()
            self._task = self._progress.add_task("", total=1.0, note="")
        share = progress.seconds / max(progress.seconds + progress.seconds_left, 1e-9)
        note = f"about {progress.seconds_left:.0f} s left"
        self._progress.update(self._task, description=f"{self._of}{witness}", completed=share, note=note)


def run_agree(
    cases: Sequence[Case],
    size: tuple[int, int] | None,
    time_limit: float,
    mutations: bool = False,
    out: Path | None = None,
    command: str = "",
) -> bool:
    """Call the witnesses of each case, print what they say, and write it where asked to.

    Parameters
    ----------
    time_limit : float    [s]; for volpath, in each case
    mutations : bool      spoil the estimator too
    out : Path            folder that is there; nothing is written by default
    command : str         for the page: that makes it again

    Returns
    -------
    bool   whether all pairs of all cases agree and each mutation is noticed

    Raises
    ------
    InputError
        The time limit cannot be meant; or of a single case, it cannot be loaded, the variant has no independent
        witness, or an estimate is zero or not finite. Of several cases, one that fails is a finding of its own.
    """
    if not time_limit > 0:
        raise InputError(f"The time limit is {time_limit} s; use a positive number.")
    findings: list[Finding] = []
    with _WitnessBar() as bar:
        for number, case in enumerate(cases):
            bar.about(f"{number + 1} of {len(cases)}, {case.name}" if len(cases) > 1 else "")
            begin = time.perf_counter()
            try:
                scene = load(case.scene, size, **case.parameters)
                announce_scene(scene)
                findings.append(examine(scene, case, time_limit, mutations, bar.tell))
            except Exception as error:
                # one case that fails, in whatever way, must not cost the hours of the others
                if len(cases) == 1:
                    raise
                findings.append(failed(case, error, time.perf_counter() - begin))
            _tell(findings[-1], len(cases) > 1)
    if len(cases) > 1:
        say(pooled_line(findings))
    if out:
        write_page(out, findings, command)
        say(f"Agreement: {(out / 'README.md').resolve()}")
    say(_summary(findings))
    return all(finding.agrees and not finding.unnoticed for finding in findings)


def _tell(finding: Finding, briefly: bool) -> None:
    """Print what was found in one case: a line or two, or of an only case all of it."""
    if not finding.witnesses:
        warn(f"{finding.case.name}: failed after {finding.seconds:.0f} s. {finding.failure}")
        return
    if briefly:
        say(case_line(finding))
    else:
        console.print(agreement_table(finding))
        say(f"{finding.witnesses.surfaces}.")
        say(convention_line(finding))
        if not met_no_light(finding, finding.comparisons[1]) and finding.comparisons[1].verdicts[2].power > IMAGE_POWER:
            warn(
                f"volpath stopped at its time limit: a bias of the image mean shows from "
                f"{percent(finding.comparisons[1].verdicts[2].power)} on, where {IMAGE_POWER:.1%} was aimed at."
            )
    if not finding.sharp:
        warn(
            f"{finding.case.name}: {finding.comparisons[0].name} catches a bias of the image mean only from "
            f"{percent(finding.comparisons[0].verdicts[2].power)} on, where {OWN_POWER:.1%} was aimed at."
        )
    if finding.outcomes:
        console.print(mutations_table(finding))


def case_line(finding: Finding) -> str:
    """One case in a line: what disagrees, and from where on a bias of each pair's image mean shows."""
    bad = [
        f"{comparison.name} disagrees in {verdict.test} ({verdict.largest:+.1f} / {verdict.critical:.1f})"
        for comparison in finding.comparisons
        for verdict in comparison.verdicts
        if not verdict.agrees
    ]
    if finding.witnesses and not finding.witnesses.surfaces.agrees:
        bad.append(str(finding.witnesses.surfaces))
    catches = ", ".join(percent(comparison.verdicts[2].power) for comparison in finding.comparisons)
    return f"{finding.case.name}: {'; '.join(bad) or 'agrees'}; catches {catches} of the mean; {finding.seconds:.0f} s"


def agreement_table(finding: Finding) -> Table:
    """A line for each pair and test."""
    width, height = finding.about["size"].split()
    table = plain_table(f"{finding.case.name}, {width} x {height}: do independent estimates agree?")
    for heading in ("pair", "test"):
        table.add_column(heading, no_wrap=True)
    for heading in ("scores", "largest", "critical", "catches"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    table.add_column("mean, deviation, kurtosis", no_wrap=True)
    for comparison in finding.comparisons:
        for number, verdict in enumerate(comparison.verdicts):
            spread = comparison.spread
            table.add_row(
                "" if number else comparison.name,
                verdict.test,
                str(verdict.count),
                f"{verdict.largest:+.2f}",
                f"{verdict.critical:.2f}",
                percent(verdict.power),
                "DISAGREES" if not verdict.agrees else "no light" if met_no_light(finding, comparison) else "agrees",
                "" if number else f"{spread.mean:+.3f}, {spread.deviation:.3f}, {spread.kurtosis:.2f}",
            )
    table.caption = (
        "largest: difference in standard errors, on a Gaussian's scale. critical: exceeded once in 10,000 tests by "
        "chance, where the mean of a pass is near a Gaussian. catches: the smallest bias, the same factor on every "
        "pixel, that shows with 95 % probability. "
        "mean, deviation, kurtosis: of the pixels' scores; of a Gaussian 0, 1, 3, and less spread out where the error "
        "allows for what the samples may not have met."
    )
    return table


def mutations_table(finding: Finding) -> Table:
    """A line for each mutation and witness."""
    table = plain_table(f"{finding.case.name}: the estimator spoilt on purpose")
    table.add_column("mutation", no_wrap=True)
    table.add_column("against", no_wrap=True)
    table.add_column("image mean", justify="right", no_wrap=True)
    for test in ("pixels", "tiles", "image mean"):
        table.add_column(f"z {test}", justify="right", no_wrap=True)
    table.add_column("outcome", overflow="fold")
    for outcome in finding.outcomes:
        if outcome.idle:
            table.add_row(outcome.mutation.name, "", "", "", "", "", f"no bearing on this scene: {outcome.idle}")
        for number, (comparison, by) in enumerate(zip(outcome.comparisons, outcome.noticed_by, strict=True)):
            table.add_row(
                "" if number else outcome.mutation.name,
                comparison.second.name,
                f"{comparison.difference:+.2%}",
                *(f"{verdict.largest:+.1f}" for verdict in comparison.verdicts),
                noticed_by(comparison, by),
            )
    table.caption = "\n".join(f"{outcome.mutation.name}: {outcome.meaning}." for outcome in finding.outcomes)
    return table


def _summary(findings: Sequence[Finding]) -> str:
    bad = [
        f"{finding.case.name}: {comparison.name}" if len(findings) > 1 else comparison.name
        for finding in findings
        for comparison in finding.comparisons
        if not comparison.agrees
    ]
    bad += [
        f"{finding.case.name}: surfaces" if len(findings) > 1 else "surfaces"
        for finding in findings
        if finding.witnesses and not finding.witnesses.surfaces.agrees
    ]
    lost = [finding.case.name for finding in findings if finding.failure]
    text = f"These disagree: {'; '.join(bad)}." if bad else ""
    text += f" These failed: {', '.join(lost)}." if lost else ""
    alone = findings[0]
    if not text and len(findings) == 1:
        dark = met_no_light(alone, alone.comparisons[1])
        text = "The two that met light agree." if dark else "All three agree."
    text = text or f"All pairs agree in all {len(findings)} cases."
    if any(finding.outcomes for finding in findings):
        unnoticed = [f"{name} ({finding.case.name})" for finding in findings for name in finding.unnoticed]
        text += f" Unnoticed: {', '.join(unnoticed)}." if unnoticed else " Each mutation that matters is noticed."
    return text.strip()
