"""The note beside a fetched mesh: whose it is, on what terms, and how it was made out of which original."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from scenes.meshes.files import sha256

# what others read from a note
KEYS = {"credit", "licence", "original_sha256", "steps", "sha256"}


def note_path(mesh: Path) -> Path:
    """Where the note of a mesh file is: NAME.json beside NAME, which keeps its own ending."""
    return mesh.with_name(f"{mesh.name}.json")


def read_note(mesh: Path) -> dict[str, Any] | None:
    """The note of a mesh file; None where it has none, a damaged one or one about other bytes.

    Raises
    ------
    InputError   the mesh itself cannot be read
    """
    try:
        note = json.loads(note_path(mesh).read_text("utf-8"))
    except (OSError, ValueError):
        return None
    # someone may have edited it, or put another mesh in its mesh's place
    whole = isinstance(note, dict) and note.keys() >= KEYS
    return note if whole and note["sha256"] == sha256(mesh) else None
