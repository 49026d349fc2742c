"""The folder of a run: what it is a run of, a row for each case that is finished, the tables of all."""

from __future__ import annotations

import fcntl
import glob
import hashlib
import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from experiments.provenance import environment
from experiments.run.rows import Row
from experiments.suite.cases import Case
from experiments.suite.schema import Suite
from scenes.errors import InputError
from scenes.file_names import check_name
from scenes.replacing import make_folder, replacing

if TYPE_CHECKING:
    import polars

Contents = dict[str, Any]
# raised when what a folder holds changes its meaning
FORMAT = 1
RUN, CASES, LOCK, PARQUET = "run.json", "cases", ".lock", "results.parquet"


class RunError(InputError):
    """No case of a run can be measured or kept: its folder takes no more, or its workers are not airlight's."""


@dataclass(frozen=True)
class RunFolder:
    """One run on disk.

    Attributes
    ----------
    path : Path
    record : dict    of run.json: the suite, its contents, the versions and the commit that began it
    lock : file      held while the run goes on, so that nobody else goes on with it
    """

    path: Path
    record: dict[str, Any]
    lock: IO[str] | None = None

    def rows(self) -> dict[str, Row]:
        """Rows that are kept, by their cases' names."""
        return {row["case"]: row for path in sorted((self.path / CASES).glob("*.json")) if (row := _read(path))}

    def write_tables(self, rows: Sequence[Row]) -> None:
        """Write rows as CSV and Parquet, in the order in which they are given."""
        import polars

        told = [{key: value for key, value in row.items() if key != "traceback"} for row in rows]
        table = polars.DataFrame(told, infer_schema_length=None)
        # a column without any value has no type either, and CSV takes none such
        table = table.with_columns(polars.col(polars.Null).cast(polars.String))
        for name, write in (("results.csv", table.write_csv), (PARQUET, table.write_parquet)):
            with replacing(self.path / name) as beside:
                try:
                    write(beside)
                except polars.exceptions.PolarsError as error:
                    # what polars makes of a full disk
                    raise OSError(str(error)) from None

    def close(self) -> None:
        """Let others go on with the run."""
        if self.lock:
            self.lock.close()


def begin_run(parent: Path, name: str, digest: str, contents: Contents, fresh: bool = False) -> tuple[RunFolder, str]:
    """Make a folder for a run, or find the one of the same cases and the same program that was stopped.

    Parameters
    ----------
    digest : of what is to be run; see `digest_of`
    contents : of run.json
    fresh : begin anew all the same

    Returns
    -------
    folder, notice
        A sentence where a stopped run is there that this program cannot go on with.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    check_name(parent.absolute())
    make_folder(parent, "choose another --out")
    notice = ""
    for path in sorted(parent.glob(f"{glob.escape(name)}-*"), reverse=True) if not fresh else []:
        record = _read(path / RUN)
        if not record or record.get("digest") != digest or record.get("finished"):
            continue
        if why := _another_program(record):
            notice = notice or f"{path} was stopped, and is left as it is: {why}."
            continue
        if lock := _locked(path):
            return RunFolder(path, record, lock), notice
    return _new_folder(parent, name, digest, contents), notice


def resume_run(path: Path, name: str, digest: str) -> RunFolder:
    """Go on with the run in a folder.

    Raises
    ------
    InputError
        There is none, it is of another suite or another program, or somebody is at it.
    """
    record = read_record(path)
    if record.get("digest") != digest:
        raise InputError(
            f"{path} is a run of other cases than {name} has now: give the suite, the --set and the --case that it was "
            f"begun with ({record.get('command')}), or leave --resume out."
        )
    if why := _another_program(record):
        raise InputError(f"{path} cannot be gone on with: {why}; leave --resume out to begin anew.")
    if not (lock := _locked(path)):
        raise InputError(f"{path} is being run by another process; wait for it, or leave --resume out.")
    return RunFolder(path, record, lock)


def read_record(path: Path) -> dict[str, Any]:
    """What run.json says of a run.

    Raises
    ------
    InputError
        The folder is no run's, or another version of airlight made it.
    """
    if not (record := _read(path / RUN)):
        raise InputError(f"{path} is not the folder of a run: it has no {RUN} that can be read.")
    if record.get("format") != FORMAT:
        raise InputError(
            f"{path} was made by airlight {record.get('airlight', 'unknown')}, whose results this version "
            f"({environment()['airlight']}) does not read: use that one, or run the suite again."
        )
    return record


def read_table(path: Path) -> polars.DataFrame:
    """The rows of a run, as its tables have them.

    Raises
    ------
    InputError
        There is no table yet, or it is damaged.
    """
    import polars

    table = path / PARQUET
    try:
        # a name with brackets is a name
        return polars.read_parquet(table, glob=False)
    except (OSError, polars.exceptions.PolarsError):
        raise InputError(
            f"{table} is missing or damaged, and is not a table that can be read: `airlight run SUITE --resume {path}` "
            "writes it again."
        ) from None


def finish_run(folder: RunFolder) -> None:
    """Say in run.json that nothing is left to do."""
    _write(folder.path / RUN, folder.record | {"finished": datetime.now(UTC).isoformat(timespec="seconds")})


def keep_row(folder: Path, row: Row) -> None:
    """Keep one row.

    Raises
    ------
    RunError
        It cannot be written.
    """
    _write(folder / CASES / f"{row['case']}.json", row)


def digest_of(suite: Suite, cases: Sequence[Case], scenes: Sequence[str]) -> str:
    """Hash of everything that a suite says, of which of its cases are to run, and of what their scenes hold.

    Parameters
    ----------
    scenes : digests of the scenes, their meshes and pictures, and of committed references
    """
    # a technique of somebody's own has parts that are named by what their files hold
    told = [suite.model_dump_json(), *(f"{case.name} {case.technique} {case.baseline}" for case in cases), *scenes]
    return hashlib.sha256("\0".join(told).encode()).hexdigest()


@cache
def code_digest() -> str:
    """Hash of the program's own sources: a commit does not know what was changed after it."""
    root = Path(__file__).parent.parent.parent
    folders = ("analytic", "scenes", "gpu_impl", "reference", "experiments")
    files = [
        path for folder in folders for path in (root / folder).rglob("*") if path.suffix in (".py", ".glsl", ".xml")
    ]
    found = hashlib.sha256()
    for path in sorted(files):
        found.update(str(path.relative_to(root)).encode() + b"\0" + path.read_bytes())
    return found.hexdigest()


def _another_program(record: dict[str, Any]) -> str:
    """Why a run cannot be gone on with by this program; empty where it can."""
    if record.get("format") != FORMAT:
        return f"airlight {record.get('airlight', 'unknown')} made it"
    if record.get("code") != code_digest():
        return f"it was begun at commit {record.get('commit')}, and airlight's sources have changed since"
    versions = {name: value for name, value in environment().items() if record.get(name) != value and name != "commit"}
    return "it was begun with another " + " and ".join(versions) if versions else ""


def _new_folder(parent: Path, name: str, digest: str, contents: Contents) -> RunFolder:
    stem = f"{name}-{datetime.now():%Y%m%d-%H%M%S}"
    record = {
        "format": FORMAT,
        "suite": name,
        "digest": digest,
        **contents,
        "begun": datetime.now(UTC).isoformat(timespec="seconds"),
        "code": code_digest(),
        **environment(),
    }
    try:
        for attempt in range(1000):
            path = parent / (f"{stem}-{attempt}" if attempt else stem)
            try:
                path.mkdir()
            except FileExistsError:
                continue
            (path / CASES).mkdir()
            _write(path / RUN, record)
            return RunFolder(path, record, _locked(path))
    except OSError as error:
        raise InputError(f"{parent} cannot hold the results ({os.strerror(error.errno or 0)}); choose --out.") from None
    raise InputError(f"{parent} is full of runs of {name}; remove some or choose another --out.")


def _locked(path: Path) -> IO[str] | None:
    """Hold a run's lock, which goes with the process; None where another has it.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    try:
        lock = (path / LOCK).open("w")
    except OSError as error:
        raise InputError(f"{path} cannot be written ({error.strerror}); choose another --out.") from None
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        lock.close()
        return None
    return lock


def _read(path: Path) -> dict[str, Any]:
    """A JSON object; empty where there is none, or half of one."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _write(path: Path, found: dict[str, Any]) -> None:
    try:
        with replacing(path, "make room there, or choose another --out; what is finished is kept") as beside:
            beside.write_text(json.dumps(found, indent=1, default=_plain) + "\n", encoding="utf-8")
    except InputError as error:
        raise RunError(str(error)) from None


def _plain(value: Any) -> Any:
    """Give Python's number for one of numpy's."""
    return value.item()


def ordered(rows: dict[str, Row], names: Iterable[str]) -> list[Row]:
    """Rows in the order of their cases."""
    return [rows[name] for name in names if name in rows]
