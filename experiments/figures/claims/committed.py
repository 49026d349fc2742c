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


def check_results() -> None:
    """Raise InputError where a table is missing."""
    for name in (PAIRS, AUDIT):
        if not (RESULTS / name).is_file():
            raise InputError(
                f"The claims need {RESULTS / name}, which a checkout of airlight has: run the command in one, or draw "
                "figures alone with --only."
            )


def pairs(first: str, second: str) -> list[dict[str, Any]]:
    """Timed pairs of contenders, a row a scene."""
    found = polars.read_csv(RESULTS / PAIRS)
    return found.filter((polars.col("first") == first) & (polars.col("second") == second)).to_dicts()


def printed_residual(equation: str) -> float:
    """How far an equation is off as it is printed."""
    audit = json.loads((RESULTS / AUDIT).read_text(encoding="utf-8"))
    return float(next(one["residual_printed"] for one in audit if one["equation"] == equation))
