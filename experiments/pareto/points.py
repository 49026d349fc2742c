"""Points of a run's table: what each case errs by and what it costs, scene by scene and over all scenes."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from experiments.pareto.front import Point
from experiments.studies.cells import Row, label


@dataclass(frozen=True)
class Measure:
    """One way to say how large an error is.

    Attributes
    ----------
    column : str     of the run's table
    short : str      for headings
    what : str       for axes and text
    shown : callable how a number is shown
    """

    column: str
    short: str
    what: str
    shown: Callable[[float], str]


BIAS = Measure(
    "same_surface.bias",
    "bias",
    "root mean square error of the airlight [radiance], the variance of a sampled reference taken off",
    "{:.3g}".format,
)
PERCENTILE_95 = Measure(
    "same_surface.rel_95",
    "95 %",
    "95th percentile of the airlight's relative error",
    lambda error: f"{100 * error:.3g} %",
)
MEASURES = (BIAS, PERCENTILE_95)
INTERVAL = ("timing.ratio_low", "timing.ratio_50", "timing.ratio_high")
# parameters that the name of a phase function has in it
PHASE_KEYS = ("phase", "g", "k", "values")
# the cell that the project itself puts forward
OURS = ("exact", "quadrature")
# what the means over the scenes are called
ALL = "all scenes"


@dataclass(frozen=True)
class Scene:
    """All cases that can be compared with each other, and the points of those that have all numbers.

    Attributes
    ----------
    name : str
    rows : tuple of Row        that were drawn, errors and costs known
    costs : tuple of (low, cost, high)    of each of them [ms]
    lacking : tuple of Row     the others
    """

    name: str
    rows: tuple[Row, ...]
    costs: tuple[tuple[float, float, float], ...]
    lacking: tuple[Row, ...]

    def points(self, measure: Measure) -> list[Point]:
        """A point for each of `rows`."""
        return [
            Point(label(row), row[measure.column], cost, low, high)
            for row, (low, cost, high) in zip(self.rows, self.costs, strict=True)
        ]


def is_ours(row: Row) -> bool:
    """Whether a row is the project's own cell, on whatever lattice."""
    return (row["visibility"], row["airlight_model"]) == OURS


def scenes_of(rows: Sequence[Row]) -> list[Scene]:
    """Rows by scene, and by whatever else changes what is drawn: phase function, size, camera, triangles, parameters.

    Each case was timed in rounds with the baseline, and rounds of two cases lie minutes apart. So what is compared is
    the ratio to the baseline of the same rounds; the baseline's median over all of the scene's cases makes
    milliseconds of it again.
    """
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row in rows:
        groups.setdefault(_drawn(row), []).append(row)
    return [_scene(_name(key, groups), mine) for key, mine in groups.items()]


def _drawn(row: Row) -> tuple[str, ...]:
    """What a row is a picture of, in words, the scene's name first."""
    fog = {key: value for key, value in json.loads(row.get("parameters") or "{}").items() if key not in PHASE_KEYS}
    return (
        row["scene"],
        row["phase"],
        f"{row['width']} x {row['height']}",
        row["camera"],
        f"{row['triangles']} triangles" if row.get("triangles") else "",
        ", ".join(f"{key} {value}" for key, value in fog.items()),
    )


def _name(key: tuple[str, ...], keys: Iterable[tuple[str, ...]]) -> str:
    """The scene, and of the rest what is not the same in all of its pictures."""
    namesakes = [other for other in keys if other[0] == key[0]]
    told = [word for place, word in enumerate(key) if place == 0 or len({other[place] for other in namesakes}) > 1]
    return ", ".join(filter(None, told))


def _scene(name: str, rows: Sequence[Row]) -> Scene:
    known = [row for row in rows if not lacks(row)]
    clock = float(np.median([row["timing.baseline_ms_50"] for row in known])) if known else 0.0
    costs = tuple((row[INTERVAL[0]] * clock, row[INTERVAL[1]] * clock, row[INTERVAL[2]] * clock) for row in known)
    return Scene(name, tuple(known), costs, tuple(row for row in rows if lacks(row)))


def lacks(row: Row) -> str:
    """Why a row has no point; empty where it has one."""
    if row["status"] != "done":
        return f"{row['status']}: {row['reason']}"
    for measure in MEASURES:
        if row.get(measure.column) is None:
            return f"the run did not measure {measure.column}"
    if row.get("timing.ms_50") is None:
        return "the run did not time it"
    if any(row.get(column) is None for column in INTERVAL):
        return f"its time has no interval: {row.get('timing.no_interval') or 'the run does not say why'}"
    return ""


def over_all(scenes: Sequence[Scene], measure: Measure) -> list[Point]:
    """Geometric means, over the scenes, of the techniques that have a point in each of them.

    The ends of an interval are the means of the scenes' ends, which encloses the mean more surely than each encloses
    its own. Errors are those of `positive`.
    """
    found: dict[str, list[Point]] = {}
    for scene in scenes:
        for point in positive(scene.points(measure)):
            found.setdefault(point.name, []).append(point)
    return [
        Point(
            name,
            geometric_mean(one.error for one in points),
            geometric_mean(one.cost for one in points),
            geometric_mean(one.low for one in points),
            geometric_mean(one.high for one in points),
        )
        for name, points in found.items()
        if len(points) == len(scenes)
    ]


def positive(points: Sequence[Point]) -> list[Point]:
    """The same with half of the least other error in place of 0, of which no geometric mean is to be had."""
    least = min((point.error for point in points if point.error > 0), default=0.0)
    return [replace(point, error=point.error or 0.5 * least) for point in points]


def geometric_mean(values: Iterable[float]) -> float:
    """Of numbers that are 0 or more."""
    found = np.array(list(values))
    return float(np.exp(np.mean(np.log(found)))) if (found > 0).all() else 0.0
