"""The gate's values, measured in this process."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from experiments.measurements import find_measurement
from experiments.measurements.shot import Shot
from experiments.renderers import open_renderer
from experiments.run.truth import Truth
from experiments.run.work import load_case
from experiments.suite import Case
from scenes.errors import InputError
from scenes.model import Scene

# what is gated of each case: the airlight's errors, how far its and the surfaces' sums are off, and what an eye sees
METRICS = (
    "scattering.rel_50",
    "scattering.rel_95",
    "scattering.image_mean_rel",
    "surface.image_mean_rel",
    "composite.flip",
)
# case to metric to value
Values = dict[str, dict[str, float]]


def measure_cases(cases: Sequence[Case], drawn: Callable[[Scene], Scene] = lambda scene: scene) -> Values:
    """Draw and measure cases; a picture with pixels that are not finite has no numbers.

    Parameters
    ----------
    drawn : what takes a scene's place for the techniques; references stay those of the scene itself

    Raises
    ------
    InputError
        A reference is missing, damaged or stale.
    """
    truth, values = Truth(), Values()
    by_view: dict[tuple[object, ...], list[Case]] = {}
    for case in cases:
        by_view.setdefault(case.view, []).append(case)
    for alike in by_view.values():
        scene = load_case(alike[0])
        with open_renderer(drawn(scene)) as renderer:
            for case in alike:
                values[case.name] = _values(Shot(case, scene, renderer, truth))
    return values


def _values(shot: Shot) -> dict[str, float]:
    # first, so that what is wrong with a reference is said and not taken for a picture's fault
    _ = shot.reference
    try:
        _ = shot.frame
    except InputError:
        return dict.fromkeys(METRICS, math.nan)
    return gated(find_measurement("errors").measure(shot))


def gated(row: Mapping[str, Any]) -> dict[str, float]:
    """The gated metrics of a row of results."""
    return {metric: float(row[metric]) for metric in METRICS}
