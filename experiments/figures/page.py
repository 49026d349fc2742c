"""What `airlight figures` writes beside the figures: a page with their captions, and the thesis's claims one by one."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from pathlib import Path

from experiments.figures import FIGURES, LEFT_OUT
from experiments.figures.claims import CLAIMS
from experiments.figures.claims.claim import Claim, Finding
from experiments.figures.stage import Stage
from experiments.pages import made_by
from scenes.replacing import replacing

TITLE = "Weng 2010, drawn anew"
PAGE = """# {title}

{made} On {processor}; OpenGL by {renderer}. {stand_ins}

The figures and the table of *Real-Time Analytical Volumetric Shadows Algorithm*, their captions and pages those of the
thesis, whose own pictures, meshes, cameras and lights are not known: these are airlight's scenes of the same names.
Renderings, {width} x {height} pixels, stand beside the reference: ray casting and quadrature through the same pixel
centres. In the diagrams every coordinate is computed, from the ray of one pixel: the plane through the ray and the
light is cut out of the scene, lit pieces are found by ray casting, first and last shadow polygon are those that OpenGL
draws, and of all rays of the picture the one with the highest stated score is taken
(`experiments/figures/choices.py`).

## The claims

| | claim | page | verdict | |
|--:|---|---|---|---|
{verdicts}

A verdict is decided from the numbers by the rule that stands with it: "reproduced" where the equations and algorithms
as printed keep it, "reproduced with the repair" where only the repaired ones do ([audit](../audit/README.md)), "not
reproduced" otherwise. What has no misprint (upsampling, downsampling, filtered shadows) is tested in the repaired
technique.

{claims}

## The figures

{figures}

## Left out

{left_out}
"""


def write_page(folder: Path, told: Mapping[str, str], stage: Stage, command: str) -> None:
    """Measure the claims and write README.md.

    Parameters
    ----------
    told : what is said of each figure, by its number

    Raises
    ------
    InputError
        The file cannot be written.
    """
    from experiments.atlas.timing import processor

    findings = []
    for number, claim in enumerate(CLAIMS, start=1):
        stage.tell(f"claim {number} of {len(CLAIMS)}")
        findings.append((claim, claim.measure(stage)))
    width, height = stage.size
    stand_ins = (
        f"Procedural stand-ins served for {', '.join(stage.stand_ins)}."
        if stage.stand_ins
        else "All meshes are the scenes' own."
    )
    text = PAGE.format(
        title=TITLE,
        made=made_by(command, "moderngl", "mitsuba", "drjit", "numpy", "matplotlib"),
        processor=processor(),
        renderer=stage.gl_renderer,
        stand_ins=stand_ins,
        width=width,
        height=height,
        verdicts="\n".join(_verdict(number, *one) for number, one in enumerate(findings, start=1)),
        claims="\n\n".join(_section(number, *one) for number, one in enumerate(findings, start=1)),
        figures="\n\n".join(_figure(number, text) for number, text in told.items()),
        left_out="\n".join(f"- Figure {number}: {why}" for number, why in LEFT_OUT.items()),
    )
    with replacing(folder / "README.md") as beside:
        beside.write_text(text, encoding="utf-8")


def _verdict(number: int, claim: Claim, finding: Finding) -> str:
    return f"| {number} | {claim.words} | {claim.pages} | {finding.verdict} | {_link(claim)} |"


def _section(number: int, claim: Claim, finding: Finding) -> str:
    shown = f" {_link(claim)}." if claim.figure else ""
    return (
        f"### {number}. {claim.words}\n\n{_filled(f'Page {claim.pages}. {claim.test}')}\n\n"
        f"{_filled(finding.measured)}\n\n"
        f"**{str(finding.verdict).capitalize()}.**{shown}"
    )


def _link(claim: Claim) -> str:
    if not claim.figure:
        return ""
    entry = FIGURES[claim.figure]
    return f"[{entry.name}]({entry.stem}.png)"


def _figure(number: str, text: str) -> str:
    entry = FIGURES[number]
    said, *rest = text.split("\n\n")
    return "\n\n".join(
        [
            f"### {entry.name}",
            f"> {entry.caption} (page {entry.page})",
            f"![{entry.name}]({entry.stem}.png)",
            _filled(f"{said} [PDF]({entry.stem}.pdf)"),
            *rest,
        ]
    )


def _filled(text: str) -> str:
    return textwrap.fill(text, 120, break_long_words=False, break_on_hyphens=False)
