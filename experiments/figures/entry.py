"""What the registry of the thesis's figures holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from experiments.figures.stage import Stage

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Drawn:
    """A figure, and what is to be said of it beside the thesis's caption, its numbers computed."""

    figure: Figure
    text: str


@dataclass(frozen=True)
class PaperFigure:
    """One figure or table of the thesis.

    Attributes
    ----------
    number : str     as `--only` takes it: "1.1", "table-5.1"
    caption : str    the thesis's own
    page : int       of the thesis
    draw : callable
    """

    number: str
    caption: str
    page: int
    draw: Callable[[Stage], Drawn]

    @property
    def name(self) -> str:
        """For people: "Figure 1.1", "Table 5.1"."""
        return self.number.replace("table-", "Table ") if "table" in self.number else f"Figure {self.number}"

    @property
    def stem(self) -> str:
        """Name of its files without ending."""
        return self.number if "table" in self.number else f"figure-{self.number}"
