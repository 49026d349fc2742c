"""Refuses scene files on which Mitsuba's parser would not come back: it recurses on the machine stack, without a bound.

Measured with Mitsuba 3.9.1 and the usual stack of 8 MB: 6,000 nested elements are parsed and 8,000 end the process; a
chain of 30,000 references is followed and one of 60,000 ends the process; `<default>`s that double each other and
includes that branch take time and memory without end.

The scan reads what Mitsuba's parser (pugixml) reads, and no more strictly: it never judges syntax. Where it meets what
is not XML it stops, and so does the parser, with a message of its own.
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.sax.saxutils import unescape

from scenes.errors import InputError
from scenes.mitsuba_setup import mitsuba

# scenes nest about 10 elements, and references about 5
MOST_LEVELS = 100
# of a scene with all that it includes, and of the values that are put in for parameters: in all, and in one attribute
MOST_BYTES = 64 << 20
MOST_PUT_IN = 1 << 20
MOST_FILES = 10_000
# Mitsuba's own limit, which it reports
INCLUDE_DEPTH = 15

_QUOTED = rb""" "[^"]*" | '[^']*' """
_TOKEN = re.compile(
    rb"""[^<]*+<(?:
        (?P<name>[A-Za-z_:\x80-\xff][^\s/>]*+)(?P<attributes>(?: [^>"']++ | QUOTED )*+)>
        | (?P<close>/)[^>]*>
        | !--.*?--> | !\[CDATA\[.*?\]\]> | \?.*?\?>
        | !DOCTYPE (?: [^<>"']++ | QUOTED | <!--.*?--> | <\?.*?\?> | <![A-Z](?: [^>"']++ | QUOTED )*+> )*+ >
    )""".replace(b"QUOTED", _QUOTED),
    re.DOTALL | re.VERBOSE,
)
_ATTRIBUTE = re.compile(rb"""([^\s=]+)\s*=\s*(?:"([^"]*)"|'([^']*)')""")
_READ_HERE = frozenset((b"default", b"include", b"path", b"spectrum", b"ref"))


def check_xml(path: Path, parameters: Mapping[str, str]) -> None:
    """Let a scene file pass that Mitsuba's parser can be given.

    Parameters
    ----------
    path : the scene file
    parameters : values for its `$name` parameters, which may name the files that it includes

    Raises
    ------
    InputError
        Elements or references nest deeper than `MOST_LEVELS`; the file with its includes is larger than `MOST_BYTES`
        or more than `MOST_FILES`, or becomes so when values are put in for parameters; it reads from a device or pipe.
    """
    scan = _Scan(parameters)
    scan.file(Path(path), _resolver_folders(), owner=b"", level=0, depth=0)
    scan.check_references(path)


def _resolver_folders() -> list[str]:
    """Folders in which Mitsuba looks for included files whatever the scene."""
    resolver = mitsuba().file_resolver()
    return [str(resolver[number]) for number in range(len(resolver))]


class _Scan:
    """One scene with its includes, as far as the parser would follow them."""

    def __init__(self, parameters: Mapping[str, str]) -> None:
        self.values = {b"$" + _bytes(name): _bytes(value) for name, value in parameters.items()}
        self.bytes = 0
        self.files = 0
        # who holds or names whom, by id; what has no id stands with what holds it
        self.names: dict[bytes, list[bytes]] = {}

    def file(self, path: Path, folders: list[str], owner: bytes, level: int, depth: int) -> None:
        """Scan a file from `level` of the elements around its `<include>`; `owner` is the id that it lies in."""
        self.files += 1
        if self.files > MOST_FILES:
            raise InputError(
                f"{path}: the scene includes more than {MOST_FILES} files; let no file include others twice."
            )
        data = _as_utf8(self._read(path))
        # a copy, as what an included file adds is forgotten at its end
        folders = [str(path.parent), *folders]
        owners = [owner] * (level + 1)
        for token in _tokens(data):
            name, written, close = token.groups()
            if close:
                if len(owners) == level + 1:
                    return
                owners.pop()
                continue
            if name is None:
                continue
            inside = owners[-1]
            if b"$" in written or b"id" in written or name in _READ_HERE:
                attributes = {key: first or second for key, first, second in _ATTRIBUTE.findall(written)}
                if b"$" in written:
                    attributes = {key: self._put_in(value, path) for key, value in attributes.items()}
                if name in _READ_HERE:
                    self._read_element(name, attributes, path, folders, inside, len(owners), depth)
                elif b"id" in attributes:
                    self.names.setdefault(inside, []).append(attributes[b"id"])
                    inside = attributes[b"id"]
            if not written.endswith(b"/"):
                owners.append(inside)
                if len(owners) > MOST_LEVELS + 1:
                    line = data.count(b"\n", 0, token.start("name")) + 1
                    raise InputError(
                        f"{path} (line {line}): elements nest deeper than {MOST_LEVELS} levels, which breaks Mitsuba's "
                        "parser; take the inner ones out of the others."
                    )

    def _read_element(
        self,
        name: bytes,
        attributes: dict[bytes, bytes],
        path: Path,
        folders: list[str],
        owner: bytes,
        level: int,
        depth: int,
    ) -> None:
        """Do what an element asks of the parser itself."""
        if name == b"ref":
            self.names.setdefault(owner, []).append(attributes.get(b"id", b""))
        elif name == b"default":
            self.values.setdefault(b"$" + _plain(attributes.get(b"name", b"")), _plain(attributes.get(b"value", b"")))
        elif name == b"path":
            folders.insert(0, _resolve(attributes.get(b"value", b""), folders))
        elif b"filename" in attributes:
            target = _resolve(attributes[b"filename"], folders)
            try:
                mode = os.stat(target).st_mode
            except (OSError, ValueError):
                return
            if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
                raise InputError(f"{path} reads from {target}, which is a device or a pipe; name a file.")
            if name == b"include" and stat.S_ISREG(mode) and depth + 1 < INCLUDE_DEPTH:
                self.file(Path(target), folders, owner, level - 1, depth + 1)

    def _read(self, path: Path) -> bytes:
        try:
            with open(path, "rb") as file:
                # by its size, as files of the kernel that say 0 may never end
                size = os.fstat(file.fileno()).st_size
                self._count(size, path)
                return file.read(size)
        except OSError:
            return b""

    def _count(self, size: int, path: Path) -> None:
        self.bytes += size
        if self.bytes > MOST_BYTES:
            raise InputError(
                f"{path}: the scene's XML grows beyond {MOST_BYTES >> 20} MB with its includes and parameters; put "
                "large data into meshes."
            )

    def _put_in(self, text: bytes, path: Path) -> bytes:
        """Put the values of parameters into an attribute as Mitsuba does: the longest names first, an escaped $ not."""
        for key in sorted(self.values, key=len, reverse=True):
            if key not in text:
                continue
            parts = re.split(rb"(?<!\\)" + re.escape(key), text)
            # judged before it is made; Mitsuba moves the whole text for each
            added = (len(parts) - 1) * (len(text) + len(self.values[key]))
            if added > MOST_PUT_IN:
                raise InputError(
                    f"{path}: values of parameters make a text of more than {MOST_PUT_IN >> 20} MB; shorten them."
                )
            self._count(added, path)
            text = self.values[key].join(parts)
        return text.replace(b"\\$", b"$")

    def check_references(self, path: Path) -> None:
        """Refuse chains of references longer than `MOST_LEVELS`; circles are Mitsuba's to report."""
        length: dict[bytes, int] = {}
        for start in list(self.names):
            trail = [(start, iter(self.names[start]))] if start not in length else []
            open_ids = {start}
            while trail:
                if len(trail) > MOST_LEVELS:
                    break
                here, others = trail[-1]
                following = next((other for other in others if other not in length and other not in open_ids), None)
                if following is None:
                    length[here] = 1 + max((length.get(other, 0) for other in self.names.get(here, ())), default=0)
                    open_ids.discard(here)
                    trail.pop()
                else:
                    trail.append((following, iter(self.names.get(following, ()))))
                    open_ids.add(following)
            if trail or length[start] > MOST_LEVELS:
                raise InputError(
                    f"{path}: references follow one another over more than {MOST_LEVELS} objects, which breaks "
                    "Mitsuba's parser; refer to the last of them."
                )


def _tokens(data: bytes) -> Iterator[re.Match[bytes]]:
    """Tags, comments and the like, up to the end or to what is none of them."""
    end = 0
    while token := _TOKEN.match(data, end):
        yield token
        end = token.end()


def _as_utf8(data: bytes) -> bytes:
    """A file's text in UTF-8 up to the first zero character, its encoding found as pugixml finds it."""
    encoding = ""
    for mark, name in (
        (b"\xff\xfe\0\0", "utf-32-le"),
        (b"\0\0\xfe\xff", "utf-32-be"),
        (b"\xff\xfe", "utf-16-le"),
        (b"\xfe\xff", "utf-16-be"),
        (b"<\0\0\0", "utf-32-le"),
        (b"\0\0\0<", "utf-32-be"),
        (b"<\0", "utf-16-le"),
        (b"\0<", "utf-16-be"),
    ):
        if data.startswith(mark):
            encoding = name
            break
    if encoding:
        data = data.decode(encoding, "replace").encode("utf-8", "replace")
    return data.partition(b"\0")[0]


def _resolve(name: bytes, folders: list[str]) -> str:
    """Find a file as Mitsuba's resolver does: in the folders in order, or as it stands."""
    text = os.fsdecode(_plain(name))
    for folder in folders:
        # os.path's answer to what no path can be is no
        if os.path.exists(found := os.path.join(folder, text)):
            return found
    return text


def _plain(value: bytes) -> bytes:
    """An attribute without its entities."""
    if b"&" not in value:
        return value
    return unescape(value.decode("latin-1"), {"&quot;": '"', "&apos;": "'"}).encode("latin-1")


def _bytes(text: str) -> bytes:
    # a command line may hold bytes that are no text
    return text.encode("utf-8", "surrogatepass")
