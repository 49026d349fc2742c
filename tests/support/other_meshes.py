"""Files that the scenes of tests/others name, in the formats in which other programs write them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

ROWS, COLUMNS = 24, 36


def write_models(folder: Path) -> None:
    """Write every model and picture into `folder`."""
    folder.mkdir(exist_ok=True)
    vertices, uv, quads = blob()
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [2, 3, 0]]])
    (folder / "blob_ascii.ply").write_text(ply_text(vertices, triangles))
    (folder / "blob_big_endian.ply").write_bytes(ply_big_endian(vertices, uv, triangles))
    (folder / "blob_groups.obj").write_text(obj(vertices, uv, quads))
    (folder / "prism.obj").write_text(prism())
    from scenes.mitsuba_setup import mitsuba

    mi = mitsuba()
    rng = np.random.default_rng(11)
    # no two alike, and so few that a texel covers many pixels wherever it is seen: half a texel matters
    mi.Bitmap(rng.uniform(20, 240, (5, 8, 3)).astype(np.uint8)).write(str(folder / "slide.png"))


def blob() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A bumpy ball with its seam doubled: vertices (V, 3), uv (V, 2), quads (F, 4)."""
    theta, phi = np.meshgrid(
        np.linspace(0.02, np.pi - 0.02, ROWS + 1), np.linspace(0, 2 * np.pi, COLUMNS + 1), indexing="ij"
    )
    radius = 0.85 + 0.12 * np.cos(3 * phi) * np.sin(theta) ** 3 + 0.05 * np.cos(5 * theta)
    vertices = radius[..., None] * np.stack(
        [np.sin(theta) * np.cos(phi), np.cos(theta), -np.sin(theta) * np.sin(phi)], axis=-1
    )
    uv = np.stack([phi / (2 * np.pi), theta / np.pi], axis=-1)
    i, j = (index.ravel() for index in np.indices((ROWS, COLUMNS)))
    corner = i * (COLUMNS + 1) + j
    quads = np.stack([corner, corner + COLUMNS + 1, corner + COLUMNS + 2, corner + 1], axis=1)
    return vertices.reshape(-1, 3), uv.reshape(-1, 2), quads


def ply_text(vertices: np.ndarray, triangles: np.ndarray) -> str:
    """An ascii PLY with comments, an element more than needed, and Windows line ends in its body's spacing."""
    lines = ["ply", "format ascii 1.0", "comment made by hand", f"element vertex {len(vertices)}"]
    lines += [f"property float {axis}" for axis in "xyz"] + ["property uchar quality"]
    lines += [f"element face {len(triangles)}", "property list uchar int vertex_index", "end_header"]
    lines += [f"{x:.7g}  {y:.7g} {z:.7g} 7 " for x, y, z in vertices]
    lines += [f"3 {a} {b} {c}" for a, b, c in triangles]
    return "\n".join(lines) + "\n"


def ply_big_endian(vertices: np.ndarray, uv: np.ndarray, triangles: np.ndarray) -> bytes:
    """A big-endian PLY of doubles with texture coordinates called s and t."""
    header = ["ply", "format binary_big_endian 1.0", "comment test", f"element vertex {len(vertices)}"]
    header += [f"property double {name}" for name in ("x", "y", "z", "s", "t")]
    header += [f"element face {len(triangles)}", "property list uchar uint vertex_indices", "end_header"]
    rows = np.empty(len(triangles), np.dtype([("count", "u1"), ("index", ">u4", 3)]))
    rows["count"], rows["index"] = 3, triangles
    body = np.hstack([vertices, uv]).astype(">f8").tobytes() + rows.tobytes()
    return ("\n".join(header) + "\n").encode() + body


def obj(vertices: np.ndarray, uv: np.ndarray, quads: np.ndarray) -> str:
    """An OBJ of quads in two groups, with materials that nobody has, smoothing groups and texture coordinates."""
    lines = ["# blob", "mtllib blob.mtl", "o Blob"]
    lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in vertices]
    lines += [f"vt {u:.6f} {v:.6f}" for u, v in uv]
    half = len(quads) // 2
    for name, part in (("upper", quads[:half]), ("lower half", quads[half:])):
        lines += [f"g {name}", "usemtl none", "s 1"]
        lines += ["f " + " ".join(f"{corner}/{corner}" for corner in quad + 1) for quad in part]
    return "\n".join(lines) + "\n"


def prism() -> str:
    """A closed prism on seven corners, its ends polygons, all faces outward."""
    angle = 2 * np.pi * np.arange(7) / 7
    ring = [(2.2 * np.cos(a), 2.2 * np.sin(a)) for a in angle]
    lines = [f"v {x:.6f} {y} {-z:.6f}" for y in (-1.2, 1.3) for x, z in ring]
    low, high = list(range(1, 8)), list(range(8, 15))
    lines.append("f " + " ".join(map(str, reversed(low))))
    lines.append("f " + " ".join(map(str, high)))
    lines += [f"f {low[i]} {low[(i + 1) % 7]} {high[(i + 1) % 7]} {high[i]}" for i in range(7)]
    return "\n".join(lines) + "\n"
