"""Meshes in which Mitsuba and our readers once saw different things: now the same, or ours says why not."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from scenes.errors import InputError
from scenes.meshes.readers import read_mesh
from scenes.mitsuba_setup import mitsuba

OBJ = "v 0 1 0\nv -1 0 1\nv 1 0 1\nv 5 5 5\nf 1 2 3\n"
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "property {}\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 1 0 {}\n-1 0 1 2\n1 0 1 2\n{}\n"
)
LITTLE = PLY.format("int n", 2, "")[: PLY.format("int n", 2, "").index("0 1 0")].replace(
    "ascii", "binary_little_endian"
)
ROWS = struct.pack("<3fi3fi3fi", 0, 1, 0, 2, -1, 0, 1, 2, 1, 0, 1, 2) + struct.pack("<B3i", 3, 0, 1, 2)

FOUND: dict[str, tuple[str, bytes]] = {
    "a lone carriage return between lines": ("obj", OBJ.replace("0 1 0\n", "0 1 0\r").encode()),
    "a lone carriage return in a face": ("obj", OBJ.replace("2 3", "2\r3").encode()),
    "a form feed in a face": ("obj", OBJ.replace("f 1 2 3", "f 1\f2 3 4").encode()),
    "a zero byte": ("obj", OBJ.replace("0 1 0\n", "0 1 0\0\n").encode()),
    "an underscore in a coordinate": ("obj", OBJ.replace("5 5 5", "1_0 5 5").encode()),
    "an underscore in an index": ("obj", OBJ.replace("f 1", "f 0_1").encode()),
    "a comment behind a face": ("obj", OBJ.replace("2 3\n", "2 3 # 4\n").encode()),
    "a comment as long as may be": ("obj", f"#{'.' * 1022}\n{OBJ}".encode()),
    "a comment that is too long": ("obj", f"#{'.' * 1023}\n{OBJ}".encode()),
    "a line of Windows that ends the file": ("obj", OBJ.replace("\n", "\r\n").encode()[:-1]),
    "an underscore in text": ("ply", PLY.format("float n", "1_0", "3 0 1 2").encode()),
    "a fraction as an index": ("ply", PLY.format("float n", "2", "3 0 1.0 2").encode()),
    "a fraction as a whole number": ("ply", PLY.format("char n", "-0.5", "3 0 1 2").encode()),
    "whole numbers where declared": ("ply", PLY.format("int n", "-2", "3 0 +1 2").encode()),
    "two formats": (
        "ply",
        PLY.format("int n", 2, "3 0 1 2").replace("element vertex", "format ascii 1.0\nelement vertex").encode(),
    ),
    "bytes behind the last face": ("ply", LITTLE.encode() + ROWS + b"\n"),
    "no bytes behind the last face": ("ply", LITTLE.encode() + ROWS),
}


@pytest.mark.parametrize("case", FOUND)
def test_a_mesh_is_the_one_that_mitsuba_reads_or_none(tmp_path: Path, case: str) -> None:
    plugin, content = FOUND[case]
    path = tmp_path / f"mesh.{plugin}"
    path.write_bytes(content)
    mi = mitsuba()
    try:
        theirs = mi.traverse(mi.load_dict({"type": plugin, "filename": str(path)}))
    except RuntimeError:
        theirs = None
    try:
        ours = read_mesh(path)
    except InputError:
        return
    assert theirs is not None, "ours reads what Mitsuba refuses"
    np.testing.assert_array_equal(ours.faces.ravel(), np.array(theirs["faces"]))
    np.testing.assert_array_equal(ours.vertices.ravel(), np.array(theirs["vertex_positions"]))


HARMLESS = (
    *("a comment behind a face", "a comment as long as may be", "a line of Windows that ends the file"),
    *("whole numbers where declared", "no bytes behind the last face"),
)


@pytest.mark.parametrize("case", HARMLESS)
def test_the_harmless_ones_are_read(tmp_path: Path, case: str) -> None:
    plugin, content = FOUND[case]
    path = tmp_path / f"mesh.{plugin}"
    path.write_bytes(content)
    assert len(read_mesh(path).faces) == 1
