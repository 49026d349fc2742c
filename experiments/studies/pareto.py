"""Error against cost for every technique: `experiments.pareto`."""

from __future__ import annotations

from collections.abc import Iterator

import polars

from experiments.pareto.figure import scene_figures
from experiments.pareto.words import text
from experiments.studies import Plot, Study

TITLE = "Error against cost"


def plots(table: polars.DataFrame) -> Iterator[Plot]:
    """One a scene, and one over all."""
    for name, caption, figure in scene_figures(list(table.iter_rows(named=True))):
        yield Plot(name, caption, figure)


def words(table: polars.DataFrame) -> str:
    """The fronts, where ours stands, which lattice serves it best, and every case."""
    return text(list(table.iter_rows(named=True)))


STUDY = Study(TITLE, plots, words)
