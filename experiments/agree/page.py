"""What `airlight agree --out` writes: a page with a row for each pair, the scores' histogram, all numbers as JSON.

The scores themselves are written, as an EXR, of a single case alone.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from experiments.agree.cases import OWN_POWER, Finding
from experiments.agree.histogram import draw_histogram
from experiments.agree.numbers import as_json, exr_layers
from experiments.exr import write_exr
from experiments.pages import made_by, prepare_page
from experiments.provenance import environment
from reference.agreement.comparison import Comparison
from reference.agreement.pooled import Pooled, pooled
from reference.agreement.significance import POWER, SIGNIFICANCE
from reference.agreement.witnesses import IMAGE_POWER, Witnesses
from reference.estimators import Volpath
from scenes.errors import InputError
from scenes.replacing import replacing

TITLE = "Do independent estimates agree?"
# what is written beside README.md
OTHERS = ("agreement.json", "z_histogram.png", "z.exr")
PAGE = """# {title}

{made}

{about}

The main estimator is compared with two witnesses whose airlight shares no estimate with its own: the deterministic mode
(lit intervals by ray casting, float64 quadrature on them) and Mitsuba's `volpath` with one scattering event. The first
pair is of the airlight alone; where `volpath` takes part, of all light, and the surfaces that the deterministic mode is
given are the main estimator's. There the others follow `volpath`'s convention: it stops short of a light, and begins
above a surface. The surfaces that are shipped are held against those under that convention, which has to explain the
difference (`reference/agreement/surfaces.py`): {surfaces}

Each pair passes three tests: of each pixel and channel, of tiles of 8 x 8 pixels, and of the image mean. z is the
largest difference in standard errors, mapped from Student's t to a Gaussian of the same tail. The critical size behind
the stroke is exceeded once in {once:,} tests by chance, however many pixels there are (Sidak): of {tests} tests here
one in {runs:,} such pages would fail by chance. That holds where the mean of a pass is near a Gaussian, as the mean of
64 samples or more is taken to be. A test *catches* a uniform bias, the same factor on every pixel, from the size in the
column on, with {power:.0%} probability. Errors allow for what so many samples and probes may not have met
(`reference/agreement/unseen.py`): that raises what is caught, and scores may be less spread out than a Gaussian's.

The main estimator and the deterministic mode are to know the image mean to {own:.1%} or better in each case:
{sharp}

`volpath` goes on until it catches {aim:.1%} as well, or its time is over.

| scene | phase | pair | z pixels | z tiles | z image mean | catches: pixels | tiles | image mean | verdict | s |
|---|---|---|---|---|---|---|---|---|---|---|
{rows}

{closing}

![Histogram of the pixels' scores beside a Gaussian](z_histogram.png)

{files}
"""
MUTATIONS = """
## {name}: the estimator spoilt on purpose

| mutation | what it does | against | image mean | z pixels | z tiles | z image mean | outcome |
|---|---|---|---|---|---|---|---|
{rows}
"""


def prepare_folder(folder: Path) -> None:
    """Make the folder before the work begins, and see that nothing in it would be lost.

    Raises
    ------
    InputError
        If the folder cannot be made or written to, its README.md is another page, or it has none and one of the other
        files is there.
    """
    prepare_page(folder, TITLE)
    for name in OTHERS:
        if (folder / name).exists() and not (folder / "README.md").exists():
            raise InputError(f"{folder / name} is of no page of ours, and would be lost: choose another --out.")


def write_page(folder: Path, findings: Sequence[Finding], command: str) -> None:
    """Write agreement.json, z_histogram.png and README.md, and of a single case z.exr, over those that are there.

    Parameters
    ----------
    command : str    that makes the page

    Raises
    ------
    InputError
        The files cannot be written.
    """
    made, comparisons = environment(), [comparison for one in findings for comparison in one.comparisons]
    alone = findings[0] if len(findings) == 1 else None
    if alone and alone.witnesses:
        write_exr(folder / "z.exr", exr_layers(alone.witnesses, alone.comparisons), alone.about)
    if comparisons:
        draw_histogram(folder / "z_histogram.png", comparisons, f"{command}; commit {made['commit']}")
    with replacing(folder / "agreement.json") as beside:
        found = {**made, "command": command, **as_json(findings, pooled_over(findings))}
        beside.write_text(json.dumps(found, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    tests = sum(len(comparison.verdicts) for comparison in comparisons)
    blunt = [finding.case.name for finding in findings if finding.comparisons and not finding.sharp]
    exr = "[z.exr](z.exr) holds the scores of each pair by channel, and each witness's mean and standard error;\n"
    text = PAGE.format(
        title=TITLE,
        made=made_by(command, "mitsuba", "drjit", "numpy", "scipy"),
        about=_about(findings),
        once=round(1 / SIGNIFICANCE),
        tests=tests,
        runs=max(1, round(1 / (1 - (1 - SIGNIFICANCE) ** max(tests, 1)))),
        power=POWER,
        own=OWN_POWER,
        surfaces=_surfaces(findings),
        sharp=f"**not so in {', '.join(blunt)}**." if blunt else "they do.",
        aim=IMAGE_POWER,
        rows="\n".join(row for finding in findings for row in _rows(finding)),
        closing=pooled_line(findings) if alone is None else convention_line(alone),
        files=(exr if alone else "") + "[agreement.json](agreement.json) holds the numbers of this page.",
    )
    for finding in findings:
        if finding.outcomes:
            text += MUTATIONS.format(name=finding.case.name, rows="\n".join(_mutation_rows(finding)))
    with replacing(folder / "README.md") as beside:
        beside.write_text(text, encoding="utf-8")


def pooled_over(findings: Sequence[Finding]) -> Pooled | None:
    """The image means of the deterministic mode and `volpath` over all cases; None where every case failed."""
    pairs = [finding.comparisons[2] for finding in findings if finding.comparisons]
    return pooled(pairs) if pairs else None


def pooled_line(findings: Sequence[Finding]) -> str:
    """What the image means say over all cases."""
    found = pooled_over(findings)
    if found is None:
        return "No case came to an end."
    verdict = "agrees" if found.agrees else "DISAGREES"
    return (
        f"Over {found.cases} case{'s' * (found.cases != 1)}, volpath's image mean is {found.bias:+.4%} off the "
        f"deterministic mode's, with a standard error of {found.error:.4%}: z {found.score:+.2f} / "
        f"{found.critical:.2f}, {verdict}; a common bias of {percent(found.power)} would have been caught."
    )


def convention_line(finding: Finding) -> str:
    """What is allowed for on the way to `volpath`."""
    witnesses = finding.witnesses
    assert witnesses
    volpath = (
        f"volpath took {witnesses.volpath_samples} samples a pixel, and its image mean has a standard error of "
        f"{witnesses.volpath_error:.4%}."
        if np.isfinite(witnesses.volpath_error)
        else f"{_no_light(witnesses)}: it says nothing here."
    )
    return (
        f"Allowed for: volpath stops short of a light, and begins above a surface; this changes the image mean by "
        f"{witnesses.convention_shift:+.4%} here. {volpath}"
    )


def met_no_light(finding: Finding, comparison: Comparison) -> bool:
    """Tell whether `volpath` is of the pair and stayed black, so that to agree with it says little."""
    assert finding.witnesses
    return comparison.second.name == Volpath.name and not np.isfinite(finding.witnesses.volpath_error)


def _no_light(witnesses: Witnesses) -> str:
    return f"volpath met no light in {witnesses.volpath_samples} samples"


def _surfaces(findings: Sequence[Finding]) -> str:
    bad = [
        f"{finding.case.name}: {finding.witnesses.surfaces}"
        for finding in findings
        if finding.witnesses and not finding.witnesses.surfaces.agrees
    ]
    return f"**not so in {'; '.join(bad)}**." if bad else "it does."


def percent(power: float) -> str:
    """A relative bias, or that none would be caught."""
    return f"{power:.3%}" if np.isfinite(power) else "none"


def noticed_by(comparison: Comparison, by: Sequence[str]) -> str:
    """Which tests notice a spoilt estimate, in words, given those that pass the right one."""
    if by:
        return f"noticed by {'all' if len(by) == len(comparison.verdicts) else ', '.join(by)}"
    return "passes" if comparison.agrees else "cannot tell: the right estimate fails too"


def _about(findings: Sequence[Finding]) -> str:
    sizes = dict.fromkeys(finding.about["size"].replace(" ", " x ") for finding in findings if finding.about)
    stand_ins = dict.fromkeys(finding.case.scene for finding in findings if finding.about.get("stand_ins"))
    text = f"{len(findings)} case{'s' * (len(findings) != 1)} of {' or '.join(sizes) or 'no'} pixels."
    return text + (f" With procedural stand-ins for meshes: {', '.join(stand_ins)}." if stand_ins else "")


def _rows(finding: Finding) -> list[str]:
    about = f"| {finding.case.scene} | {finding.phase} |"
    if finding.failure:
        reason = finding.failure.replace("|", "\\|")
        return [f"{about} | | | | | | | **failed**: {reason} | {finding.seconds:.0f} |"]
    rows = []
    for number, comparison in enumerate(finding.comparisons):
        scores = " | ".join(f"{verdict.largest:+.2f} / {verdict.critical:.2f}" for verdict in comparison.verdicts)
        powers = " | ".join(percent(verdict.power) for verdict in comparison.verdicts)
        verdict = "agrees" if comparison.agrees else "**disagrees**"
        if comparison.agrees and met_no_light(finding, comparison):
            assert finding.witnesses
            verdict = _no_light(finding.witnesses)
        seconds = "" if number else f"{finding.seconds:.0f}"
        rows.append(f"{about} {comparison.name} | {scores} | {powers} | {verdict} | {seconds} |")
        about = "| | |"
    return rows


def _mutation_rows(finding: Finding) -> list[str]:
    rows = []
    for outcome in finding.outcomes:
        about = f"| {outcome.mutation.name} | {outcome.meaning} |"
        if outcome.idle:
            rows.append(f"{about} | | | | | no bearing on this scene: {outcome.idle} |")
        for comparison, by in zip(outcome.comparisons, outcome.noticed_by, strict=True):
            scores = " | ".join(f"{verdict.largest:+.1f}" for verdict in comparison.verdicts)
            row = f"{about} {comparison.second.name} | {comparison.difference:+.2%} | {scores}"
            rows.append(f"{row} | {noticed_by(comparison, by)} |")
            about = "| | |"
    return rows
