"""The table of results as a page shows it: which columns at once, which on demand, and which stand once above it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from experiments.run.rows import Row

Value = str | int | float | None

# what a reader looks for first, shown wherever it differs between the rows
FIRST = (
    "case", "status", "scene", "phase", "technique", "steps", "shadow_map", "downsample", "upsample", "width", "camera",
)  # fmt: skip
# of the errors, which are many
ERRORS = ("scattering.rel_50", "scattering.rel_95", "scattering.image_mean_rel", "scattering.flip", "composite.flip")
# of any other measurement: so many of its columns
OTHERS = 4


@dataclass(frozen=True)
class Column:
    """One heading, and whether it is shown at once."""

    name: str
    shown: bool


@dataclass(frozen=True)
class ResultTable:
    """A run's rows.

    Attributes
    ----------
    columns : list of Column
    rows : list of list      values, a column each: None, text, or a finite number
    same : dict              columns that have one value in all rows, and so stand once
    """

    columns: list[Column]
    rows: list[list[Value]]
    same: dict[str, Value]

    @property
    def data(self) -> dict[str, Any]:
        """All of it as the page's script reads it."""
        return {"columns": [column.name for column in self.columns], "rows": self.rows}


def result_table(rows: Sequence[Row]) -> ResultTable:
    """Sort columns into what differs and what is the same; a single row keeps what it is and its numbers."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    same = {}
    for name in names:
        values = {str(row.get(name)) for row in rows}
        if len(values) == 1 and name != "case" and not (len(rows) == 1 and (name in FIRST or "." in name)):
            same[name] = _value(rows[0].get(name))
    varying = [name for name in names if name not in same]
    order = [name for name in FIRST if name in varying]
    order += [name for name in varying if name not in order]
    shown = set(FIRST) | _numbers(varying)
    return ResultTable(
        [Column(name, name in shown) for name in order],
        [[_value(row.get(name)) for name in order] for row in rows],
        {name: value for name, value in same.items() if value not in (None, "")},
    )


def _numbers(names: Sequence[str]) -> set[str]:
    """Measured columns to show: the best known errors, and the first few of each other measurement."""
    shown = {name for name in ERRORS if name in names}
    layers = {name.partition(".")[0] for name in ERRORS} | {"surface"}
    measured: dict[str, list[str]] = {}
    for name in names:
        measurement, dot, _ = name.partition(".")
        if dot and measurement not in layers:
            measured.setdefault(measurement, []).append(name)
    return shown.union(*(columns[:OTHERS] for columns in measured.values()))


def cell_text(value: Value) -> str:
    """A value as a cell shows it, a number in four digits; table.js does the same for the columns that it adds."""
    if isinstance(value, float):
        return f"{value:.4g}"
    return "" if value is None else str(value)


def _value(value: Any) -> Value:
    """A value that JSON has."""
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    return value if isinstance(value, int) or value is None else str(value)
