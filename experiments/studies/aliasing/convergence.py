"""How errors fall with the samples of a ray: the fitted order of convergence, in a table and a figure."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

from experiments.intervals import CONFIDENCE
from experiments.studies import Plot
from experiments.studies.aliasing.naming import naming, shared_settings
from experiments.studies.aliasing.styles import Styles
from experiments.studies.cells import Gaps, Row, values_of
from experiments.studies.power_law import FEWEST_POINTS, LEAST_SPAN, Fit, power_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# columns of the measurement "errors", and what tables call them
ERRORS = {
    "scattering.rel_95": "95th percentile",
    "scattering.rel_50": "median",
    "scattering.bias": "root mean square",
}
# Errors fall as long as one number of steps leaves at most so much of them as the number before; a march of first order
# halves them where the steps double.
FALLS = 0.9
# less than so many of the reference's own relative errors is not the technique's
NOISE = 2.0
INTRODUCTION = """## Error against steps

Every pixel evaluated, {steps} samples a ray{shared}. The order p of error ~ steps^-p by least squares on logarithmic
axes, for this one picture. In brackets its {confidence:.0f} % interval, which is of the points' scatter about the line,
if their errors are independent of each other; it says nothing of other scenes, and of {fewest} points it is wide.
Behind it the steps that it was fitted to: the longest stretch in which each number of steps takes {falls:.0f} % or more
off the error of the one before; then, from least to most, the slopes between neighbours in it: where they are far apart
the points bend, and the order is a mean over these steps alone. Where it does not fall so, other things decide: at few
steps an error that is as large as the picture, at many the shadow map's texels or float32. Errors below {noise:g} times
the reference's own are left out. The root mean square is in radiance, the reference's noise taken away.

{table}"""


@dataclass(frozen=True)
class Order:
    """How one error falls.

    Attributes
    ----------
    points : (steps, error) pairs that the fit takes, in the order of the steps
    fit : Fit or None    None where they are too few
    """

    points: tuple[tuple[int, float], ...]
    fit: Fit | None

    def __str__(self) -> str:
        """The order, its interval, the steps that were used, and the least and the most of the slopes between them."""
        if self.fit is None:
            return "does not fall" if len(self.points) < 2 else f"falls over {len(self.points)} points only"
        between = f"{self.points[0][0]} to {self.points[-1][0]}"
        slopes = f"{min(self.slopes):.2f} to {max(self.slopes):.2f}"
        return f"{-self.fit.exponent:.2f} [{-self.fit.high:.2f}, {-self.fit.low:.2f}] ({between}; {slopes})"

    @property
    def slopes(self) -> tuple[float, ...]:
        """The orders between neighbouring points."""
        return tuple(
            -math.log(error / before) / math.log(steps / fewer)
            for (fewer, before), (steps, error) in pairwise(self.points)
        )


def order_of(points: Iterable[tuple[int, float]], least: float = 0.0) -> Order:
    """Fit the order to the longest stretch of points over which the error falls; the first of several.

    The stretch is chosen by the same errors, which makes intervals too narrow where one step's fall is not clear of
    the scatter. Of power laws at 5 numbers of steps, each double the one before, whose errors scatter by 20 %, the
    interval holds an order of 1 or 2 94 % of the time and more, one of 0.5 91 %, and one of 0.25 83 %.

    Parameters
    ----------
    points : (steps, error)
    least : errors at and below this are the reference's, not the technique's
    """
    stretches: list[list[tuple[int, float]]] = [[]]
    for steps, error in sorted(points):
        if error <= least:
            stretches.append([])
            continue
        if stretches[-1] and error > FALLS * stretches[-1][-1][1]:
            stretches.append([])
        stretches[-1].append((steps, error))
    used = max(stretches, key=len)
    enough = len(used) >= FEWEST_POINTS and used[-1][0] >= LEAST_SPAN * used[0][0]
    return Order(tuple(used), power_law(*zip(*used, strict=True)) if enough else None)


def convergence_text(rows: Sequence[Row]) -> str:
    """The table of all orders; empty without rows."""
    if not rows:
        return ""
    gaps, lines = Gaps(), []
    for (scene, phase, technique), mine in ladders(rows).items():
        cells = [_cell(mine, column, gaps) for column in ERRORS]
        lines.append([scene, phase, technique, *cells])
    listed = ", ".join(map(str, values_of(rows, "steps")))
    return INTRODUCTION.format(
        steps=listed,
        shared="".join(f", {words}" for words in [shared_settings(rows)] if words),
        confidence=100 * CONFIDENCE,
        fewest=FEWEST_POINTS,
        falls=100 * (1 - FALLS),
        noise=NOISE,
        table=gaps.table(["scene", "phase function", "technique", *ERRORS.values()], lines),
    )


def convergence_plots(rows: Sequence[Row]) -> Iterator[Plot]:
    """The 95th percentile over steps, a row a phase function and a column a scene."""
    from matplotlib.figure import Figure

    shown = [row for row in rows if row["status"] == "done" and row.get("scattering.rel_95")]
    if not shown:
        return
    scenes, phases = values_of(shown, "scene"), values_of(shown, "phase")
    all_ladders = ladders(shown)
    styles = Styles(list(dict.fromkeys(name for _, _, name in all_ladders)))
    figure = Figure(figsize=(2.7 * len(scenes) + 0.8, 2.5 * len(phases) + 1), dpi=110, layout="constrained")
    panels = figure.subplots(len(phases), len(scenes), sharex=True, sharey=True, squeeze=False)
    for i, phase in enumerate(phases):
        for j, scene in enumerate(scenes):
            mine = {name: rows for (*at, name), rows in all_ladders.items() if at == [scene, phase]}
            _curves(panels[i, j], mine, styles)
            if i == 0:
                panels[i, j].set_title(scene, fontsize=9)
        panels[i, 0].set_ylabel(f"{phase}\nrelative error of the airlight", fontsize=8)
    figure.legend(
        handles=styles.handles(), loc="outside upper center", ncols=min(3, len(scenes)), fontsize=8, frameon=False
    )
    figure.supxlabel("samples a ray", fontsize=8)
    caption = (
        "Relative error of the scattering layer against the samples of a ray: 95th percentile (whole), median "
        "(dashed), and the power law fitted to the percentile (dotted) over the steps that it was fitted to."
    )
    yield Plot("convergence", caption, figure)


def ladders(rows: Sequence[Row]) -> dict[tuple[str, str, str], list[Row]]:
    """The rows of each scene, phase function and technique."""
    found: dict[tuple[str, str, str], list[Row]] = {}
    name = naming(rows, "steps")
    for row in rows:
        found.setdefault((row["scene"], row["phase"], name(row)), []).append(row)
    return found


def order(rows: Sequence[Row], column: str) -> Order:
    """A relative error is held against the reference's relative error; the root mean square has lost it already."""
    points = [(row["steps"], row[column]) for row in rows if row.get(column) is not None]
    least = NOISE * max(float(row["rel_error"]) for row in rows) if column.startswith("scattering.rel") else 0.0
    return order_of(points, least)


def _cell(rows: Sequence[Row], column: str, gaps: Gaps) -> str:
    measured = [row for row in rows if row["status"] == "done" and row.get(column) is not None]
    return str(order(measured, column)) if measured else gaps.cell(rows[0], column, str)


def _curves(panel: Axes, rows: Mapping[str, Sequence[Row]], styles: Styles) -> None:
    for technique, mine in rows.items():
        colour, mark = styles.colour(technique), styles.mark(technique)
        for column, line, width in (("scattering.rel_95", "-", 1.3), ("scattering.rel_50", "--", 0.8)):
            points = sorted((row["steps"], row[column]) for row in mine if row[column] > 0)
            if points:
                panel.plot(*zip(*points, strict=True), line, color=colour, marker=mark, mfc="none", ms=4, lw=width)
        found = order(mine, "scattering.rel_95")
        if found.fit:
            at = [steps for steps, _ in found.points]
            panel.plot(at, found.fit(at), ":", color="black", lw=0.8)
    panel.set(xscale="log", yscale="log")
    steps = sorted({row["steps"] for mine in rows.values() for row in mine})
    panel.set_xticks(steps, [str(one) for one in steps])
    panel.minorticks_off()
    panel.tick_params(labelsize=7)
