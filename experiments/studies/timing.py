"""What techniques cost beside a baseline: the whole grid as one table, and how cost grows with what there is to do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import polars

from experiments.intervals import CONFIDENCE
from experiments.studies import Study
from experiments.studies.cells import Gaps, Row, label, span, values_of
from experiments.studies.power_law import FEWEST_POINTS, LEAST_SPAN
from experiments.studies.timing_growth import growth_table
from experiments.studies.timing_plots import plots
from gpu_impl.timing import WALL_CLOCK

GRID = "grid"
SOFTWARE = """This is a software rasteriser on a processor, no graphics card: passes cost other shares there, so that
these numbers rank techniques on this machine and say little of one with a card. """
INTRODUCTION = """Frames of {size}, surfaces and fog, in which eye and lights move from frame to frame, so that none
reuses another. Drawn by {renderer}; passes timed by {clock}, whole frames by the wall clock around glFinish. {software}
Each case ran in rounds with its baseline ({baseline}), each once a round in an order drawn anew; {rounds} rounds count,
and one more before them, in which shaders are compiled, does not. A ratio is of two frames of one round, the median
over the rounds; in brackets the interval that holds it {confidence:.0%} of the time (sign test). Nothing else of the
suite ran meanwhile: other processes kept {others} processors busy (median and most over the cases), and the load
average before a case was {load}. {noisy}"""
# processors that others keep busy on a machine that is quiet: its own services and the suite's scheduler
QUIET = 0.1
NOISY = """**The machine was not quiet**: in {count} of {all} cases others kept more than {quiet} processors busy. Their
milliseconds are too many and their intervals wide."""
NULL = """How far equal things seem to differ: {count} cases are the baseline itself, and were timed against it like
any other. Their ratios are {span}, and {inside} of {count} intervals hold 1."""
TABLE = """## The whole grid

Milliseconds a frame (median), and as a ratio to the baseline's; N is the spacing of the pixels on which fog is
evaluated.

{table}"""
FOUND = """{faster} of {all} cases are faster than the baseline by their interval, {slower} are slower, {rest} are not
to be told from it. The least ratio is {least}: {technique} in {scene}, {phase}, N = {downsample}."""
GROWTH = """## How cost grows

Exponent p of ms ~ x^p: in each scene the mean over its phase functions and sizes, and of these the mean over the
scenes. In brackets the interval that holds the mean over all scenes like these {confidence:.0%} of the time, by
Student's t over the scenes' exponents; behind it the least and the most of them. Where there is one scene, the interval
is of the scatter about its own line, if the cases' errors are independent, and says nothing of other scenes. n is how
many cases were fitted: curves of fewer than {fewest}, or over less than a factor of {span:g} in x, are not. An exponent
is a mean over the range that was measured: a frame has parts that do not grow.

{table}"""


def text(table: polars.DataFrame) -> str:
    """How it was timed, the noise, the grid, and growth."""
    rows = list(table.iter_rows(named=True))
    timed = [row for row in rows if row["status"] == "done" and row.get("timing.ms_50") is not None]
    if not timed:
        gaps = Gaps()
        lines = [[row["case"], gaps.cell(row, "timing.ms_50", str)] for row in rows]
        return f"Nothing was timed.\n\n{gaps.table(['case', 'ms'], lines)}"
    grid = [row for row in rows if row["product"] == GRID]
    parts = [_introduction(timed), _null(timed)]
    if grid:
        parts += [TABLE.format(table=_grid(grid)), _found(grid)]
    limits = {"confidence": CONFIDENCE, "fewest": FEWEST_POINTS, "span": LEAST_SPAN}
    parts.append(GROWTH.format(table=growth_table(rows), **limits))
    return "\n\n".join(filter(None, parts))


def _introduction(timed: Sequence[Row]) -> str:
    def listed(column: str) -> str:
        return " and ".join(str(value) for value in values_of(timed, column))

    clock, others = listed("timing.clock"), [row["timing.others"] for row in timed]
    noisy = sum(one > QUIET for one in others)
    sizes = sorted({(row["width"], row["height"]) for row in timed})
    return INTRODUCTION.format(
        size=", ".join(f"{width} x {height}" for width, height in sizes),
        renderer=listed("gl_renderer"),
        clock=clock,
        software=SOFTWARE if WALL_CLOCK in clock else "",
        baseline=listed("timing.baseline"),
        rounds=span((row["timing.rounds"] for row in timed), "{}"),
        confidence=CONFIDENCE,
        others=f"{np.median(others):.2f} and {max(others):.2f}",
        load=span((row["timing.load"] for row in timed), "{:.2f}"),
        noisy=NOISY.format(count=noisy, all=len(others), quiet=QUIET) if noisy else "",
    )


def _null(timed: Sequence[Row]) -> str:
    """What is said of the cases that are their own baseline; empty where there is none with an interval."""
    null = [row for row in timed if label(row) == row["timing.baseline"] and row["timing.ratio_low"] is not None]
    if not null:
        return ""
    inside = sum(row["timing.ratio_low"] <= 1 <= row["timing.ratio_high"] for row in null)
    return NULL.format(count=len(null), span=span((row["timing.ratio_50"] for row in null), "{:.3f}"), inside=inside)


def _grid(grid: Sequence[Row]) -> str:
    """A line a scene, phase function and technique, a column a spacing."""
    gaps, spacings = Gaps(), values_of(grid, "downsample")
    found = {(row["scene"], row["phase"], label(row, "downsample"), row["downsample"]): row for row in grid}

    def shown(row: Row) -> str:
        milliseconds = short(row["timing.ms_50"])
        if row["timing.ratio_50"] is None:
            return f"{milliseconds} ms, {gaps.because('no ratio: ' + row['timing.no_interval'])}"
        if row["timing.ratio_low"] is None:
            why = gaps.because("no interval: " + row["timing.no_interval"])
            return f"{milliseconds} ms, {row['timing.ratio_50']:.3f} {why}"
        return f"{milliseconds} ms, {ratio(row)}"

    lines = [
        [*case, *(gaps.cell(found.get((*case, spacing)), "timing.ms_50", shown) for spacing in spacings)]
        for case in dict.fromkeys(key[:3] for key in found)
    ]
    headings = ["scene", "phase function", "technique", *(f"N = {spacing}" for spacing in spacings)]
    return gaps.table(headings, lines)


def _found(grid: Sequence[Row]) -> str:
    """What the grid's intervals say; empty where there are none."""
    known = [row for row in grid if row.get("timing.ratio_low") is not None and label(row) != row["timing.baseline"]]
    if not known:
        return ""
    faster, slower = (
        sum(row["timing.ratio_high"] < 1 for row in known),
        sum(row["timing.ratio_low"] > 1 for row in known),
    )
    least = min(known, key=lambda row: row["timing.ratio_50"])
    return FOUND.format(
        faster=faster,
        all=len(known),
        slower=slower,
        rest=len(known) - faster - slower,
        least=ratio(least),
        technique=label(least, "downsample"),
        scene=least["scene"],
        phase=least["phase"],
        downsample=least["downsample"],
    )


def ratio(row: Row) -> str:
    """A ratio with its interval."""
    return f"{row['timing.ratio_50']:.3f} [{row['timing.ratio_low']:.3f}, {row['timing.ratio_high']:.3f}]"


def short(milliseconds: float) -> str:
    """Three digits."""
    return f"{milliseconds:.0f}" if milliseconds >= 100 else f"{milliseconds:.3g}"


STUDY = Study("What techniques cost", plots, text)
