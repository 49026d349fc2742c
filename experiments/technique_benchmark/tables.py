"""The tables of the benchmark's page, as Markdown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from experiments.markdown import table
from experiments.technique_benchmark.budget import triangle_count
from experiments.technique_benchmark.contenders import BASELINE, PAIRS, published_rate
from experiments.technique_benchmark.measurement import Result
from experiments.technique_benchmark.summary import Row, fastest, is_within, pair_rows, rows, told
from gpu_impl.timing import PASSES

MEGABYTE = 1e6


def title(result: Result) -> str:
    """What a section is about; a star for stand-in meshes."""
    scene = result.scene
    return f"{scene.name}{'*' * bool(scene.stand_ins)}, {scene.phase.name}"


def rates_table(results: Sequence[Result]) -> str:
    """Frames a second of the fast rows beside Table 5.1; empty where there is none."""
    headings = (
        "scene and phase function",
        "triangles",
        "fast row",
        "ms",
        "frames/s",
        "Table 5.1, frames/s",
        "error, median",
        "95 %",
        "within the limits",
    )
    lines = []
    for result in results:
        published = published_rate(result.scene)
        if not (one := fastest(result)) or not one.metrics:
            continue
        median = float(np.median(one.times.milliseconds))
        lines.append(
            [
                title(result),
                f"{triangle_count(result.scene):,}",
                f"{one.contender.name} ({one.technique.airlight})",
                _short(median),
                _short(1e3 / median),
                "" if published is None else str(published),
                *map(_error, (one.metrics.rel_50, one.metrics.rel_95)),
                "yes" if is_within(one) else "no",
            ]
        )
    return table(headings, lines) if lines else ""


def passes_table(results: Sequence[Result]) -> str:
    """Milliseconds of each pass of the fast rows, and of a frame with and without the clock; empty where is none."""
    headings = ("scene and phase function", *PASSES, "sum", "frame, clocked", "frame")
    lines = []
    for result in results:
        if not (one := fastest(result)):
            continue
        passes = [one.times.pass_median(name) for name in PASSES]
        numbers = [*passes, sum(passes), float(np.median(one.times.clocked)), float(np.median(one.times.milliseconds))]
        lines.append([title(result), *map(_short, numbers)])
    return table(headings, lines) if lines else ""


def pairs_table(results: Sequence[Result]) -> str:
    """The paired timings below what is claimed; empty where no pair was drawn."""
    headings = (
        "pair",
        "scene and phase function",
        "frame",
        "scattering pass",
        "samples, first / second",
        "Ei a ray, first / second",
        "told by the frames",
    )
    found = [(result, row) for result in results for row in pair_rows(result)]
    if not found:
        return ""
    there = {(row["first"], row["second"]) for _, row in found}
    pairs = [pair for pair in PAIRS if (pair.first, pair.second) in there]
    lines = [
        [
            f"{pair.first} / {pair.second}",
            title(result),
            _interval(row, "ratio"),
            _interval(row, "scattering_ratio"),
            f"{row['first_steps']} / {row['second_steps']}",
            f"{row['first_exponential_integrals']:.4g} / {row['second_exponential_integrals']:.4g}",
            told(row),
        ]
        for pair in pairs
        for result, row in found
        if (row["first"], row["second"]) == (pair.first, pair.second)
    ]
    claims = [f"- {pair.first} / {pair.second}: {pair.claim}." for pair in pairs]
    return "\n".join([*claims, "", table(headings, lines)])


def contenders_table(result: Result) -> str:
    """All contenders of a scene; above, what it costs with any of them, below, why others refuse it."""
    headings = (
        "contender",
        "ms",
        f"of {BASELINE.name}",
        "error, median",
        "95 %",
        "pieces",
        "reads",
        "Ei",
        "exp",
        "kept [MB]",
        "in a frame [MB]",
        "compile [ms]",
        "set-up [ms]",
    )
    drawn = [row for row in rows(result) if not row["refusal"]]
    lines = [_line(row) for row in drawn]
    ready = float(np.median([row["scene_milliseconds"] for row in drawn]))
    held = drawn[0]["scene_bytes"] / MEGABYTE
    scene = f"Meshes and pictures: {_short(held)} MB, meshes made ready in {_short(ready)} ms."
    refused = [f"- {one.contender.name}: {one.refusal}" for one in result.contenders.values() if one.refusal]
    return "\n".join([scene, "", table(headings, lines), *(["", "Not drawn:", "", *refused] if refused else [])])


def _line(row: Row) -> list[str]:
    spread = [_short(row[f"milliseconds_{part}"]) for part in (50, 25, 75)]
    errors = [row["error_rel_50"], row["error_rel_95"]]
    counts = ("pieces", "shadow_map_reads", "exponential_integrals", "exponentials")
    return [
        f"{row['contender']}, {row['steps']} steps, 1/{row['downsample']}",
        f"{spread[0]} [{spread[1]}, {spread[2]}]",
        _interval(row, "over_march"),
        *map(_error, errors),
        *(f"{row[f'{name}_per_ray']:.4g}" for name in counts),
        *(f"{row[f'{name}_bytes'] / MEGABYTE:.2f}" for name in ("storage", "frame")),
        *(f"{row[f'{name}_milliseconds']:.0f}" for name in ("compile", "setup")),
    ]


def _interval(row: Row, name: str) -> str:
    return f"{row[name]:.3f} [{row[f'{name}_low']:.3f}, {row[f'{name}_high']:.3f}]"


def _error(value: float | None) -> str:
    return "" if value is None else f"{value:.2%}"


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"
