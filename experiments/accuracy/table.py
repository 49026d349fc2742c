"""The table that `airlight accuracy` prints."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from experiments.accuracy.study import SHADOW_MAP, STEPS, Row
from experiments.console import plain_table


def accuracy_table(rows: Sequence[Row]) -> Table:
    """A line a case, at the settings that the limits are for."""
    table = plain_table(f"Scattering with {STEPS} samples and {SHADOW_MAP} texels: errors against the reference")
    for heading in ("scene", "phase function"):
        table.add_column(heading, overflow="fold")
    for heading in ("median", "95 %", "99 %", "image mean"):
        table.add_column(heading, justify="right", no_wrap=True)
    for row in rows:
        errors = (f"{row[key]:.3%}" for key in ("rel_50", "rel_95", "rel_99"))
        table.add_row(row["scene"], row["phase"], *errors, f"{row['image_mean_rel']:+.4%}")
    return table
