"""Aliasing of marches: errors over the full grid and over steps, bands, and flicker; see the suite `aliasing`."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator

import polars

from experiments.studies import Plot, Study
from experiments.studies.aliasing.bands import banding_plots, banding_text
from experiments.studies.aliasing.convergence import convergence_plots, convergence_text
from experiments.studies.aliasing.flickering import flicker_plots, flicker_text
from experiments.studies.aliasing.grid import grid_plots, grid_text
from experiments.studies.aliasing.summary import summary_text
from experiments.studies.cells import Row

# of a page's lines
WIDTH = 120
INTRODUCTION = """Marches at regular steps, and as engines ship them: shifted by interleaved gradient noise
(`:jittered`) or by blue noise (`:blue_noise`), without the blur that follows there; beside the techniques that find lit
intervals. {size} pixels, {references}."""


def text(table: polars.DataFrame) -> str:
    """Convergence, bands, flicker, and the full grid."""
    rows = list(table.iter_rows(named=True))
    parts = _products(rows)
    size = " and ".join(dict.fromkeys(f"{row['width']} x {row['height']}" for row in rows))
    found = [
        INTRODUCTION.format(size=size, references=_references(rows)),
        summary_text(parts["still"], parts["steps"], parts["path"]),
        convergence_text(parts["steps"]),
        banding_text(parts["still"]),
        flicker_text(parts["path"]),
        grid_text(parts["grid"]),
    ]
    return "\n\n".join(_wrapped(paragraph) for part in filter(None, found) for paragraph in part.split("\n\n"))


def plots(table: polars.DataFrame) -> Iterator[Plot]:
    """The figures of the same parts."""
    parts = _products(list(table.iter_rows(named=True)))
    yield from convergence_plots(parts["steps"])
    yield from banding_plots(parts["still"])
    yield from flicker_plots(parts["path"])
    yield from grid_plots(parts["grid"])


def _wrapped(paragraph: str) -> str:
    """Sentences at the pages' width, once their numbers are in; tables, lists and headings as they are."""
    return paragraph if paragraph[0] in "|#-" else textwrap.fill(paragraph, WIDTH, break_on_hyphens=False)


def _products(rows: list[Row]) -> dict[str, list[Row]]:
    """The rows of each of the suite's products, and of the grid those with fog on every pixel, "still"."""
    found = {name: [row for row in rows if row["product"] == name] for name in ("grid", "steps", "path")}
    return found | {"still": [row for row in found["grid"] if row["downsample"] == 1]}


def _references(rows: list[Row]) -> str:
    errors = [float(row["rel_error"]) for row in rows if row.get("rel_error") is not None]
    return f"references with a relative error of {max(errors):.1e} at most" if errors else "no case with a reference"


STUDY = Study("Aliasing", plots, text)
