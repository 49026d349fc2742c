"""A ball with a hole in it and a box, as their makers would publish them; and what a test asks of a fetch."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh

from scenes.meshes.catalogue import KnownMesh, Original
from scenes.meshes.fetch import Fetched, Watcher, fetch
from scenes.meshes.steps import Step
from scenes.meshes.triangles import Triangles, ply_bytes

BALL = trimesh.creation.icosphere(subdivisions=3)
# a ball with a hole in it
BALL_PLY = ply_bytes(Triangles(np.asarray(BALL.vertices, np.float32), np.asarray(BALL.faces[:-7], np.uint32)))
BOX_OBJ = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
GOOD = {"recon/ball.ply": BALL_PLY, "recon/README": b"words", "recon/other.ply": b"ply"}


def known(original: Original | None, steps: tuple[Step, ...]) -> KnownMesh:
    return KnownMesh("a ball", "Somebody", "for research", "a page", "http://page", "0" * 64, original, steps)


def fetched(*names: str) -> list[Fetched]:
    return list(fetch(names, Watcher()))


def files_below(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir())
