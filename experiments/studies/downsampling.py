"""How errors grow with the lattice's spacing, for each upsampling: on smooth ground, at shafts, at edges of depth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import polars

from experiments.intervals import CONFIDENCE
from experiments.markdown import table as markdown_table
from experiments.measurements.regions import DEPTH_BEND, REACH, REGIONS, SHAFT_BEND
from experiments.studies import Study
from experiments.studies.cells import Gaps, Row, label, span, values_of
from experiments.studies.downsampling_plots import plots
from experiments.studies.power_law import FEWEST_POINTS, mean_power_law
from gpu_impl.techniques import UPSAMPLINGS

NO_PICTURE = "no picture has an error with every upsampling"
# errors that differ by less are as good as each other
TIE = 0.01
# what `picture` returns, in words
PICTURE = ("scene", "phase function", "technique", "size", "camera")
WHAT = {"smooth": "Smooth ground", "shaft": "Borders of shafts", "edge": "Edges of depth"}
INTRODUCTION = """Fog is evaluated on every N-th pixel in x and in y, and the pixels between get their value by one of
three upsamplings. Errors of the scattering layer at {size}, relative, over pixels with airlight; median / 95th
percentile. A pixel is at an *edge* if it lies {reach} pixels or less (the coarsest lattice's spacing, in x and in y)
from one at which inverse depth bends by more than {depth:.0%}; at a *shaft*, if it is none of those and lies as near to
one at which the reference's airlight bends by more than {shaft:.0%}, as it does at borders of shadows and of a spot's
cone, of which depth knows nothing; the rest is *smooth*. N = 1 evaluates every pixel: what it leaves is not the
lattice's error."""
WINNERS = """## Which upsampling is best

In how many of the pictures with numbers an upsampling has the least 95th percentile, or one within {tie:.0%} of it;
behind that its error over `bilinear`'s, the geometric mean.

{table}

Scene by scene at edges of depth: the best by its 95th percentile, or those within {tie:.0%} of it, and behind them the
best's over the worst's; geometric means over phase functions and techniques.

{scenes}"""
GROWTH = """## How fast errors grow

Exponent p of error ~ N^p over N = {spacings}: in each scene the mean over its phase functions, sizes and cameras, and
of these the mean over the scenes. In brackets the interval that holds the mean over all scenes like these
{confidence:.0%} of the time, by Student's t over the scenes' exponents; behind it the least and the most of them. Where
there is one scene, the interval is of the scatter about its own line, if errors at different N are independent, and
says nothing of other scenes. n counts the errors that were fitted: those of pictures with {fewest} or more above zero.

{table}"""


def text(table: polars.DataFrame) -> str:
    """All errors, the best upsampling, and the order of growth."""
    # a suite may draw a picture twice, to keep it the second time; it counts once
    everything = table.iter_rows(named=True)
    rows = list({(picture(row), row["upsample"], row["downsample"]): row for row in everything}.values())
    measured = [row for row in rows if row["status"] == "done"]
    size = " and ".join(dict.fromkeys(f"{row['width']} x {row['height']}" for row in rows))
    parts = [INTRODUCTION.format(size=size, reach=REACH, depth=DEPTH_BEND, shaft=SHAFT_BEND), _shares(measured)]
    parts += [f"## {WHAT[region]}\n\n{_errors(rows, region)}" for region in REGIONS]
    spacings = [value for value in values_of(rows, "downsample") if value > 1]
    if measured and spacings:
        parts.append(WINNERS.format(tie=TIE, table=_winners(measured, spacings), scenes=_by_scene(measured, spacings)))
        parts.append(_growth(measured, spacings))
    return "\n\n".join(parts)


def picture(row: Row) -> tuple[str, ...]:
    """What is drawn, whatever its lattice and its upsampling."""
    size = f"{row['width']} x {row['height']}"
    return row["scene"], row["phase"], label(row, "downsample", "upsample"), size, str(row["camera"])


def _shares(rows: Sequence[Row]) -> str:
    """How much of a picture's airlight each region has."""
    lines = []
    for scene in values_of(rows, "scene"):
        mine = [row for row in rows if row["scene"] == scene and row.get("edge.share") is not None]
        if mine:
            lines.append([scene, *(span((row[f"{region}.share"] for row in mine), "{:.0%}") for region in REGIONS)])
    return markdown_table(["share of the pixels with airlight", *REGIONS], lines)


def _errors(rows: Sequence[Row], region: str) -> str:
    """A line a picture and upsampling, a column a spacing."""
    spacings, gaps = values_of(rows, "downsample"), Gaps()
    found = {(picture(row), row["upsample"], row["downsample"]): row for row in rows}
    column = f"{region}.rel_95"

    def shown(row: Row) -> str:
        return f"{_percent(row[f'{region}.rel_50'])} / {_percent(row[column])}"

    def cell(row: Row | None) -> str:
        if row and row["status"] == "done" and row.get(f"{region}.share") == 0:
            return gaps.because("no pixel with airlight is in this region")
        return gaps.cell(row, column, shown)

    pictures = list(dict.fromkeys(key[0] for key in found))
    # size and camera where there are several
    told = [i for i in range(len(PICTURE)) if i < 3 or len({drawn[i] for drawn in pictures}) > 1]
    lines = []
    for drawn in pictures:
        # upsamplings that come to the same share a line
        alike: dict[tuple[str, ...], list[str]] = {}
        for upsample in _upsamplings(rows):
            cells = tuple(cell(found.get((drawn, upsample, spacing))) for spacing in spacings)
            alike.setdefault(cells, []).append(upsample)
        lines += [[*(drawn[i] for i in told), _listed(names, rows), *cells] for cells, names in alike.items()]
    headings = [*(PICTURE[i] for i in told), "upsampling", *(f"N = {spacing}" for spacing in spacings)]
    return gaps.table(headings, lines)


def _winners(rows: Sequence[Row], spacings: Sequence[int]) -> str:
    upsamplings, gaps, lines = _upsamplings(rows), Gaps(), []
    for region in REGIONS:
        for spacing in spacings:
            pictures = _side_by_side(rows, f"{region}.rel_95", spacing)
            why = "" if pictures else gaps.because(NO_PICTURE)
            lines.append([region, str(spacing), *(why or _standing(one, pictures) for one in upsamplings)])
    return gaps.table(["region", "N", *upsamplings], lines)


def _by_scene(rows: Sequence[Row], spacings: Sequence[int]) -> str:
    gaps, lines = Gaps(), []
    for scene in values_of(rows, "scene"):
        mine = [row for row in rows if row["scene"] == scene]
        cells = []
        for spacing in spacings:
            pictures = _side_by_side(mine, "edge.rel_95", spacing)
            if not pictures:
                cells.append(gaps.because(NO_PICTURE))
                continue
            means = {name: _mean([errors[name] for errors in pictures]) for name in _upsamplings(rows)}
            best, worst = min(means.values()), max(means.values())
            names = [name for name, error in means.items() if error <= (1 + TIE) * best]
            cells.append(_listed(names, rows) + (f"; {best / worst:.3g}" if worst > 0 else ""))
        lines.append([scene, *cells])
    headings = ["scene", *(f"N = {spacing}" for spacing in spacings)]
    return gaps.table(headings, lines)


def _side_by_side(rows: Sequence[Row], column: str, spacing: int) -> list[dict[str, float]]:
    """The errors of each picture by upsampling, of the pictures in which every upsampling has one."""
    pictures: dict[tuple[str, ...], dict[str, float]] = {}
    for row in rows:
        if row["downsample"] == spacing and row.get(column) is not None:
            pictures.setdefault(picture(row), {})[row["upsample"]] = row[column]
    return [errors for errors in pictures.values() if len(errors) == len(_upsamplings(rows))]


def _standing(upsample: str, pictures: Sequence[dict[str, float]]) -> str:
    """How often an upsampling is best, and how it compares."""
    best = sum(errors[upsample] <= (1 + TIE) * min(errors.values()) for errors in pictures)
    mine, plain = (_mean([errors[name] for errors in pictures]) for name in (upsample, "bilinear"))
    return f"{best} of {len(pictures)}" + (f"; {mine / plain:.3g}" if plain > 0 else "")


def _mean(errors: Sequence[float]) -> float:
    """Geometric mean; 0 where one of them is."""
    return float(np.exp(np.mean(np.log(errors)))) if min(errors) > 0 else 0.0


def _growth(rows: Sequence[Row], spacings: Sequence[int]) -> str:
    gaps, lines = Gaps(), []
    for technique in dict.fromkeys(picture(row)[2] for row in rows):
        for region in REGIONS:
            for upsample in _upsamplings(rows):
                mine = [row for row in rows if (picture(row)[2], row["upsample"]) == (technique, upsample)]
                behind_one = [row for row in mine if row["downsample"] in spacings]
                cells = [_exponent(behind_one, f"{region}.{part}", gaps) for part in ("rel_50", "rel_95", "bias")]
                lines.append([technique, region, upsample, *cells])
    table = gaps.table(["technique", "region", "upsampling", "median", "95 %", "bias"], lines)
    listed = ", ".join(map(str, spacings))
    return GROWTH.format(spacings=listed, confidence=CONFIDENCE, fewest=FEWEST_POINTS, table=table)


def _exponent(rows: Sequence[Row], column: str, gaps: Gaps) -> str:
    points = [
        (row["downsample"], row[column], row["scene"], picture(row)) for row in rows if (row.get(column) or 0) > 0
    ]
    if not points:
        return gaps.because("no error above zero")
    try:
        return str(mean_power_law(*zip(*points, strict=True)))
    except ValueError as error:
        return gaps.because(f"no exponent: {error}")


def _listed(names: Sequence[str], rows: Sequence[Row]) -> str:
    """Some upsamplings, in few words."""
    return "all" if len(names) == len(_upsamplings(rows)) > 1 else ", ".join(names)


def _percent(error: float) -> str:
    """Three digits; errors of dark pixels may be many times their light."""
    return f"{100 * error:.3g}%" if error < 10 else f"{100 * error:,.0f}%"


def _upsamplings(rows: Sequence[Row]) -> list[str]:
    """Those that are there, in the registry's order."""
    return [name for name in UPSAMPLINGS if any(row["upsample"] == name for row in rows)]


STUDY = Study("What downsampling costs in accuracy", plots, text)
