"""Flicker along a camera's path, in a table and a figure."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

from experiments.studies import Plot
from experiments.studies.aliasing.naming import naming, shared_settings
from experiments.studies.aliasing.styles import Styles
from experiments.studies.cells import Gaps, Row, values_of

INTRODUCTION = """## Flicker

The camera turns around the scene: {path}; {shared}. Flicker is what changes in the scattering layer from one frame to
the next beyond the reference's own change, relative to the reference, over the pixels with airlight: root mean square
and 95th percentile. An error that stays where it is in the picture does not flicker. Nothing is taken away for noise of
the reference, which frames share; the column `flicker.noise` has its upper bound.

{table}"""


def flicker_text(rows: Sequence[Row]) -> str:
    """The table; empty where no row has a path."""
    paths = [row for row in rows if row.get("flicker.frames")]
    if not paths:
        return ""
    gaps, name_of, lines = Gaps(), naming(rows), []
    for row in (row for row in rows if row["frames"] > 1):
        cells = [gaps.cell(row, f"flicker.{name}", partial(_shown, name)) for name in ("rms", "high", "moved")]
        lines.append([row["scene"], row["phase"], name_of(row), *cells])
    turns = dict.fromkeys(f"{row['flicker.frames']} frames, {row['flicker.degrees']:g} degrees apart" for row in paths)
    headings = ["scene", "phase function", "technique", "root mean square", "95 %", "the reference's own change"]
    shared = shared_settings(rows) or "settings as they stand"
    return INTRODUCTION.format(path="; ".join(turns), shared=shared, table=gaps.table(headings, lines))


def flicker_plots(rows: Sequence[Row]) -> Iterator[Plot]:
    """A bar a technique, a group a scene, for the first phase function; a line for the truth's own change."""
    from matplotlib.figure import Figure

    shown = [row for row in rows if row.get("flicker.high")]
    if not shown:
        return
    phase = shown[0]["phase"]
    shown = [row for row in shown if row["phase"] == phase]
    name_of = naming(shown)
    scenes, names = values_of(shown, "scene"), list(dict.fromkeys(map(name_of, shown)))
    styles, width = Styles(names), 0.8 / len(names)
    figure = Figure(figsize=(max(7.0, 1.6 * len(scenes) + 1), 3.6), dpi=110, layout="constrained")
    panel = figure.subplots()
    for number, name in enumerate(names):
        mine = [row for row in shown if name_of(row) == name]
        at = [scenes.index(row["scene"]) + (number - (len(names) - 1) / 2) * width for row in mine]
        panel.bar(at, [row["flicker.high"] for row in mine], 0.9 * width, color=styles.colour(name), label=name)
    moved = {row["scene"]: row["flicker.moved"] for row in shown}
    for place, scene in enumerate(scenes):
        panel.hlines(moved[scene], place - 0.45, place + 0.45, color="black", lw=1, ls=":")
    panel.set(yscale="log", ylabel="change beyond the reference's, relative")
    # bars of a logarithmic axis have no natural foot
    panel.set_ylim(bottom=0.3 * min(row["flicker.high"] for row in shown))
    panel.set_xticks(range(len(scenes)), scenes)
    figure.legend(loc="outside upper center", ncols=2, fontsize=8, frameon=False)
    first = shown[0]
    caption = (
        f"Flicker along a path of {first['flicker.frames']} frames, {first['flicker.degrees']:g} degrees apart, "
        f"{phase} phase function: 95th percentile over pixels and pairs of frames. Dotted: the reference's own change, "
        "root mean square."
    )
    yield Plot("flicker", caption, figure)


def _shown(name: str, row: Row) -> str:
    return f"{row[f'flicker.{name}']:.2%}"
