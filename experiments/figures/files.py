"""A figure as PNG and PDF, each of which says how it was made."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from experiments.figures.entry import Drawn, PaperFigure
from experiments.provenance import environment
from scenes.replacing import replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# dots an inch: a picture of 2.3 inches then keeps most of its 512 pixels in neither too large a file
DPI = {"png": 130, "pdf": 110}
# signs of a line of text under a figure, an inch
SIGNS_AN_INCH = 20


def made_of(command: str, renderer: str, stand_ins: tuple[str, ...]) -> dict[str, str]:
    """What a figure's metadata say, by name: command, commit, versions, renderer, date and stand-ins."""
    said = {"command": command, **environment(), "renderer": renderer}
    said["date"] = datetime.now(UTC).isoformat(timespec="seconds")
    return said | ({"stand-ins": " ".join(stand_ins)} if stand_ins else {})


def write_figure(folder: Path, entry: PaperFigure, drawn: Drawn, made: Mapping[str, str]) -> list[Path]:
    """Write both files.

    Raises
    ------
    InputError
        A file cannot be written.
    """
    said = "; ".join(f"{name}: {value}" for name, value in made.items())
    title = f"Weng 2010, {entry.name}: {entry.caption}"
    if "stand-ins" in made:
        _note(drawn.figure, f"procedural stand-ins for {made['stand-ins']}")
    metadata = {
        "png": {"Title": title, "Description": drawn.text, "Comment": said, "Software": "airlight"},
        "pdf": {"Title": title, "Subject": drawn.text, "Keywords": said, "Creator": "airlight"},
    }
    written = []
    for kind, about in metadata.items():
        path = folder / f"{entry.stem}.{kind}"
        with replacing(path) as beside:
            drawn.figure.savefig(beside, format=kind, dpi=DPI[kind], metadata=about)
        written.append(path)
    return written


def _note(figure: Figure, text: str) -> None:
    """Say something below the figure, on it."""
    import textwrap

    width = int(figure.get_figwidth() * SIGNS_AN_INCH)
    figure.supxlabel(textwrap.fill(text, width), fontsize=7, color="0.35")
