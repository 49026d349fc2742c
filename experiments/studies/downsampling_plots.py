"""The figures of the study `downsampling`: error against spacing, a row a region and a column a scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import polars

from experiments.measurements.regions import REGIONS
from experiments.studies import Plot
from experiments.studies.cells import Row, label, values_of
from gpu_impl.techniques import UPSAMPLINGS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito's, which colour-blind people can tell apart; marks too, as curves may lie on each other
COLOURS = dict(zip(UPSAMPLINGS, ("#0072b2", "#e69f00", "#d55e00"), strict=True))
MARKS = dict(zip(UPSAMPLINGS, ("o", "s", "x"), strict=True))
LINES = ("-", "--", ":", "-.")


def plots(table: polars.DataFrame) -> Iterator[Plot]:
    """A figure a technique."""
    rows = [row for row in table.iter_rows(named=True) if row.get("edge.share") is not None]
    techniques = list(dict.fromkeys(label(row, "downsample", "upsample") for row in rows))
    for number, technique in enumerate(techniques):
        mine = [row for row in rows if label(row, "downsample", "upsample") == technique]
        phases = values_of(mine, "phase")
        styles = ", ".join(f"{phase} ({line})" for phase, line in zip(phases, LINES, strict=False))
        yield Plot(
            f"downsampling-{number + 1}" if len(techniques) > 1 else "downsampling",
            f"{technique}: 95th percentile of the scattering layer's relative error against the spacing N of evaluated "
            f"pixels, by region; phase functions {styles}. Grey: growth with N and with N squared. Where "
            "one colour alone is seen, the upsamplings come to the same.",
            _figure(mine, phases),
        )


def _figure(rows: Sequence[Row], phases: Sequence[str]) -> Figure:
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    scenes, spacings = values_of(rows, "scene"), values_of(rows, "downsample")
    figure = Figure(figsize=(2.6 * len(scenes) + 0.8, 7.2), dpi=110, layout="constrained")
    panels = figure.subplots(len(REGIONS), len(scenes), sharex=True, sharey="row", squeeze=False)
    for i, region in enumerate(REGIONS):
        for j, scene in enumerate(scenes):
            mine = [row for row in rows if row["scene"] == scene]
            _curves(panels[i, j], mine, f"{region}.rel_95", phases)
            panels[i, j].set_xticks(spacings, [str(one) for one in spacings])
            panels[i, j].minorticks_off()
            if i == 0:
                panels[i, j].set_title(scene, fontsize=9)
        panels[i, 0].set_ylabel(f"{region}: 95th percentile", fontsize=8)
    handles = [Line2D([], [], color=COLOURS[name], marker=MARKS[name], label=name) for name in UPSAMPLINGS]
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles), fontsize=8, frameon=False)
    figure.supxlabel("spacing N of evaluated pixels", fontsize=8)
    return figure


def _curves(panel: Axes, rows: Sequence[Row], column: str, phases: Sequence[str]) -> None:
    highest = 0.0
    for phase, line in zip(phases, LINES, strict=False):
        for upsample in UPSAMPLINGS:
            points = sorted(
                (row["downsample"], row[column])
                for row in rows
                if (row["phase"], row["upsample"]) == (phase, upsample) and (row.get(column) or 0) > 0
            )
            if points:
                at, errors = zip(*points, strict=True)
                panel.plot(at, errors, line, color=COLOURS[upsample], marker=MARKS[upsample], ms=3.5, lw=1.1)
                highest = max(highest, errors[-1])
    panel.set(xscale="log", yscale="log")
    panel.tick_params(labelsize=7)
    if not highest:
        panel.text(0.5, 0.5, "no error above zero", transform=panel.transAxes, ha="center", fontsize=7, color="0.4")
        return
    # slopes to compare with, through the highest point on the right
    for order in (1, 2):
        panel.plot((1, 8), (highest / 8**order, highest), color="0.75", lw=0.8, zorder=0)
