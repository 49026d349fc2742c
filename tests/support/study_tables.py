"""Rows of a finished run, made up: what a case is, with whatever columns a study reads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import polars

from gpu_impl.techniques import SETTINGS, find_technique

Row = dict[str, Any]


def row(technique: str = "Weng2010", status: str = "done", reason: str = "", **columns: Any) -> Row:
    """One case: settings are the technique's own where `columns` has no others."""
    found = find_technique(technique)
    settings = {name: getattr(found, name) for name in SETTINGS}
    about = {
        "product": "grid",
        "scene": "sphere",
        "phase": "isotropic",
        "width": 64,
        "height": 48,
        "camera": "",
        "status": status,
        "reason": reason,
        "gl_renderer": "made-up renderer",
    }
    row = about | {"technique": technique} | settings | columns
    return row | {"case": "-".join(str(row[name]) for name in ("product", "scene", "phase", "technique", "downsample"))}


def table(rows: Sequence[Row]) -> polars.DataFrame:
    """As a run keeps them: a column that a row lacks is empty there."""
    columns = list(dict.fromkeys(name for one in rows for name in one))
    return polars.DataFrame([{name: one.get(name) for name in columns} for one in rows], infer_schema_length=None)


def cells(text: str, *begin: str) -> list[str]:
    """The cells behind those with which one line of a Markdown table begins."""
    (line,) = [line for line in text.splitlines() if line.startswith(f"| {' | '.join(begin)} |")]
    return [cell.strip() for cell in line.strip("|").split("|")][len(begin) :]


def all_cells(text: str) -> list[str]:
    """Every cell of every Markdown table."""
    lines = [line for line in text.splitlines() if line.startswith("|") and not line.startswith("|---")]
    return [cell.strip() for line in lines for cell in line.strip().strip("|").split("|")]
