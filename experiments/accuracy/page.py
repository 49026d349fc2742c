"""What `airlight accuracy --out` writes: a page, a table and a figure."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

import polars

from experiments.accuracy.figure import draw_figure
from experiments.accuracy.study import (
    COMPARED,
    LIMITS,
    PHASES,
    PRINTED,
    SHADOW_MAP,
    SHADOW_MAP_LADDER,
    STEPS,
    STEPS_LADDER,
    Row,
    judged,
    passes,
)
from experiments.pages import made_by
from scenes.replacing import replacing

TITLE = "How near the repaired technique comes"
PAGE = """# {title}

{made} Drawn on {renderer}; {meshes}.

`{technique}` at {size}, every pixel evaluated, against the deterministic reference (ray casting and quadrature, through
the same pixel centres): relative errors of the scattering layer over the pixels with airlight. With {steps} samples in
the shadow region and {shadow_map} texels on a side of the shadow map {verdict}.{progress}

{table}

What is left shrinks with the samples (with {best_map} texels) and with the shadow map (with {best_steps} samples):

![Errors against samples and texels](curves.png)

{curves}
{composition}
[results.csv](results.csv) holds all metrics of all {count} pictures.
"""


COMPOSITION = """
Eq. 14 as it is printed attenuates the surface's light on its way to the eye alone, not from the light to the surface
(setting `composition`). How much brighter pictures are for it, printed over physical - 1 of the image's mean, with
{steps} samples and {shadow_map} texels and the {phase} phase function; the scattering layer is the same in both:

{table}
"""


def write_page(folder: Path, rows: Sequence[Row], technique: str, scenes: Sequence[str]) -> None:
    """Write results.csv, curves.png and README.md, over those that are there.

    Parameters
    ----------
    rows : of the cases that are measured so far
    scenes : all that are to be measured

    Raises
    ------
    InputError
        The files cannot be written.
    """
    first = rows[0]
    command = shlex.join(
        [
            *("airlight", "accuracy", *scenes, "--size", *first["size"].split()),
            *("--technique", technique, "--out", str(folder)),
        ]
    )
    with replacing(folder / "results.csv") as beside:
        polars.DataFrame(rows, infer_schema_length=None).write_csv(beside)
    draw_figure(
        folder / "curves.png",
        rows,
        f"{command}; commit {first['commit']}, {first['date'][:10]}; {first['gl_renderer']}",
    )
    done, asked = len(judged(rows)), len(scenes) * len(PHASES)
    stand_ins = sorted({name for row in rows for name in row["stand_ins"].split()})
    text = PAGE.format(
        title=TITLE,
        made=made_by(command, "mitsuba", "moderngl", "numpy"),
        renderer=first["gl_renderer"],
        meshes=f"stand-ins for {', '.join(stand_ins)}" if stand_ins else "all meshes are the scenes' own",
        technique=technique,
        size=" x ".join(first["size"].split()),
        steps=STEPS,
        shadow_map=SHADOW_MAP,
        verdict=verdict(rows),
        progress="" if done == asked else f" So far {done} of {asked} cases are measured.",
        table="\n".join(_table(judged(rows))),
        best_map=SHADOW_MAP_LADDER[-1],
        best_steps=STEPS_LADDER[-1],
        curves="\n".join(_curves(rows)),
        composition=_composition(rows),
        count=len(rows),
    )
    with replacing(folder / "README.md") as beside:
        beside.write_text(text, encoding="utf-8")


def verdict(rows: Sequence[Row]) -> str:
    """How many cases keep which limits, and which cases do not."""
    found = judged(rows)
    missed = [f"{row['scene']} with {row['phase']}" for row in found if not passes(row)]
    limits = f"{LIMITS[0]:.0%} (median) and {LIMITS[1]:.0%} (95th percentile)"
    kept = f"{len(found) - len(missed)} of {len(found)} cases keep the limits of {limits}"
    return f"{kept}, all but {', '.join(missed)}" if missed else kept


def _table(rows: Sequence[Row]) -> list[str]:
    lines = ["| scene | phase function | median | 95 % | 99 % | image mean |", "|---|---|---:|---:|---:|---:|"]
    return lines + [
        f"| {row['scene']} | {row['phase']} | {row['rel_50']:.3%} | {row['rel_95']:.3%} | {row['rel_99']:.2%} "
        f"| {row['image_mean_rel']:+.4%} |"
        for row in rows
    ]


def _composition(rows: Sequence[Row]) -> str:
    """The difference between the two compositions; empty where no surface is seen."""
    found = [row for row in rows if row[PRINTED["surface"]] is not None]
    if not found:
        return ""
    lines = [f"| scene | {' | '.join(PRINTED)} |", "|---|---:|---:|"]
    lines += [f"| {row['scene']} | {' | '.join(f'{row[key]:+.2%}' for key in PRINTED.values())} |" for row in found]
    return COMPOSITION.format(steps=STEPS, shadow_map=SHADOW_MAP, phase=COMPARED, table="\n".join(lines))


def _curves(rows: Sequence[Row]) -> list[str]:
    """The 95th percentile along both ladders, a line a case."""
    steps = [f"{steps} samples" for steps in STEPS_LADDER]
    maps = [f"{texels} texels" for texels in SHADOW_MAP_LADDER[:-1]]
    lines = [f"| 95 % | | {' | '.join(steps + maps)} |", "|---|---|" + "---:|" * len(steps + maps)]
    cases = list(dict.fromkeys((row["scene"], row["phase"]) for row in rows))
    found = {(row["scene"], row["phase"], int(row["steps"]), int(row["shadow_map"])): row["rel_95"] for row in rows}
    for case in cases:
        along = [found[*case, n, SHADOW_MAP_LADDER[-1]] for n in STEPS_LADDER]
        across = [found[*case, STEPS_LADDER[-1], n] for n in SHADOW_MAP_LADDER[:-1]]
        lines.append(f"| {' | '.join(case)} | {' | '.join(f'{one:.2%}' for one in along + across)} |")
    return lines
