"""PLY and OBJ files as triangles, vertex for vertex as Mitsuba's own plugins read them.

Written here, on numpy, because the order of the vertices must be Mitsuba's: normals computed once are handed to both
renderers by index, and general mesh readers merge, split or reorder vertices. A reader also has to survive any
bytes: sizes that a header declares are checked against the file's before anything of that size is made.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from scenes.errors import InputError
from scenes.meshes.triangles import Triangles

# PLY's scalar types under both of their names, as numpy's kind and size
PLY_TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"},
}
PLY_FORMATS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
INDEX_NAMES = ("vertex_index", "vertex_indices")
# what Mitsuba reads as the end of a number or not at all, where Python goes on: the two would see different meshes
ODD_OBJ_LINE = re.compile(rb"^[ \t]*(?:v|vt|vn|f)[ \t][^\n]*?(?:[\v\f\0_]|\r(?!\n|\Z))", re.MULTILINE)
# as long as Mitsuba takes them, comments too
LONG_OBJ_LINE = re.compile(rb"[^\n]{1024}")
REEXPORT = "export it again from its modelling program"


class Element(NamedTuple):
    """One `element` of a PLY header: its name, its declared number of rows and the layout of a row."""

    name: str
    rows: int
    fields: list[tuple[str, str] | tuple[str, str, int]]


def read_mesh(path: Path | str) -> Triangles:
    """Triangles of a PLY file (ascii, little or big endian) or of an OBJ file, whole and checked.

    Vertices and faces have the number and order that Mitsuba's `ply` and `obj` plugins give them; an OBJ vertex is
    one distinct `v/vt/vn` triple, and its v coordinate is flipped as the plugin does by default. Faces without area
    are kept: they are harmless in an otherwise good mesh.

    Raises
    ------
    InputError   the file cannot be read, is neither format, is cut short, has polygons in a PLY, has no vertices,
                 no faces or no face of non-zero area, or has NaN, infinite or out-of-range values
    """
    path = Path(path)
    readers = {".ply": _read_ply, ".obj": _read_obj}
    if path.suffix.lower() not in readers:
        raise InputError(f"{path}: not a .ply or .obj file; convert the mesh to one of these.")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path and its permissions.") from None
    mesh = readers[path.suffix.lower()](path, data)
    _check(path, mesh)
    return mesh


def _refuse(path: Path, fault: str, cure: str = REEXPORT) -> NoReturn:
    raise InputError(f"{path}: {fault}; {cure}.")


def _check(path: Path, mesh: Triangles) -> None:
    if len(mesh.vertices) == 0:
        _refuse(path, "the mesh has no vertices")
    if len(mesh.faces) == 0:
        _refuse(path, "the mesh has no faces", "a point cloud must be meshed first")
    for name, values in (("vertex", mesh.vertices), ("normal", mesh.normals), ("texture coordinate", mesh.uv)):
        if values is not None and not np.isfinite(values).all():
            row = int(np.flatnonzero(~np.isfinite(values).all(axis=1))[0])
            _refuse(path, f"{name} {row} is NaN, infinite or beyond float32", "repair the mesh or " + REEXPORT)
    if int(mesh.faces.max()) >= len(mesh.vertices):
        row = int(np.flatnonzero((mesh.faces >= len(mesh.vertices)).any(axis=1))[0])
        _refuse(path, f"face {row} names a vertex that does not exist", "repair the mesh or " + REEXPORT)
    a, b, c = (mesh.vertices[mesh.faces[:, corner]].astype(np.float64) for corner in range(3))
    if not np.cross(b - a, c - a).any():
        _refuse(path, "every face has zero area", "check the scale it was exported with")


def _indices(values: NDArray) -> NDArray[np.uint32]:
    """Indices as uint32, the out-of-range ones (negative, or beyond 32 bits) turned into the largest uint32."""
    limit = np.iinfo(np.uint32).max
    return np.where((values < 0) | (values > limit), limit, values).astype(np.uint32)


# --- PLY -------------------------------------------------------------------------------------------------------------


def _read_ply(path: Path, data: bytes) -> Triangles:
    encoding, elements, start = _ply_header(path, data)
    if encoding == "ascii":
        tables = _ply_text(path, data[start:], elements)
    else:
        tables = _ply_binary(path, data, start, elements, PLY_FORMATS[encoding])
    vertex, face = tables["vertex"], tables["face"]
    names = vertex.dtype.names or ()

    def columns(*options: str) -> NDArray[np.float32] | None:
        for option in options:
            if all(name in names for name in option.split()):
                with np.errstate(over="ignore"):  # a double beyond float32 becomes infinite and is refused by _check
                    return np.stack([vertex[name] for name in option.split()], axis=1).astype(np.float32)
        return None

    vertices = columns("x y z")
    if vertices is None:
        _refuse(path, "the vertices have no x, y and z")
    if (face["count"] != 3).any():
        row = int(np.flatnonzero(face["count"] != 3)[0])
        _refuse(path, f"face {row} is not a triangle, and Mitsuba reads only triangles from a PLY", "triangulate it")
    faces = _indices(face["index"])
    return Triangles(vertices, faces, columns("nx ny nz"), columns("u v", "s t"))


def _ply_header(path: Path, data: bytes) -> tuple[str, list[Element], int]:
    """Encoding, elements and the offset of the first byte after the header."""
    if not data.startswith((b"ply\n", b"ply\r\n")):
        _refuse(path, "empty file" if not data else "not a PLY file (its first line is not 'ply')")
    end = data.find(b"\nend_header")
    start = data.find(b"\n", end + 1) + 1
    if end < 0 or start == 0:
        _refuse(path, "its PLY header has no end", "the file is cut short; copy it again")
    encoding = ""
    elements: list[Element] = []
    for line in data[:end].decode("latin-1").splitlines()[1:]:
        match line.split():
            case [] | ["comment", *_]:
                pass
            case ["obj_info", *_]:
                _refuse(path, "its PLY header has an 'obj_info' line, which Mitsuba does not read", "make it a comment")
            case ["format", name, "1.0"] if name in PLY_FORMATS and not encoding and not elements:
                encoding = name
            case ["element", name, rows] if rows.isascii() and rows.isdigit() and len(rows) < 19:
                elements.append(Element(name, int(rows), []))
            case ["property", "list", count, index, name] if (
                elements
                and elements[-1].name == "face"
                and name in INDEX_NAMES
                and PLY_TYPES.get(count, "f")[0] in "iu"
                and PLY_TYPES.get(index, "f")[0] in "iu"
            ):
                elements[-1].fields.extend([("count", PLY_TYPES[count]), ("index", PLY_TYPES[index], 3)])
            case ["property", kind, name] if elements and kind in PLY_TYPES:
                elements[-1].fields.append((name, PLY_TYPES[kind]))
            case _:
                _refuse(path, f"its PLY header has the line {line[:60]!r}, which this reader does not know")
    if not encoding:
        _refuse(path, "its PLY header names no format")
    for name, needed in (("vertex", "x"), ("face", "index")):
        matching = [element for element in elements if element.name == name]
        if len(matching) != 1 or needed not in [field[0] for field in matching[0].fields]:
            _refuse(path, f"its PLY header does not declare one element '{name}' with its {needed}")
    for element in elements:
        if not element.fields:
            _refuse(path, f"its PLY header gives '{element.name}' no properties")
        if len({field[0] for field in element.fields}) < len(element.fields):
            _refuse(path, f"its PLY header names a property of '{element.name}' twice")
    return encoding, elements, start


def _ply_binary(path: Path, data: bytes, start: int, elements: list[Element], order: str) -> dict[str, NDArray]:
    tables = {}
    for element in elements:
        row = np.dtype([(field[0], order + field[1], *field[2:]) for field in element.fields])
        if start + element.rows * row.itemsize > len(data):
            _refuse(path, f"cut short: its header declares {element.rows} rows of '{element.name}'", "copy it again")
        tables[element.name] = np.frombuffer(data, row, element.rows, start)
        start += element.rows * row.itemsize
    _check_end(path, len(data) - start, tables)
    return tables


def _check_end(path: Path, left: int, tables: dict[str, NDArray]) -> None:
    # polygons leave something over too, and are named as such later
    if left > 0 and (tables["face"]["count"] == 3).all():
        _refuse(path, "it goes on after the last row that its header declares")


def _ply_text(path: Path, text: bytes, elements: list[Element]) -> dict[str, NDArray]:
    tokens = text.split()
    tables = {}
    start = 0
    for element in elements:
        width = sum(field[2] if len(field) == 3 else 1 for field in element.fields)
        stop = start + element.rows * width
        if stop > len(tokens):
            _refuse(path, f"cut short: its header declares {element.rows} rows of '{element.name}'", "copy it again")
        try:
            if b"_" in b"".join(tokens[start:stop]):
                raise ValueError("which Python takes between digits")
            values = np.fromiter(map(float, tokens[start:stop]), np.float64, stop - start).reshape(element.rows, width)
            for column in _whole_columns(element):
                np.fromiter(map(int, tokens[start + column : stop : width]), np.float64, element.rows)
        except (ValueError, OverflowError):
            _refuse(
                path,
                f"a value of its element '{element.name}' is not a number, or not a whole number where it should be",
            )
        # float64 holds every 32-bit index exactly
        row = np.dtype([(field[0], "f8", *field[2:]) for field in element.fields])
        tables[element.name] = values.view(row).reshape(element.rows)
        start = stop
    _check_end(path, len(tokens) - start, tables)
    return tables


def _whole_columns(element: Element) -> list[int]:
    """Columns of a text row that are declared as whole numbers."""
    kinds = [kind for field in element.fields for kind in [field[1]] * (field[2] if len(field) == 3 else 1)]
    return [column for column, kind in enumerate(kinds) if kind[0] in "iu"]


# --- OBJ -------------------------------------------------------------------------------------------------------------


def _read_obj(path: Path, data: bytes) -> Triangles:
    for pattern, fault in (
        (ODD_OBJ_LINE, "holds a lone carriage return, a form feed, a zero byte or an underscore"),
        (LONG_OBJ_LINE, "is longer than 1023 characters, which Mitsuba does not read"),
    ):
        if found := pattern.search(data):
            number_of_line = data.count(b"\n", 0, found.end()) + 1
            _refuse(path, f"line {number_of_line} {fault}")
    kept: dict[bytes, list[list[bytes]]] = {b"v": [], b"vt": [], b"vn": [], b"f": []}
    for line in data.split(b"\n"):
        keyword, *values = line.partition(b"#")[0].split() or [b""]
        if keyword in kept:
            kept[keyword].append(values)
    if not kept[b"f"]:
        _refuse(path, "the mesh has no faces", "check that it is an OBJ file of polygons")
    number: dict[bytes, int] = {}  # each distinct v/vt/vn is one vertex, numbered as it first appears
    corners = np.array([number.setdefault(corner, len(number)) for face in kept[b"f"] for corner in face], np.uint32)
    faces = _fans(path, corners, np.array([len(face) for face in kept[b"f"]]))
    keys = [corner.split(b"/") for corner in number]
    positions = _obj_column(path, keys, 0, _obj_table(path, kept[b"v"], "v", 3))
    texture = _obj_column(path, keys, 1, _obj_table(path, kept[b"vt"], "vt", 2))
    normals = _obj_column(path, keys, 2, _obj_table(path, kept[b"vn"], "vn", 3))
    if positions is None:
        _refuse(path, "its faces name no positions")
    uv = None if texture is None else np.stack([texture[:, 0], np.float32(1) - texture[:, 1]], axis=1)
    return Triangles(positions, faces, normals, uv)


def _fans(path: Path, corners: NDArray[np.uint32], sizes: NDArray[np.integer]) -> NDArray[np.uint32]:
    """Triangles of polygons with `sizes` corners each: all from the first corner, as Mitsuba cuts them."""
    if sizes.min() < 3:
        _refuse(path, f"face {int(sizes.argmin())} has fewer than three corners")
    cuts = sizes - 2
    first = np.repeat(np.cumsum(sizes) - sizes, cuts)
    step = np.arange(len(first)) - np.repeat(np.cumsum(cuts) - cuts, cuts)
    return np.stack([corners[first], corners[first + step + 1], corners[first + step + 2]], axis=1)


def _obj_table(path: Path, rows: list[list[bytes]], keyword: str, width: int) -> NDArray[np.float32]:
    try:
        with np.errstate(over="ignore"):
            values = np.array([[float(token) for token in row[:width]] for row in rows], np.float64)
            return values.astype(np.float32).reshape(len(rows), width)
    except ValueError:
        _refuse(path, f"a '{keyword}' line does not hold {width} numbers")


def _obj_column(
    path: Path, keys: list[list[bytes]], place: int, table: NDArray[np.float32]
) -> NDArray[np.float32] | None:
    """Rows of `table` that the corners name in their `place` (0 v, 1 vt, 2 vn); None where no corner names one."""
    named = [key[place] if place < len(key) else b"" for key in keys]
    if not any(named):
        return None
    try:
        index = np.array([int(token) for token in named], np.int64) - 1
    except (ValueError, OverflowError):
        _refuse(path, "a face has a corner that is not a whole number, or only some corners have a normal or texture")
    if index.min() < 0 or index.max() >= len(table):
        _refuse(path, "a face names a row that does not exist (Mitsuba does not read negative indices)")
    return table[index]
