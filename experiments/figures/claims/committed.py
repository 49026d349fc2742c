"""Numbers that cost more than a run of the figures: from tables under results/, which say how they were made."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import polars

from scenes.errors import InputError

RESULTS = Path(__file__).resolve().parents[3] / "results"
PAIRS = "technique_benchmark/claims/pairs.csv"
AUDIT = "audit/audit.json"
# of the benchmark's pairs (experiments/technique_benchmark/contenders.py) those that claims ask for, and their scenes
AS_DENSE, AS_MANY = ("whole ray as dense", "quadrature"), ("whole ray with as many samples", "quadrature")
THREE_EI = "four Ei", "three Ei"
PAIR_SCENES = "donut_dragon", "empty"
# of the audit's equations
ALGORITHM, EVALUATIONS = "Alg. 4.1", "Fig. 4.11"


def check_results() -> None:
    """Raise InputError where a table is missing, or lacks what claims ask for."""
    for name in (PAIRS, AUDIT):
        if not (RESULTS / name).is_file():
            raise InputError(
                f"The claims need {RESULTS / name}, which a checkout of airlight has: run the command in one, or draw "
                "figures alone with --only."
            )
    for first, second in (AS_DENSE, AS_MANY, THREE_EI):
        pairs(first, second)
    for equation in (ALGORITHM, EVALUATIONS):
        printed_residual(equation)


def pairs(first: str, second: str) -> list[dict[str, Any]]:
    """Timed pairs of contenders, a row a scene.

    Raises
    ------
    InputError
        The table has not each of `PAIR_SCENES` once: of no row all would be true.
    """
    found = polars.read_csv(RESULTS / PAIRS)
    if missing := {"first", "second", "scene"} - set(found.columns):
        raise InputError(f"{RESULTS / PAIRS} has no column {', '.join(sorted(missing))}.")
    rows = found.filter((polars.col("first") == first) & (polars.col("second") == second)).to_dicts()
    scenes = sorted(row["scene"] for row in rows)
    if scenes != list(PAIR_SCENES):
        raise InputError(
            f"The claims need '{first}' beside '{second}' in {RESULTS / PAIRS} once for each of "
            f"{', '.join(PAIR_SCENES)}, and it has {', '.join(scenes) or 'no row'}."
        )
    return rows


def printed_residual(equation: str) -> float:
    """How far an equation is off as it is printed.

    Raises
    ------
    InputError
        The audit has it not once.
    """
    audit = json.loads((RESULTS / AUDIT).read_text(encoding="utf-8"))
    found = [one["residual_printed"] for one in audit if one["equation"] == equation]
    if len(found) != 1:
        raise InputError(f"The claims need '{equation}' once in {RESULTS / AUDIT}, which has it {len(found)} times.")
    return float(found[0])
