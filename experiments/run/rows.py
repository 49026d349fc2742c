"""A row of results: what a case is, what came of it, and everything that made it."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any

from experiments.suite.cases import Case
from gpu_impl.techniques import SETTINGS

Row = dict[str, Any]


def identity(case: Case) -> Row:
    """The columns that say which case it is; they are there whatever came of it."""
    technique = case.technique
    return {
        "case": case.name,
        "product": case.product,
        "scene": Path(case.scene).stem,
        "phase": case.phase,
        "width": case.size[0],
        "height": case.size[1],
        "camera": str(case.camera),
        "frames": case.camera.frames,
        "triangles": case.triangles,
        "parameters": json.dumps(dict(case.parameters)),
        "technique": technique.name,
        "visibility": technique.visibility,
        "airlight_model": technique.airlight,
        **{setting: getattr(technique, setting) for setting in SETTINGS},
    }


def alone(suite: str, changes: tuple[str, ...], case: Case) -> str:
    """The command that runs one case of a suite by itself."""
    words = ["airlight", "run", suite, *(word for change in changes for word in ("--set", change)), "--case", case.name]
    return shlex.join(words)


def finished(row: Row) -> bool:
    """Whether a resumed run need not try this case again: it is measured, or its technique refuses it."""
    return row["status"] in ("done", "refused")
