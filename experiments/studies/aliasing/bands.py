"""Bands and grain of marches: the error's spectrum along and across the shafts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from experiments.measurements.banding import COARSE, OCTAVES, WINDOW
from experiments.studies import Plot
from experiments.studies.aliasing.naming import naming, shared_settings
from experiments.studies.aliasing.styles import Styles
from experiments.studies.cells import Gaps, Row, values_of

# of the steps in the run, those that are nearest to it are shown: what engines take for fog is of this size
STEPS = 64
INTRODUCTION = """## Bands and grain

The error of the scattering layer's luminance, relative, every pixel evaluated ({shared}), taken apart
into waves in windows of the picture (`experiments/measurements/banding.py`): those of {coarse} to {longest} pixels are
bands, *along* the shafts (rings around the light) or *across* them (streaks); shorter ones are grain. Root mean
squares. The coarse share is that of the bands in the mean square: for white noise 4.8 % in windows of {window} pixels
and less in smaller pictures, next to nothing for blue noise. Waves longer than {longest} pixels count in part. The
strongest wave is a bin of the spectrum: one of p pixels stands for p²/{twice} more or less.

{table}"""

# columns of the measurement "banding", what the table calls them and how it writes them
COLUMNS = {
    "rms": ("error", "{:.2%}"),
    "along": ("along", "{:.2%}"),
    "across": ("across", "{:.2%}"),
    "coarse_share": ("coarse share", "{:.1%}"),
    "period": ("strongest wave [pixel]", "{:.1f}"),
}


def banding_text(rows: Sequence[Row]) -> str:
    """The table at `STEPS` or near it; empty where no row has a spectrum."""
    shown = at_steps(rows)
    if not shown:
        return ""
    gaps, name_of = Gaps(), naming(shown)
    lines = []
    for row in shown:
        cells = [gaps.cell(row, f"banding.{name}", partial(_shown, name)) for name in COLUMNS]
        lines.append([row["scene"], row["phase"], name_of(row), *cells])
    headings = ["scene", "phase function", "technique", *(heading for heading, _ in COLUMNS.values())]
    return INTRODUCTION.format(
        shared=shared_settings(shown), coarse=COARSE, longest=OCTAVES[-1], window=WINDOW, twice=2 * WINDOW,
        table=gaps.table(headings, lines),
    )  # fmt: skip


def banding_plots(rows: Sequence[Row]) -> Iterator[Plot]:
    """The spectrum along and across, a column a scene, for the first phase function."""
    from matplotlib.figure import Figure

    shown = [row for row in at_steps(rows) if row.get("banding.rms")]
    if not shown:
        return
    phase = shown[0]["phase"]
    shown = [row for row in shown if row["phase"] == phase]
    scenes = values_of(shown, "scene")
    name_of = naming(shown)
    styles = Styles(list(dict.fromkeys(map(name_of, shown))))
    figure = Figure(figsize=(2.7 * len(scenes) + 0.8, 5.4), dpi=110, layout="constrained")
    panels = figure.subplots(2, len(scenes), sharex=True, sharey=True, squeeze=False)
    for i, way in enumerate(("along", "across")):
        for j, scene in enumerate(scenes):
            panel = panels[i, j]
            for row in (row for row in shown if row["scene"] == scene):
                name = name_of(row)
                values = [(octave, row[f"banding.{way}_{octave}px"]) for octave in OCTAVES]
                points = [(octave, value) for octave, value in values if value]
                if points:
                    at, rms = zip(*points, strict=True)
                    panel.plot(at, rms, color=styles.colour(name), marker=styles.mark(name), mfc="none", ms=4, lw=1.1)
            panel.axvline(COARSE * 2**0.5, color="0.6", lw=0.8, ls=":")
            panel.set(xscale="log", yscale="log")
            panel.set_xticks(OCTAVES, [str(octave) for octave in OCTAVES])
            panel.minorticks_off()
            panel.tick_params(labelsize=7)
            if i == 0:
                panel.set_title(scene, fontsize=9)
        panels[i, 0].set_ylabel(f"{way} the shafts\nrelative error, root mean square", fontsize=8)
    figure.legend(
        handles=styles.handles(), loc="outside upper center", ncols=min(3, len(scenes)), fontsize=8, frameon=False
    )
    figure.supxlabel("waves of up to so many pixels, from half as many on", fontsize=8)
    caption = (
        f"Spectrum of the error in octaves along and across the shafts, {phase} phase function, "
        f"{shown[0]['steps']} samples a ray; right of the dotted line what is seen as bands, left of it grain."
    )
    yield Plot("banding", caption, figure)


def _shown(name: str, row: Row) -> str:
    return COLUMNS[name][1].format(row[f"banding.{name}"])


def at_steps(rows: Sequence[Row]) -> list[Row]:
    """The rows whose steps are nearest to `STEPS`, if any row has a spectrum."""
    measured = [row for row in rows if row.get("banding.rms") is not None]
    if not measured:
        return []
    steps = min(values_of(measured, "steps"), key=lambda one: abs(one - STEPS))
    return [row for row in rows if row["steps"] == steps]
