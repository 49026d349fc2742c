"""Error over cost on logarithmic axes: a figure a scene and one over all, a panel a measure, the fronts numbered."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import cycle
from typing import TYPE_CHECKING

from experiments.palette import OKABE_ITO
from experiments.pareto.front import Point, Standing, front, standing
from experiments.pareto.points import MEASURES, Measure, is_ours, over_all, scenes_of
from experiments.studies.cells import Row, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# ours has a colour and a mark of its own
*COLOURS, OUR_COLOUR = OKABE_ITO
MARKS, OUR_MARK = "osvD^PX", "*"
STRENGTH = {Standing.FRONT: 1.0, Standing.BY_MEDIAN: 1.0, Standing.UNDECIDED: 1.0, Standing.BEHIND: 0.35}
CAPTION = """{where}: error against the time of a frame{mean}, left by {left}, right by {right}. The line is the front,
its members numbered from the cheapest; hollow points are not to be told apart from it or are on it by the median alone,
pale ones are behind. Bars are the intervals of the costs."""
Style = tuple[str, str]


def scene_figures(rows: Sequence[Row]) -> Iterator[tuple[str, str, Figure]]:
    """Name, caption and figure of each scene that has points, and of their mean where there are several."""
    scenes = [scene for scene in scenes_of(rows) if scene.rows]
    families = {label(row): row["technique"] for scene in scenes for row in scene.rows}
    ours = {row["technique"] for scene in scenes for row in scene.rows if is_ours(row)}
    styles = styles_of(dict.fromkeys(families.values()), ours)
    for scene in scenes:
        panels = {measure: scene.points(measure) for measure in MEASURES}
        yield _file_name(scene.name), _caption(scene.name, ""), _figure(panels, families, styles)
    means = {measure: over_all(scenes, measure) for measure in MEASURES}
    if len(scenes) > 1 and all(means.values()):
        where = f"All {len(scenes)} scenes"
        yield "all", _caption(where, ", geometric means over the scenes"), _figure(means, families, styles)


def styles_of(families: Mapping[str, None], ours: set[str]) -> dict[str, Style]:
    """A colour and a mark for each technique: black stars for ours."""
    others = [name for name in families if name not in ours]
    styles = dict(zip(others, zip(cycle(COLOURS), cycle(MARKS), strict=False), strict=False))
    return styles | dict.fromkeys(sorted(ours), (OUR_COLOUR, OUR_MARK))


def _caption(where: str, mean: str) -> str:
    left, right = (measure.what for measure in MEASURES)
    return " ".join(CAPTION.format(where=where, mean=mean, left=left, right=right).split())


def _file_name(scene: str) -> str:
    return f"scene-{re.sub(r'[^A-Za-z0-9._-]+', '-', scene)}"


def _figure(panels: Mapping[Measure, list[Point]], families: Mapping[str, str], styles: Mapping[str, Style]) -> Figure:
    from matplotlib.figure import Figure

    # room for the names of a front's members below its panel
    longest = max(len(front(points)) for points in panels.values())
    figure = Figure(figsize=(6.0 * len(panels), 4.6 + 0.17 * longest), dpi=110, layout="constrained")
    axes = figure.subplots(2, len(panels), squeeze=False, height_ratios=(4.2, 0.17 * longest + 0.1))
    for j, (measure, points) in enumerate(panels.items()):
        _draw(axes[0, j], points, families, styles)
        axes[0, j].set_ylabel(_wrapped(measure.what), fontsize=8)
        axes[0, j].set_xlabel("ms a frame", fontsize=8)
        _name_front(axes[1, j], points)
    _legend(figure, {families[point.name] for points in panels.values() for point in points}, styles)
    return figure


def _wrapped(words: str) -> str:
    import textwrap

    return "\n".join(textwrap.wrap(words, 48))


def _draw(panel: Axes, points: Sequence[Point], families: Mapping[str, str], styles: Mapping[str, Style]) -> None:
    members = front(points)
    positive = [point.error for point in points if point.error > 0]
    # a logarithmic axis has no place for 0, which stands below all others
    least = 0.5 * min(positive, default=1.0)
    for point in points:
        colour, mark = styles[families[point.name]]
        where = standing(point, points)
        panel.errorbar(
            point.cost,
            max(point.error, least),
            xerr=[[point.cost - point.low], [point.high - point.cost]],
            color=colour,
            marker=mark,
            ms=9 if mark == OUR_MARK else 5.5,
            mfc="white" if where in (Standing.UNDECIDED, Standing.BY_MEDIAN) else colour,
            alpha=STRENGTH[where],
            elinewidth=0.8,
            zorder=2 if where == Standing.BEHIND else 3,
        )
    panel.set(xscale="log", yscale="log")
    steps = [(point.cost, max(point.error, least)) for point in members]
    panel.step(*zip(*steps, strict=True), where="post", color="0.35", lw=1.0, zorder=1)
    for number, (x, y) in enumerate(steps, start=1):
        panel.annotate(str(number), (x, y), (-4, -4), textcoords="offset points", ha="right", va="top", fontsize=8)
    _plain_ticks(panel)


def _plain_ticks(panel: Axes) -> None:
    """Milliseconds as they are read, at 1, 2 and 5 of a decade."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    panel.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    panel.xaxis.set_minor_formatter(NullFormatter())
    panel.tick_params(labelsize=8)
    panel.grid(color="0.9", lw=0.6)
    panel.set_axisbelow(True)


def _name_front(panel: Axes, points: Sequence[Point]) -> None:
    """Who the numbers are."""
    panel.axis("off")
    names = "\n".join(f"{number}  {point.name}" for number, point in enumerate(front(points), start=1))
    # a technique may be called anything, and formulas cannot
    panel.text(0.0, 1.0, names, va="top", fontsize=8, parse_math=False, transform=panel.transAxes)


def _legend(figure: Figure, drawn: set[str], styles: Mapping[str, Style]) -> None:
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=colour, marker=mark, ms=8 if mark == OUR_MARK else 5.5, ls="none", label=_told(name, mark))
        for name, (colour, mark) in styles.items()
        if name in drawn
    ]
    figure.legend(handles=handles, loc="outside upper center", ncols=5, fontsize=8, frameon=False)


def _told(name: str, mark: str) -> str:
    return f"{name} (ours)" if mark == OUR_MARK else name
