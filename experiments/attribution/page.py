"""What `airlight attribute --out` writes: a page, tables, a stacked bar per technique and maps."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import polars

from experiments.attribution.coalitions import PARTS
from experiments.attribution.maps import draw_maps
from experiments.attribution.measurement import Attribution
from experiments.attribution.planted import SHADOW_MAPS
from experiments.attribution.stacked_bars import draw_bars
from experiments.attribution.tables import REMAINS, WHOLE, as_object, other_surfaces, percent, rows, shares, told_rms
from experiments.markdown import table
from experiments.pages import made_by
from experiments.provenance import commit, describe_reference, describe_scene
from gpu_impl.device import shared_device
from reference.estimate import Reference
from scenes.model import Scene
from scenes.replacing import replacing

TITLE = "Where the error comes from"
PAGE = """# {title}

{made} OpenGL on {renderer}.

The scattering layer of {scene}, {phase} fog, {width} x {height} pixels, against a {kind} reference known to a relative
{error} of {rel_error:.2%} (95th percentile of the lit pixels).

![Share of each part in the mean squared error](bars.png)

{summary}

Each technique is visibility x airlight model x lattice. Each part was replaced by its exact control, in all
combinations, and the change of the mean squared error shared out as Shapley values: what a part's replacement takes
away, averaged over every order of replacing them. The parts add up to what replacing all of them takes away, which is
the 100 % here; with what remains then, they add up to the whole error. {noise}

A part may be negative: errors of opposite sign hide each other, so that taking one away shows the other. Where one part
is much below zero and another much above, the two belong together, and neither number says what replacing that part
alone would do; results.json has the error of each combination.

The exact controls are: the airlight model by quadrature; the visibility by every crossing of the ray through the
technique's own shadow map; the shadow map by the reference's shadow rays in its place; both of these by the
reference's lit intervals; the lattice by every pixel; float32 by the same pieces evaluated and summed in float64. What
float32 does to the places of the pieces is the visibility's, and so is what a strategy interpolates between corners;
what the shader's quadrature leaves is float32's, which is more than rounding under a soft spot or one with a picture. A
model that samples points gets the pieces cut into the technique's steps where the visibility is exact. What remains is
what the reference and the exact combination disagree on.

{surfaces}

What errors of a known kind are charged to is tried by `airlight attribute --planted`. A coarse shadow map is not
charged to that part alone with every technique: {shadow_maps}.

## Pixel by pixel

![Signed error of each part](maps.png)

The signed error of each pixel, shared out in the same way; here nothing is squared, and no noise enters the parts.
Image mean: what the part does to the mean of the picture. RMS: of its map, over the mean of the reference; squares of
these do not add up.

{sections}

[results.csv](results.csv), [results.parquet](results.parquet) and [results.json](results.json) hold all numbers.
"""
NOISE = "The noise of the reference is subtracted, and +- is the standard error that it leaves."
BOUND = "The reference has no noise, so that nothing is subtracted; +- bounds what its error does."
FILES = ("README.md", "bars.png", "maps.png", "results.csv", "results.json", "results.parquet")


def write_page(folder: Path, scene: Scene, reference: Reference, found: Sequence[Attribution], command: str) -> None:
    """Write `FILES` over those that are there.

    Parameters
    ----------
    found : of one scene
    command : that makes the page again

    Raises
    ------
    InputError
        The files cannot be written.
    """
    info = shared_device().info
    about = describe_scene(scene) | describe_reference(reference) | {"gl_renderer": info.renderer}
    flat = polars.DataFrame([about | row for one in found for row in rows(one)], infer_schema_length=None)
    with replacing(folder / "results.csv") as beside:
        flat.write_csv(beside)
    with replacing(folder / "results.parquet") as beside:
        flat.write_parquet(beside)
    with replacing(folder / "results.json") as beside:
        beside.write_text(json.dumps(about | {"techniques": list(map(as_object, found))}, indent=2) + "\n")
    below = f"{command}; commit {commit()}, {about['date'][:10]}; {info.renderer}"
    draw_bars(folder / "bars.png", found, below)
    draw_maps(folder / "maps.png", found, below)
    stand_in = f" (stand-in for {', '.join(scene.stand_ins)})" if scene.stand_ins else ""
    text = PAGE.format(
        title=TITLE,
        made=made_by(command, "moderngl", "mitsuba", "drjit", "numpy"),
        renderer=info.renderer,
        scene=scene.name + stand_in,
        phase=scene.phase.name,
        width=scene.camera.width,
        height=scene.camera.height,
        kind="deterministic" if found[0].deterministic else "sampled",
        error="error" if found[0].deterministic else "standard error",
        rel_error=reference.estimate.rel_error,
        noise=BOUND if found[0].deterministic else NOISE,
        surfaces=other_surfaces(found),
        shadow_maps=SHADOW_MAPS,
        summary=_summary(found),
        sections="\n\n".join(map(_section, found)),
    )
    with replacing(folder / "README.md") as beside:
        beside.write_text(text, encoding="utf-8")


def _summary(found: Sequence[Attribution]) -> str:
    """A line a technique: its error, the share of each part, and what remains."""
    headings = ("technique", "RMS of all parts, of the mean", *PARTS, f"RMS that {REMAINS}")
    lines = []
    for one in found:
        split, there = one.split, shares(one)
        cells = [percent(split.fraction(there[part])) if part in there else "" for part in PARTS]
        lines.append([one.label, told_rms(one, split.together), *cells, told_rms(one, split.remains)])
    return table(headings, lines)


def _section(found: Attribution) -> str:
    headings = ("part", "squared error", "+-", "of all parts", "image mean", "RMS")
    lines = [
        [
            row["part"],
            f"{row['squared_error']:.4e}",
            f"{row['standard_error']:.1e}",
            "" if row["of_parts"] is None or row["part"] in (WHOLE, REMAINS) else percent(row["of_parts"]),
            f"{row['image_mean']:+.4%}",
            f"{row['rms']:.4%}",
        ]
        for row in rows(found)
        if not row["left_out"]
    ]
    left_out = [f"- {part}: {reason}." for part, reason in found.parts.left_out.items()]
    text = [f"### {found.label}", "", table(headings, lines)]
    return "\n".join([*text, *(["", "Left out:", "", *left_out] if left_out else [])])
