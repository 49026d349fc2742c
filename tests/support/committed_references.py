"""Committed references that tests spoil."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

Rewrite = Callable[[dict[str, np.ndarray], dict], None]


def rewritten(path: Path, change: Rewrite) -> None:
    with np.load(path) as entry:
        arrays = dict(entry)
    record = json.loads(str(arrays.pop("record")))
    change(arrays, record)
    np.savez_compressed(path, record=np.array(json.dumps(record)), **arrays)
