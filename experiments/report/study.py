"""What a run's study says, as HTML."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING

from markdown_it import MarkdownIt
from markupsafe import Markup

from experiments.studies import Study

if TYPE_CHECKING:
    import polars
    from matplotlib.figure import Figure

# pixels an inch: sharp where a page shows a figure at its own size
DPI = 130


@dataclass(frozen=True)
class PlotImage:
    """One plot: its caption and its picture, a PNG as a data URI."""

    caption: str
    source: str


def study_text(study: Study, table: polars.DataFrame) -> Markup:
    """The study's Markdown as HTML; what is HTML in it is shown as text, and no picture is loaded."""
    markdown = MarkdownIt("js-default").disable("image")
    return Markup(markdown.render(study.text(table)))


def study_plots(study: Study, table: polars.DataFrame) -> Iterator[PlotImage]:
    """The study's plots."""
    for plot in study.plots(table):
        yield PlotImage(plot.caption, _source(plot.figure))


def _source(figure: Figure) -> str:
    held = BytesIO()
    figure.savefig(held, format="png", dpi=DPI)
    return f"data:image/png;base64,{base64.b64encode(held.getvalue()).decode()}"
