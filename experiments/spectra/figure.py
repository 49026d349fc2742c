"""The figure of `airlight spectra`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from experiments.spectra.errors import COEFFICIENTS, DEPTHS, ONE_PHASE, QUANTITIES, Row, select

COLOURS = {"red": "#c0392b", "green": "#27893c", "blue": "#2a5db0"}
LINES = {"mean": "-", "matched": "--", "sampled": ":"}
LEGEND = {
    "mean": "response-weighted mean",
    "matched": "matched at optical depth 1",
    "sampled": "sampled at 680, 550, 440 nm",
}


def draw(path: Path, rows: list[Row]) -> None:
    """Draw relative errors by channel and Delta E 2000 over the optical depth, a column a medium."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.ticker import FuncFormatter

    media = list(dict.fromkeys(row["medium"] for row in rows))
    figure = Figure(figsize=(3.6 * len(media) + 0.6, 10.2), dpi=100, layout="constrained")
    axes = figure.subplots(4, len(media), sharex=True, sharey="row", squeeze=False)
    for column, medium in enumerate(media):
        axes[0, column].set_title(medium)
        axes[3, column].set_xlabel("optical depth at 550 nm")
        for row, quantity in enumerate(QUANTITIES):
            relative, visible = axes[row, column], axes[2 + row, column]
            for choice in COEFFICIENTS:
                where = {"medium": medium, "coefficients": choice, "quantity": quantity}
                for channel, colour in COLOURS.items():
                    error = 100 * select(rows, f"relative_{channel}", **where)
                    # beyond Rec.709 the relative error of a channel means nothing
                    error[select(rows, f"spectral_{channel}", **where) <= 0] = np.nan
                    relative.semilogx(DEPTHS, error, LINES[choice], color=colour, lw=1.2, marker=".", ms=3)
                visible.loglog(DEPTHS, select(rows, "delta_e", **where), "k" + LINES[choice], lw=1.2, marker=".", ms=3)
            if select(rows, "delta_e", medium=medium, quantity=ONE_PHASE).size and quantity == "airlight":
                alone = select(rows, "delta_e", medium=medium, quantity=ONE_PHASE)
                visible.loglog(DEPTHS, alone, "-", color="#d08000", lw=1.2, marker=".", ms=3)
            relative.set_yscale("symlog", linthresh=1.0)
            relative.set_ylim(-30, 300)
            relative.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            relative.axhline(0, color="0.7", lw=0.8)
            visible.axhline(1, color="0.7", lw=0.8)
            visible.set_ylim(0.01, 60)
    for row, label in enumerate(
        [f"{quantity}: error [%]" for quantity in QUANTITIES] + [f"{quantity}: Delta E 2000" for quantity in QUANTITIES]
    ):
        axes[row, 0].set_ylabel(label)
    handles = [Line2D([], [], color="k", ls=style, label=LEGEND[choice]) for choice, style in LINES.items()]
    handles.append(Line2D([], [], color="#d08000", label="mean, one phase function for all wavelengths"))
    figure.legend(handles=handles, loc="outside upper center", ncols=4, frameon=False)
    made = rows[0]
    figure.supxlabel(
        f"{made['command']}; commit {made['commit']}, colour-science {made['colour-science']}, "
        f"miepython {made['miepython']}, {made['date'][:10]}",
        fontsize=8,
    )
    figure.savefig(path, format="png")
