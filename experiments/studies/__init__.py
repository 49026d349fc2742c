"""What a run's table says, as plots and text. A new study is one module here, with a `STUDY`, and a line below."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import polars
    from matplotlib.figure import Figure

# by the names that suites call them; imported when they are asked for
STUDIES = {name: f"experiments.studies.{name}" for name in ("errors", "aliasing", "downsampling", "timing", "pareto")}


@dataclass(frozen=True)
class Plot:
    """One figure.

    Attributes
    ----------
    name : str        of its file, without ending
    caption : str     what it shows, in a sentence or two
    """

    name: str
    caption: str
    figure: Figure


@dataclass(frozen=True)
class Study:
    """How a table is told.

    Attributes
    ----------
    title : str          of its page
    plots : callable     table to plots
    text : callable      table to Markdown: sentences and tables, all numbers computed from the table
    """

    title: str
    plots: Callable[[polars.DataFrame], Iterator[Plot]]
    text: Callable[[polars.DataFrame], str]


def find_study(name: str) -> Study:
    """Import the study of this name."""
    found: Study = import_module(STUDIES[name]).STUDY
    return found
