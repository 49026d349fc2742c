"""What the scattering pass does for a ray, and how much there is to draw: what costs are plotted against."""

from __future__ import annotations

import numpy as np

from experiments.measurements import Measurement, Value
from experiments.measurements.shot import Shot
from experiments.technique_benchmark.budget import triangle_count


def counts(shot: Shot) -> dict[str, Value]:
    """Count a picture's work.

    Returns
    -------
    dict
        `counts.pieces`, `counts.shadow_map_reads`, `counts.exponential_integrals`, `counts.exponentials`: means over
        the rays on which the fog is evaluated, all lights together, None where they are not counted
        (`Renderer.counts`); `counts.lit_intervals`,
        `counts.lit_intervals_max`: mean and most of the pieces that the visibility reports of a ray, before a spot's
        cone cuts them; `counts.rays`, `counts.triangles`.
    """
    work = shot.renderer.counts(shot.technique)
    intervals = shot.frame.lit_intervals
    return {
        **{f"counts.{name}": None if np.isnan(found).any() else float(found.mean()) for name, found in work.items()},
        "counts.lit_intervals": float(intervals.mean()),
        "counts.lit_intervals_max": float(intervals.max()),
        "counts.rays": work["pieces"].size,
        "counts.triangles": triangle_count(shot.scene),
    }


MEASUREMENT = Measurement(counts)
