"""The page beside the figures: what was measured and how, the tables in short, and what follows from the numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from experiments.atlas.counting import OPERATIONS
from experiments.atlas.errors import TRUTH
from experiments.atlas.grid import Grid
from experiments.atlas.method import method
from experiments.atlas.timing import REFERENCE, processor
from experiments.pages import made_by
from scenes.replacing import replacing

__all__ = ["TITLE", "write_page"]

Row = dict[str, Any]

TITLE = "The atlas: how wrong each airlight model is, and what it costs"

# drawn by experiments.atlas.exponential_integral_map into the same folder
EXPONENTIAL_INTEGRAL = "exponential_integral.png"
# heading, precision, column of errors.csv, format
ERROR_COLUMNS = (
    ("float64: off by > 1e-9", "float64", "off_by_1e-9", ".2%"),
    ("95 %", "float64", "percentile_95", ".1e"),
    ("worst", "float64", "worst", ".1e"),
    ("float32: off by > 1 %", "float32", "off_by_1e-2", ".2%"),
    ("> 0.1 %", "float32", "off_by_1e-3", ".2%"),
    ("95 %", "float32", "percentile_95", ".1e"),
    ("worst", "float32", "worst", ".1e"),
    ("not finite", "float32", "not_finite", ".2%"),
)
# what can be said of a model, precision, whether a row of the visible segments says so; a model is named where it
# first fits
FINDINGS: tuple[tuple[str, str, Callable[[Row], bool]], ...] = (
    ("every segment within 1e-9", "float64", lambda row: row["worst"] <= 1e-9),
    ("95 % of the segments within 1e-9", "float64", lambda row: row["percentile_95"] <= 1e-9),
    ("every segment within 1e-4", "float32", lambda row: row["worst"] <= 1e-4),
    ("every segment within 1 %", "float32", lambda row: row["worst"] <= 1e-2),
    ("95 % of the segments within 1 %", "float32", lambda row: row["percentile_95"] <= 1e-2),
    ("none of these", "float32", lambda row: True),
)


def write_page(
    path: Path, grid: Grid, errors: list[Row], costs: list[Row], truths: dict[str, float], timed: int, seconds: float
) -> None:
    """Write README.md.

    Parameters
    ----------
    errors, costs : rows of errors.csv and cost.csv
    truths : largest relative error of the truth by phase function
    timed : int      segments that were timed
    seconds : float  that all of it took
    """
    visible = [row for row in errors if row["segments"] == "visible"]
    parts = [
        f"# {TITLE}",
        _made(seconds),
        "## What is measured",
        method(grid, truths, timed),
        "## What the numbers say",
        "Of the visible segments; a model is named where it first fits.",
        *(_findings(label, _of(visible, label)) for label in truths),
        "## Errors",
        "Of the visible segments. [errors.csv](errors.csv) has the medians too, and the same over all segments; "
        "[maps.parquet](maps.parquet) the 95th percentile and the worst of each cell.",
        *(_error_table(label, _of(visible, label)) for label in truths),
        "## Cost",
        "Of a segment, in float32 (the truth in float64): operations, and time as a multiple of the time of "
        f"`{REFERENCE}` with its 64 steps, median (lower to upper quartile). [cost.csv](cost.csv) has float64 too.",
        *(_cost_table(label, _of(costs, label)) for label in truths),
    ]
    if (path.parent / EXPONENTIAL_INTEGRAL).is_file():
        parts += [
            f"## The complex exponential integral\n\n[Where on the plane it is accurate]({EXPONENTIAL_INTEGRAL})."
        ]
    with replacing(path) as beside:
        beside.write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def _of(rows: list[Row], label: str) -> list[Row]:
    return [row for row in rows if row["phase"] == label]


def _made(seconds: float) -> str:
    made = made_by("airlight atlas --out results/atlas", "numpy", "scipy", "mpmath")
    return (
        f"{made} It took {seconds:.0f} s on {processor()}. The models are those of `analytic.MODELS`. The command "
        "writes this page, its tables and its maps."
    )


def _findings(label: str, rows: list[Row]) -> str:
    """Models sorted by what their numbers allow to say."""
    lines = [f"### {label}\n\n![Error maps for {label}]({label}.png)\n"]
    named: set[tuple[str, str]] = set()
    for statement, precision, holds in FINDINGS:
        candidates = [row["model"] for row in rows if row["precision"] == precision and holds(row)]
        new = [model for model in candidates if (model, precision) not in named]
        named |= {(model, precision) for model in new}
        lines.append(f"- {precision}, {statement}: {', '.join(f'`{model}`' for model in new) or 'none'}.")
    return "\n".join(lines)


def _error_table(label: str, rows: list[Row]) -> str:
    by = {(row["model"], row["precision"]): row for row in rows}
    lines = (
        [f"`{model}`", *(format(by[model, precision][key], form) for _, precision, key, form in ERROR_COLUMNS)]
        for model in dict.fromkeys(row["model"] for row in rows)
    )
    return _table([label, *(heading for heading, *_ in ERROR_COLUMNS)], lines)


def _cost_table(label: str, rows: list[Row]) -> str:
    lines = (
        [
            f"`{row['model']}`",
            *(f"{row[operation]:.3g}" for operation in OPERATIONS),
            f"{row['ratio_median']:.2f} ({row['ratio_lower_quartile']:.2f} to {row['ratio_upper_quartile']:.2f})",
        ]
        for row in rows
        if row["precision"] == "float32" or row["model"] == TRUTH
    )
    return _table([label, *(operation.replace("_", " ") for operation in OPERATIONS), "time"], lines)


def _table(headings: list[str], lines: Iterable[list[str]]) -> str:
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (headings, ["---"] * len(headings), *lines))
