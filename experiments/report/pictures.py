"""Which cases the viewer shows, as much of them as a page can hold."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from experiments.heat_maps.colours import colour_map, table
from experiments.heat_maps.heat_map import NOISE, HeatMap, luminance, typical_noise, white
from experiments.pictures import Picture, read_picture
from experiments.report.halves import Blocks, Halves
from experiments.run.rows import Row
from reference.brightness import darkest

LAYER = "scattering"
# of a page's pictures, as text: what a browser opens in a second or two, and a mail still takes
LARGEST_PAGE = 24_000_000
# longest side of what is shown, the first that fits; pixels between are left out
SIDES = (512, 256, 128)
# that a case takes, to choose the side by
CHARACTERS_PER_PIXEL = 4


@dataclass
class Shown:
    """The viewer's pictures.

    Attributes
    ----------
    blocks : Blocks
    cases : list of dict     one a case, as viewer.js reads it
    left_out : list of str   names of the EXR files for which there was no room
    """

    blocks: Blocks = field(default_factory=Blocks)
    cases: list[dict[str, Any]] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)

    @property
    def data(self) -> dict[str, Any]:
        """What the viewer is told besides the texts of the blocks."""
        names: tuple[Any, ...] = ("vik", "lajolla", "hue")
        maps = {name: base64.b64encode(table(colour_map(name)).tobytes()).decode() for name in names}
        return {"cases": self.cases, "maps": maps, "noise": NOISE}


def choose_pictures(folder: Path, rows: Sequence[Row], room: int = LARGEST_PAGE) -> Shown:
    """Put a run's pictures into as many characters as there is room for.

    Parameters
    ----------
    rows : of the run; those whose EXR file is in the folder have pictures
    """
    shown = Shown()
    found = [row for row in rows if (folder / f"{row['case']}.exr").is_file()]
    side = _side(len(found), room)
    for row in found:
        path = folder / f"{row['case']}.exr"
        if shown.blocks.size >= room:
            shown.left_out.append(path.name)
        elif case := _case(read_picture(path), side, shown.blocks):
            shown.cases.append({"name": row["case"], "exr": path.name, **case})
    return shown


def _side(cases: int, room: int) -> int:
    """The longest side at which all cases fit, or the shortest that is of any use."""
    return next((side for side in SIDES if cases * side**2 * CHARACTERS_PER_PIXEL <= room), SIDES[-1])


def _case(picture: Picture, side: int, blocks: Blocks) -> dict[str, Any] | None:
    """One case as the viewer reads it; None for a file without technique and reference."""
    layers = picture.layers
    test, reference = layers.get(LAYER), layers.get(f"reference.{LAYER}")
    if test is None or reference is None:
        return None
    standard_error = layers.get(f"standard_error.{LAYER}")
    height, width = reference.shape[:2]
    step = -(-max(height, width) // side)
    # pixels are left out, not averaged: each that is shown has the file's own values
    few = np.s_[::step, ::step]
    # the error on its own: as a difference of two rounded pictures it would be lost below 0.1 %
    error = luminance(test) - luminance(reference)
    return {
        "width": len(range(0, width, step)),
        "height": len(range(0, height, step)),
        "step": step,
        "technique": _block(blocks, test[few]),
        "reference": _block(blocks, reference[few]),
        "error": _block(blocks, error[few]),
        "standard_error": None if standard_error is None else _block(blocks, luminance(standard_error)[few]),
        "white": white(reference),
        "floor": darkest(luminance(reference)),
        "scales": dict(_scales(reference)),
        "noise": _noise(standard_error, reference),
    }


def _block(blocks: Blocks, image: np.ndarray) -> dict[str, Any]:
    halves: Halves = blocks.add(image)
    return asdict(halves)


def _scales(reference: np.ndarray) -> Iterator[tuple[str, dict[str, float | None]]]:
    for unit in ("relative", "radiance"):
        for spacing in ("log", "linear"):
            scale = HeatMap(True, unit, spacing == "log").scale(reference)
            yield f"{unit} {spacing}", {"limit": scale.limit, "linear": scale.linear}


def _noise(standard_error: np.ndarray | None, reference: np.ndarray) -> dict[str, float]:
    """Level of the typical pixel's noise in each unit; 0 where it is not known."""
    if standard_error is None:
        return {"relative": 0.0, "radiance": 0.0}
    units: tuple[Any, ...] = ("relative", "radiance")
    return {unit: typical_noise(HeatMap(True, unit).noise(standard_error, reference)) for unit in units}
