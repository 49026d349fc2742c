"""Pictures of a comparison: technique, reference, and heat maps of the error, a row a technique, on one scale."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.heat_maps.heat_map import NOISE, HeatMap, white
from experiments.heat_maps.panel import Panel, show
from experiments.metrics import Image
from scenes.replacing import replacing

# what a sheet shows where nothing else is asked for
SIGNED_RELATIVE, ABSOLUTE = HeatMap(signed=True, unit="relative"), HeatMap(signed=False, unit="radiance")
# inches: a picture's cell, the heading, the columns' titles with the first row's line, another row's line, the note
CELL, TOP, TITLES, LINE, BOTTOM = 3.1, 0.35, 0.5, 0.35, 0.3
# a bar and the room for its labels, in widths of a picture
BAR, LABELS = 0.04, 0.16


def display(image: Image, reference: Image) -> NDArray[np.floating]:
    """Linear radiance as sRGB values for a screen, exposed for the reference."""
    from colour.models import cctf_encoding

    return np.clip(cctf_encoding(np.clip(np.asarray(image) / white(reference), 0, 1), function="sRGB"), 0, 1)


class Sheet:
    """Draws sheets of one form; the figure is laid out once and filled anew for each, which halves the time."""

    def __init__(self, rows: int, heat_maps: Sequence[HeatMap]) -> None:
        from matplotlib.figure import Figure

        ratios = [1, 1] + [1, BAR, LABELS] * len(heat_maps)
        width, height = CELL * sum(ratios), TOP + TITLES + rows * CELL + (rows - 1) * LINE + BOTTOM
        self._figure = Figure(figsize=(width, height), dpi=100)
        grid = self._figure.add_gridspec(
            rows, len(ratios), width_ratios=ratios, left=0.005, right=1, wspace=0.05,
            bottom=BOTTOM / height, top=1 - (TOP + TITLES) / height, hspace=LINE / CELL,
        )  # fmt: skip
        columns = [[self._figure.add_subplot(grid[row, column]) for row in range(rows)] for column in range(2)]
        self._shown = [[axis.imshow(np.zeros((2, 2, 3))) for axis in axes] for axes in columns]
        for axes, title in zip(columns, ("technique", "reference"), strict=True):
            axes[0].set_title(title, fontsize=10)
        self._panels = []
        for place, heat_map in enumerate(heat_maps):
            column = 2 + 3 * place
            axes = [self._figure.add_subplot(grid[row, column]) for row in range(rows)]
            self._panels.append(Panel(heat_map, axes, self._figure.add_subplot(grid[:, column + 1])))
            columns.append(axes)
        for axis in itertools.chain(*columns):
            axis.set_axis_off()
        self._heading = self._figure.text(0.005, 1 - 0.1 / height, "", fontsize=10, va="top")
        tops = [TOP, *(TOP + TITLES + row * (CELL + LINE) - 0.8 * LINE for row in range(1, rows))]
        self._lines = [self._figure.text(0.005, 1 - top / height, "", fontsize=10, va="top") for top in tops]
        self._note = self._figure.text(0.005, 0.08 / height, "", fontsize=8)

    def write(
        self,
        path: Path,
        title: str,
        rows: Sequence[tuple[str, Image]],
        reference: Image,
        standard_error: Image | None,
        note: str,
    ) -> None:
        """Write the pictures of one layer to a PNG file.

        Parameters
        ----------
        title : what is compared
        rows : line above a row, and its picture (H, W, 3), linear Rec.709
        reference, standard_error : (H, W, 3)    None where the error is not known: then nothing is marked as noise
        note : a line below, such as the stand-in meshes
        """
        for row, (line, test) in enumerate(rows):
            show(self._shown[0][row], display(test, reference))
            show(self._shown[1][row], display(reference, reference))
            self._lines[row].set_text(line)
        tests = [test for _, test in rows]
        scales = [panel.fill(tests, reference, standard_error) for panel in self._panels]
        self._heading.set_text(title)
        grey = f"grey: within {NOISE:g} standard errors of the reference, on the bar those of the median pixel"
        legend = "" if standard_error is None else grey
        self._note.set_text("; ".join(filter(None, (*scales, legend, note))))
        with replacing(path) as beside:
            # the fastest compression: drawing takes long enough
            self._figure.savefig(beside, format="png", pil_kwargs={"compress_level": 1})


def summary(row: Mapping[str, Any]) -> str:
    """The metrics that a sheet shows, in one line."""
    if row["rel_50"] is None:
        return "the reference is black"
    return (
        f"relative error: median {row['rel_50']:.2%}, 95 % of pixels below {row['rel_95']:.2%}, "
        f"image mean {row['image_mean_rel']:+.3%};  HDR-FLIP {row['flip']:.4f}"
    )


@cache
def _sheet(rows: int, heat_maps: tuple[HeatMap, ...]) -> Sheet:
    return Sheet(rows, heat_maps)


def prepare_sheets() -> None:
    """Load what drawing needs, a second's work, before the first sheet is asked for."""
    import colour.models  # noqa: F401

    _sheet(1, (SIGNED_RELATIVE, ABSOLUTE))


def write_sheet(
    path: Path,
    title: str,
    test: Image,
    reference: Image,
    below: str,
    note: str = "",
    standard_error: Image | None = None,
) -> None:
    """Draw one picture's sheet with the process's own figure; see `Sheet.write`.

    Parameters
    ----------
    below : a second line, such as `summary` gives
    """
    write_sheets(path, title, [(below, test)], reference, standard_error, note)


def write_sheets(
    path: Path,
    title: str,
    rows: Sequence[tuple[str, Image]],
    reference: Image,
    standard_error: Image | None = None,
    note: str = "",
    heat_maps: Sequence[HeatMap] = (SIGNED_RELATIVE, ABSOLUTE),
) -> None:
    """Draw several pictures of one reference on one scale, with the process's own figure; see `Sheet.write`."""
    _sheet(len(rows), tuple(heat_maps)).write(path, title, rows, reference, standard_error, note)
