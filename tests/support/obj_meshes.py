"""Meshes of a few triangles as files, and a sun over a box of fog to see them in."""

from __future__ import annotations

from pathlib import Path

# one upright edge with three sheets
SHEETS = ([(0, 0, 0), (0, 1, 0), (1, 0, 0.2), (-0.9, 0.1, 0.3), (0.1, 0.2, -1)], [(0, 1, 2), (0, 1, 3), (0, 1, 4)])
SUN = "<emitter type='directional'><vector name='direction' value='0.3, -1, 0.2'/></emitter>"
BOX = (
    "<shape type='cube'><transform name='to_world'><scale value='6'/></transform><bsdf type='null'/>"
    "<ref name='interior' id='fog'/></shape>"
)


def obj(folder: Path, name: str, vertices, faces, bsdf: str = "") -> str:
    """A mesh as a file, and the shape that names it."""
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (folder / f"{name}.obj").write_text("\n".join(lines), encoding="utf-8")
    return f"<shape type='obj' id='{name}'><string name='filename' value='{name}.obj'/>{bsdf}</shape>"
