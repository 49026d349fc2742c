"""Ways to spoil a scene file as bytes, whatever they mean."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

from pools import ENCODINGS


def _truncate(text: str, rng: Random) -> bytes:
    return text.encode()[: rng.randrange(len(text))]


def _flip(text: str, rng: Random) -> bytes:
    data = bytearray(text.encode())
    for _ in range(rng.choice((1, 1, 3, 30))):
        data[rng.randrange(len(data))] = rng.randrange(256)
    return bytes(data)


def _insert(text: str, rng: Random) -> bytes:
    data = text.encode()
    place = rng.randrange(len(data))
    extra = rng.choice(
        (b"\0", b"\xff\xfe", b"<", b">", b'"', b"&", b"<!--", b"]]>", b"<![CDATA[", b"<?x", b"\r", rng.randbytes(9))
    )
    return data[:place] + extra * rng.choice((1, 1, 2, 500)) + data[place:]


def _cut(text: str, rng: Random) -> bytes:
    data = text.encode()
    start = rng.randrange(len(data))
    return data[:start] + data[start + rng.choice((1, 2, 10, 100)) :]


def _repeat(text: str, rng: Random) -> bytes:
    data = text.encode()
    start = rng.randrange(len(data))
    return data[:start] + data[start : start + rng.choice((1, 5, 50, 500))] * rng.choice((2, 2, 20)) + data[start:]


def _encode(text: str, rng: Random) -> bytes:
    return text.replace("fog", rng.choice(("fog", "nébel"))).encode(rng.choice(ENCODINGS), "replace")


BYTE_CHANGES: tuple[Callable[[str, Random], bytes], ...] = (_truncate, _flip, _flip, _insert, _cut, _repeat, _encode)
