"""What the study's tables and figures call a technique: settings that all of their rows share are said once."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from experiments.studies.cells import Row, label
from gpu_impl.techniques import SETTINGS

# of the settings that decide errors, how they are said
WORDS = {"steps": "{} samples a ray", "shadow_map": "shadow maps of {} texels on a side"}


def naming(rows: Sequence[Row], *axes: str) -> Callable[[Row], str]:
    """A row's technique with its settings, but for those that all rows share and those that have an axis."""
    shared = _shared(rows)
    return lambda row: label(row, *axes, *shared)


def shared_settings(rows: Sequence[Row]) -> str:
    """What all rows share, in words; empty where it is nothing."""
    shared = _shared(rows)
    return ", ".join(words.format(shared[name]) for name, words in WORDS.items() if name in shared)


def _shared(rows: Sequence[Row]) -> dict[str, object]:
    return {name: rows[0][name] for name in SETTINGS if len({row[name] for row in rows}) == 1}
