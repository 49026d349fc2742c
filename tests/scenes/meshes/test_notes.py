"""Notes beside meshes: read back as written, and none where one is damaged."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import pytest

from scenes.meshes.notes import Note, note_path, read_note

MESH = b"ply\n"
GOOD: dict[str, Any] = {
    **{key: f"the {key}" for key in ("name", "what", "credit", "licence", "origin", "page", "address", "member")},
    "original_sha256": "0" * 64,
    "steps": [{"step": "repair", "parameters": {"n": 1}, "made_by": {"numpy": "2"}, "vertices": 3, "polygons": 1}],
    "triangles": 1,
    "sha256": hashlib.sha256(MESH).hexdigest(),
    "airlight": "1.0",
    "date": "2026-11-22T00:00:00+00:00",
}
DAMAGED = {
    "no steps": {key: value for key, value in GOOD.items() if key != "steps"},
    "a step that is a number": GOOD | {"steps": [1]},
    "a number of steps": GOOD | {"steps": 3},
    "null steps": GOOD | {"steps": None},
    "an empty step": GOOD | {"steps": [{}]},
    "a parameter that is a text": GOOD | {"steps": [GOOD["steps"][0] | {"parameters": {"target": "many"}}]},
    "a credit that is a list": GOOD | {"credit": ["Somebody"]},
    "no text of a hash": GOOD | {"sha256": None},
    "the hash of other bytes": GOOD | {"sha256": "0" * 64},
    "a list": [GOOD],
    "null": None,
}
TEXTS = {name: json.dumps(note).encode() for name, note in DAMAGED.items()} | {
    "nothing": b"",
    "half of it": json.dumps(GOOD).encode()[:-30],
    "brackets without end": b"[" * 200_000,
    "brackets in a good note": json.dumps(GOOD).replace("[{", "[" * 200_000 + "{").encode(),
    "no UTF-8": json.dumps(GOOD).encode().replace(b"the credit", b"\xff\xfe"),
    "a huge number": json.dumps(GOOD).encode().replace(b'"triangles": 1', b'"triangles": 1e999'),
}


def test_a_note_is_read_as_it_was_written(tmp_path: Path) -> None:
    mesh = tmp_path / "ball.ply"
    mesh.write_bytes(MESH)
    assert read_note(mesh) is None
    note_path(mesh).write_text(Note(**GOOD).model_dump_json())
    note = read_note(mesh)
    assert note
    assert note.model_dump() == GOOD


@pytest.mark.parametrize("damage", TEXTS)
def test_a_damaged_note_is_none(damage: str, tmp_path: Path) -> None:
    mesh = tmp_path / "ball.ply"
    mesh.write_bytes(MESH)
    note_path(mesh).write_bytes(TEXTS[damage])
    assert read_note(mesh) is None
