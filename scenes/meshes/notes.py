"""The note beside a fetched mesh: whose it is, on what terms, and how it was made out of which original."""

from __future__ import annotations

from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from scenes.meshes.files import sha256


class StepRecord(BaseModel):
    """One step that was taken, as scenes.meshes.steps.run_steps records it.

    Attributes
    ----------
    step : str               the name of the step
    parameters : dict        its parameters
    made_by : dict           distribution to version, of those that decide what comes out
    vertices, polygons : int what the mesh had after it
    """

    model_config = ConfigDict(strict=True)

    step: str
    parameters: dict[str, int]
    made_by: dict[str, str]
    vertices: int
    polygons: int


class Note(BaseModel):
    """What is known of a fetched mesh.

    Attributes
    ----------
    name : str                 the bare file name of the mesh
    what, credit, licence, origin, page : str   as scenes.meshes.catalogue.KnownMesh has them
    address, member : str      the archive that was downloaded, and the file that was taken out of it
    original_sha256 : str      of that file, hexadecimal
    steps : list               how the mesh was made from it
    triangles : int            of the mesh
    sha256 : str               of the mesh's bytes, hexadecimal
    airlight : str             the version that fetched it
    date : str                 when, UTC, ISO 8601
    """

    model_config = ConfigDict(strict=True)

    name: str
    what: str
    credit: str
    licence: str
    origin: str
    page: str
    address: str
    member: str
    original_sha256: str
    steps: list[StepRecord]
    triangles: int
    sha256: str
    airlight: str
    date: str


def note_path(mesh: Path) -> Path:
    """Where the note of a mesh file is: NAME.json beside NAME, which keeps its own ending."""
    return mesh.with_name(f"{mesh.name}.json")


def read_note(mesh: Path) -> Note | None:
    """The note of a mesh file; None where it has none, a damaged one or one about other bytes.

    Raises
    ------
    InputError   the mesh itself cannot be read
    """
    try:
        note = Note.model_validate_json(note_path(mesh).read_bytes())
    except (OSError, ValidationError):
        return None
    # someone may have put another mesh in its mesh's place
    return note if note.sha256 == sha256(mesh) else None
