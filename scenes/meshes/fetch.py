"""Meshes fetched from their makers: downloaded, checked, repaired and put into the user's data folder with a note."""

from __future__ import annotations

import hashlib
import os
import re
import socket
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from http.client import IncompleteRead
from importlib.metadata import version
from pathlib import Path

from scenes.errors import InputError
from scenes.meshes import catalogue
from scenes.meshes.archive_member import unpack_member
from scenes.meshes.catalogue import KnownMesh, Original
from scenes.meshes.files import VARIABLE, MeshFile, user_folder
from scenes.meshes.notes import Note, StepRecord, note_path, read_note
from scenes.meshes.polygons import as_triangles, read_polygons
from scenes.meshes.steps import run_steps
from scenes.meshes.triangles import ply_bytes
from scenes.replacing import make_folder, replacing

# of silence, not of the whole download
TIMEOUT = 30.0  # [s]
# the archives that are fetched have some 10 to 30 MB
LARGEST_DOWNLOAD = 512 * 2**20
CHUNK = 2**16
FOLDER_CURE = "make room there, make it writable, or set XDG_DATA_HOME to another folder"
TEMPORARY_CURE = "make room there, make it writable, or set TMPDIR to another folder"


class Watcher:
    """What a caller may want to show; every method does nothing by itself."""

    def downloading(self, address: str, done: int, total: int) -> None:
        """Bytes of an archive that are here, of `total` (0 where the server does not say)."""

    def doing(self, mesh: str, what: str) -> None:
        """Something that takes seconds begins."""


@dataclass(frozen=True)
class Fetched:
    """A mesh that is in the user's data folder now.

    Attributes
    ----------
    path : Path    the PLY file; its note is beside it (scenes.meshes.notes)
    note : Note    what its note says; None for the reference copy, which the user put there
    fresh : bool   False where it was there already: from the same original by the same steps, or the reference copy
    """

    path: Path
    note: Note | None
    fresh: bool


def fetchable() -> list[str]:
    """Names of the meshes that `fetch` can get."""
    return [name for name, known in catalogue.MESHES.items() if known.original]


def check_names(names: Iterable[str]) -> None:
    """Raise InputError for the first name that cannot be fetched, with what to do instead."""
    for name in names:
        if name not in catalogue.MESHES:
            known = ", ".join(catalogue.MESHES)
            raise InputError(f"'{name}' is no mesh that can be fetched; those that scenes name are {known}.")
        mesh = catalogue.MESHES[name]
        if mesh.original is None:
            raise InputError(
                f"{name} comes from {mesh.origin} ({mesh.page}), but no original of it with a known hash, so it cannot "
                f"be fetched: get it by hand and put it into a folder that {VARIABLE} names."
            )


def fetch(names: Iterable[str], watcher: Watcher) -> Iterator[Fetched]:
    """Put meshes into the user's data folder, one after the other as the result is read.

    Those that are there already come first; an archive that several need is downloaded once. A mesh that fails
    leaves nothing behind, and those before it stay. Only a mesh that was fetched, and whose recipe has changed since,
    is replaced.

    Raises
    ------
    InputError   a name is unknown or cannot be fetched, another file has its place, the download fails or is not what
                 it should be, or a folder cannot be written
    """
    wanted = list(dict.fromkeys(names))
    check_names(wanted)
    by_address: dict[str, list[tuple[str, KnownMesh, Original]]] = {}
    for name in wanted:
        known, found = catalogue.MESHES[name], _already_there(name)
        if found:
            yield found
        elif known.original:
            by_address.setdefault(known.original.address, []).append((name, known, known.original))
    for address, meshes in by_address.items():
        try:
            with tempfile.TemporaryDirectory(prefix="airlight-") as folder:
                archive = _download(address, Path(folder), watcher)
                for name, known, original in meshes:
                    yield _make(name, known, original, archive, watcher)
        except OSError as error:
            reason = f"{tempfile.gettempdir()} cannot be written ({error.strerror or error})"
            raise InputError(f"{reason}: {TEMPORARY_CURE}.") from None


def _already_there(name: str) -> Fetched | None:
    """The mesh in the user's data folder, None where it has to be fetched; InputError where another file is there."""
    path = user_folder() / name
    # a link to nowhere too is somebody's
    if not os.path.lexists(path):
        return None
    if path.is_file():
        note = read_note(path)
        if note and note.name == name:
            return Fetched(path, note, fresh=False) if catalogue.made_as_now(note) else None
        if catalogue.is_reference_copy(MeshFile(name, path, "user data")):
            return Fetched(path, None, fresh=False)
    raise InputError(
        f"{path} is there already and is not airlight's; move it away, such as into a folder that {VARIABLE} names."
    )


def _download(address: str, folder: Path, watcher: Watcher) -> Path:
    """Download an archive into `folder`."""
    # takes a third of a second to import
    import pooch
    from requests.exceptions import RequestException

    # it would print the hash of an archive, where it is the hash of the member that is known
    pooch.get_logger().setLevel("WARNING")
    downloader = pooch.HTTPDownloader(progressbar=_Progress(address, watcher), chunk_size=CHUNK, timeout=TIMEOUT)
    try:
        return Path(pooch.retrieve(address, known_hash=None, fname="archive", path=folder, downloader=downloader))
    except RequestException as error:
        raise InputError(
            f"{address} could not be downloaded ({_reason(error)}); try again later, or put the mesh itself into a "
            f"folder that {VARIABLE} names."
        ) from None


def _reason(error: Exception) -> str:
    """In plain words, what is at the bottom of what requests and urllib3 wrap."""
    response = getattr(error, "response", None)
    if response is not None:
        return f"{response.status_code} {response.reason}"
    innermost: BaseException = error
    while inner := _within(innermost):
        innermost = inner
    if isinstance(innermost, socket.gaierror):
        name = re.search("resolve '(.+?)'", str(error))
        return f"the name {name[1] if name else 'of its server'} cannot be resolved"
    if isinstance(innermost, IncompleteRead):
        return f"the connection was cut with {innermost.expected} bytes still to come"
    # urllib3 begins with the connection's own address
    plain = re.sub(r"^\w+\(host=.*?\): ", "", str(innermost)).rstrip(".")
    return (isinstance(innermost, OSError) and innermost.strerror) or plain or type(innermost).__name__


def _within(error: BaseException) -> BaseException | None:
    """What an exception wraps: its `reason`, one of its arguments, or its cause."""
    wrapped = (getattr(error, "reason", None), *error.args, error.__cause__)
    return next((inner for inner in wrapped if isinstance(inner, BaseException)), None)


class _Progress:
    """A progress bar as pooch drives it, which also ends a download that grows beyond all measure."""

    def __init__(self, address: str, watcher: Watcher) -> None:
        self.total = 0
        self._address, self._watcher, self._done = address, watcher, 0

    def update(self, size: int) -> None:
        self._done += size
        if self._done > LARGEST_DOWNLOAD:
            limit = LARGEST_DOWNLOAD >> 20
            raise InputError(f"{self._address} sends more than {limit} MB, which no archive of meshes has; look at it.")
        self._watcher.downloading(self._address, min(self._done, self.total or self._done), self.total)

    def reset(self) -> None:
        self._done = 0

    def close(self) -> None:
        """Nothing is open."""


def _make(name: str, known: KnownMesh, original: Original, archive: Path, watcher: Watcher) -> Fetched:
    """Make one mesh out of a downloaded archive and put it, with its note, into the user's data folder."""
    watcher.doing(name, f"unpack {original.member}")
    unpacked = archive.with_name(f"original{Path(original.member).suffix}")
    unpack_member(archive, original.member, original.sha256, unpacked, original.address)
    mesh, records = run_steps(read_polygons(unpacked), known.steps, lambda step: watcher.doing(name, str(step)))
    triangles = as_triangles(mesh)
    data = ply_bytes(triangles)
    note = Note(
        name=name,
        what=known.what,
        credit=known.credit,
        licence=known.licence,
        origin=known.origin,
        page=known.page,
        address=original.address,
        member=original.member,
        original_sha256=original.sha256,
        steps=[StepRecord(**record) for record in records],
        triangles=len(triangles.faces),
        sha256=hashlib.sha256(data).hexdigest(),
        airlight=version("airlight"),
        date=datetime.now(UTC).isoformat(timespec="seconds"),
    )
    path = user_folder() / name
    make_folder(path.parent, FOLDER_CURE)
    _write(path, data, note.model_dump_json(indent=2) + "\n")
    return Fetched(path, note, fresh=True)


def _write(path: Path, data: bytes, note: str) -> None:
    """Write a mesh and its note: both, or neither."""
    try:
        with replacing(path, FOLDER_CURE) as mesh_beside, replacing(note_path(path), FOLDER_CURE) as note_beside:
            mesh_beside.write_bytes(data)
            note_beside.write_text(note, "utf-8")
    except BaseException:
        # the note takes its place first; where the mesh then cannot, it would be about nothing
        if not path.is_file():
            note_path(path).unlink(missing_ok=True)
        raise
