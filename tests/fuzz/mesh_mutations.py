"""Ways to spoil a mesh file. All chance comes from the caller."""

from __future__ import annotations

import re
from collections.abc import Callable
from random import Random

NUMBERS = (
    b"nan",
    b"inf",
    b"-inf",
    b"1e38",
    b"1e39",
    b"1e400",
    b"-1",
    b"0",
    b"99",
    b"2147483647",
    b"-2147483648",
    b"x",
    b"",
)
COUNTS = (b"0", b"1", b"7", b"9", b"100000000", b"4294967296", b"9223372036854775808", b"-1", b"1e3", b"x", b"")
TYPES = (b"char", b"uchar", b"short", b"ushort", b"int", b"uint", b"float", b"double", b"int64", b"list", b"")


def spoil(name: str, data: bytes, rng: Random) -> bytes:
    """Change a mesh file of this name in one to three places."""
    changes = ANY + (OBJ if name.endswith(".obj") else PLY)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        data = rng.choice(changes)(data, rng)
    return data


def _body(data: bytes) -> int:
    """Where a PLY's header ends."""
    return data.find(b"end_header\n") + 11 if b"end_header\n" in data else len(data)


def _replace_one(pattern: bytes, choices: tuple[bytes, ...]) -> Callable[[bytes, Random], bytes]:
    """Put one of the choices where one of the pattern's groups was found."""

    def change(data: bytes, rng: Random) -> bytes:
        found = list(re.finditer(pattern, data, re.MULTILINE))
        if not found:
            return data
        start, end = rng.choice(found).span(1)
        return data[:start] + rng.choice(choices) + data[end:]

    return change


def _truncate(data: bytes, rng: Random) -> bytes:
    return data[: rng.choice((rng.randrange(len(data) + 1), _body(data), max(0, len(data) - 1)))]


def _flip(data: bytes, rng: Random) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 4, 40)) if data else 0):
        changed[rng.randrange(len(changed))] = rng.randrange(256)
    return bytes(changed)


def _flip_in_body(data: bytes, rng: Random) -> bytes:
    """Numbers that are still in their places: NaN, huge coordinates and huge or negative indices."""
    changed, start = bytearray(data), _body(data)
    for _ in range(rng.choice((1, 3))):
        if len(changed) - start > 4:
            place = rng.randrange(start, len(changed) - 4)
            changed[place : place + 4] = rng.choice(
                (b"\xff\xff\xff\xff", b"\0\0\xc0\x7f", b"\x7f\xc0\0\0", b"\0\0\0\0")
            )
    return bytes(changed)


def _random(data: bytes, rng: Random) -> bytes:
    return rng.choice((b"", data[:4], data[: _body(data)])) + rng.randbytes(rng.choice((0, 1, 100, 5000)))


def _append(data: bytes, rng: Random) -> bytes:
    return data + rng.choice((b"\n", b"0\n", b"\0", rng.randbytes(50), data))


def _windows_lines(data: bytes, rng: Random) -> bytes:
    return (
        data.replace(b"\n", b"\r\n")
        if rng.random() < 0.5
        else data[: _body(data)].replace(b"\n", b"\r\n") + data[_body(data) :]
    )


def _drop_line(data: bytes, rng: Random) -> bytes:
    lines = data.splitlines(keepends=True)
    place = rng.randrange(len(lines) + 1)
    return b"".join(lines[:place] + lines[place + 1 :])


def _double_line(data: bytes, rng: Random) -> bytes:
    lines = data.splitlines(keepends=True)
    place = rng.randrange(len(lines) + 1)
    return b"".join(lines[: place + 1] + lines[place:])


def _no_area(data: bytes, rng: Random) -> bytes:
    """Every coordinate the same, in text and in binary."""
    if b"binary" in data:
        return data[: _body(data)] + re.sub(rb"[\x80\xbf]", b"\0", data[_body(data) :])
    return re.sub(rb"(?m)^(v )?-?[\d.]+ -?[\d.]+ -?[\d.]+(?=[ \n])", rb"\g<1>1 1 1", data)


def _polygon(data: bytes, rng: Random) -> bytes:
    corners = rng.choice((0, 1, 2, 4, 200, 100_000))
    if b"binary" in data:
        return data[: _body(data)] + data[_body(data) :].replace(
            b"\x03", bytes([min(corners, 255)]), rng.choice((1, 99))
        )
    text = b" ".join(b"%d" % (1 + corner % 4) for corner in range(corners))
    if data.startswith(b"ply"):
        return re.sub(rb"(?m)^3( \d+){3}$", b"%d %s" % (corners, text), data, count=rng.choice((1, 99)))
    return re.sub(rb"(?m)^f .*$", b"f " + text, data, count=rng.choice((1, 99)))


ANY: tuple[Callable[[bytes, Random], bytes], ...] = (
    *(
        _truncate,
        _truncate,
        _flip,
        _flip,
        _random,
        _append,
        _windows_lines,
        _drop_line,
        _double_line,
        _no_area,
        _polygon,
    ),
)
PLY: tuple[Callable[[bytes, Random], bytes], ...] = (
    _flip_in_body,
    _flip_in_body,
    _replace_one(rb"^element (?:vertex|face) (\d+)$", COUNTS),
    _replace_one(rb"^element (?:vertex|face) (\d+)$", COUNTS),
    _replace_one(rb"^property (float)", TYPES),
    _replace_one(rb"^property list (uchar|int)", TYPES),
    _replace_one(rb"^property list \w+ (int)", TYPES),
    _replace_one(rb"^property float (\w+)$", (b"x", b"y", b"z", b"nx", b"u", b"s", b"", b"vertex_indices")),
    _replace_one(rb"^(property list \w+ \w+ \w+)$", (b"", b"property list uchar int vertex_index", b"property int x")),
    _replace_one(rb"(end_header\n)", (b"", b"end_header", b"end_header\r\n", b"end_head\n", b"END_HEADER\n")),
    _replace_one(rb"^format (\w+)", (b"ascii", b"binary_little_endian", b"binary_big_endian", b"binary", b"")),
    _replace_one(rb"^format \w+ (1.0)", (b"2.0", b"1", b"")),
    _replace_one(rb"[ \n](-?\d+(?:\.\d+)?)(?= )", NUMBERS),
    _replace_one(rb"^3 \d+ (\d+) ", NUMBERS),
    _replace_one(rb"^comment (.*)$", (b"\xff\xfe", b"end_header", b"element face 5", b"a" * 100_000)),
)
OBJ: tuple[Callable[[bytes, Random], bytes], ...] = (
    _replace_one(rb"^v[nt]? (-?\d+)", NUMBERS),
    _replace_one(rb"^v[nt]? .*( -?\d+)$", (b"", b" 1 1", b" nan", b" 1e39", b" 0x1", b" 1,5")),
    _replace_one(
        rb"^f (\d+)", (b"0", b"-1", b"-9", b"9", b"1.5", b"99999999999999999999", b"x", b"", b"1e0", b"+1", b"1_0")
    ),
    _replace_one(rb"^f (\S+)", (b"1", b"1/", b"1//", b"1/1", b"//1", b"/", b"1/1/1/1", b"1/9/1", b"1/1/9", b"1/-1/-1")),
    _replace_one(rb"^f \S+( )", (b"  ", b"\t", b" \\\n", b"\n", b"\\\n", b"#", b"\x0b")),
    _replace_one(rb"^(f .*)$", (b"f", b"f 1 1 1", b"l 1 2", b"p 1", b"fo 1 2 3", b"F 1 2 3", b"f 1 2 3 # side")),
    _replace_one(rb"^(vn?t? .*)$", (b"", b"v", b"vn", b"vp 1 2 3", b"v 1 2 3 1 0 0", b"v 1e400 0 0")),
    _replace_one(
        rb"^()[ov]",
        (b"mtllib a.mtl\n", b"g a b c\n", b"s 1\n", b"curv 0 1 1 2\n", b"#" * 100_000 + b"\n", b"\0\n", b"\xff\n"),
    ),
)
