"""Along which quantities cost grows, and the exponents of that growth."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from experiments.measurements.timing import pass_column
from experiments.studies.cells import Gaps, Row, label, span
from experiments.studies.power_law import MeanFit, mean_power_law
from gpu_impl.techniques import SETTINGS


@dataclass(frozen=True)
class Axis:
    """A quantity that a product of the suite varies.

    Attributes
    ----------
    name : str                of the quantity
    product : str             of the suite
    column : str              of the table, with the quantity; "pixels" for width times height
    apart : tuple of str      columns that differ along the axis, so that rows of one line may differ in them
    passes : tuple of str     those that the quantity is work for, whose times are added up
    """

    name: str
    product: str
    column: str
    apart: tuple[str, ...]
    passes: tuple[str, ...]

    def quantity(self, row: Row) -> float | None:
        """Where a row lies on the axis; None where that was not measured."""
        return row["width"] * row["height"] if self.column == "pixels" else row.get(self.column)

    def technique(self, row: Row) -> str:
        """What a line along the axis is called."""
        return label(row, *(name for name in self.apart if name in SETTINGS))

    def curve(self, row: Row) -> tuple[object, ...]:
        """What a row's cost depends on besides its scene: rows of one curve grow from the same start."""
        return tuple(row[name] for name in ("phase", "width", "height") if name not in self.apart)

    def pass_milliseconds(self, row: Row) -> float:
        """Time of the axis's own passes [ms]."""
        return sum(row[pass_column(name)] for name in self.passes)


FOG, MESHES = ("scattering",), ("geometry", "shadow map", "shadow polygons")
AXES = (
    Axis("pixels of the image", "resolution", "pixels", ("width", "height"), FOG),
    Axis("spacing N of evaluated pixels", "grid", "downsample", ("downsample",), FOG),
    Axis("samples a ray", "steps", "steps", ("steps",), FOG),
    Axis("lit pieces a ray", "intervals", "counts.pieces", (), FOG),
    Axis("triangles", "triangles", "counts.triangles", (), MESHES),
)


def along(axis: Axis, rows: Iterable[Row]) -> dict[str, list[Row]]:
    """The rows that were timed along an axis, by technique, in order of the quantity."""
    lines: dict[str, list[Row]] = {}
    for row in rows:
        timed = row["status"] == "done" and row.get("timing.ms_50") is not None
        if row["product"] == axis.product and timed and axis.quantity(row):
            lines.setdefault(axis.technique(row), []).append(row)
    return {name: sorted(line, key=lambda row: axis.quantity(row) or 0.0) for name, line in lines.items()}


def growth(axis: Axis, line: Sequence[Row], of_passes: bool) -> MeanFit:
    """Fit one technique's time, of the whole frame or of the axis's own passes, over the quantity, in each scene.

    Raises
    ------
    ValueError
        There are too few cases, x hardly differs, or a pass took no time.
    """
    x = [axis.quantity(row) or 0.0 for row in line]
    milliseconds = [axis.pass_milliseconds(row) if of_passes else row["timing.ms_50"] for row in line]
    return mean_power_law(x, milliseconds, [row["scene"] for row in line], [axis.curve(row) for row in line])


def growth_table(rows: Sequence[Row]) -> str:
    """A line an axis and a technique; an axis that the run does not have says so."""
    gaps, lines = Gaps(), []
    for axis in AXES:
        techniques = along(axis, rows)
        if not techniques:
            why = gaps.because(f"the run has no timed case of the product '{axis.product}' with this quantity")
            lines.append([axis.name, why, why, why, why])
        for name, line in techniques.items():
            quantities = [axis.quantity(row) or 0.0 for row in line]
            lines.append(
                [
                    axis.name,
                    name,
                    span(quantities, "{:,.4g}" if max(quantities) < 1e4 else "{:,.0f}"),
                    _cell(axis, line, gaps, of_passes=False),
                    _cell(axis, line, gaps, of_passes=True),
                ]
            )
    headings = ["x", "technique", "from, to", "frame", "its passes"]
    passes = "; ".join(f"{axis.name}: {', '.join(axis.passes)}" for axis in AXES)
    return f"{gaps.table(headings, lines)}\n\nIts passes: {passes}."


def _cell(axis: Axis, line: Sequence[Row], gaps: Gaps, *, of_passes: bool) -> str:
    try:
        return str(growth(axis, line, of_passes))
    except ValueError as error:
        return gaps.because(f"no exponent: {error}")
