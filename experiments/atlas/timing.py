"""Time a segment of every model, all in one run, as a multiple of the march's."""

from __future__ import annotations

import os
import platform
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic import MODELS
from analytic.models import AirlightModel
from analytic.phase import Phase
from analytic.segments import Segments
from experiments.atlas.errors import phase_label

__all__ = ["REFERENCE", "ROUNDS", "SEGMENTS", "processor", "time_models"]

REFERENCE = "riemann"  # of analytic.MODELS: 64 steps
ROUNDS = 9
SEGMENTS = 8192
SEED = 4


def time_models(
    models: list[AirlightModel], segments: Segments, phase: Phase, rounds: int = ROUNDS
) -> list[dict[str, Any]]:
    """Rounds in which every model runs once, in an order drawn anew; whatever slows the machine down meets them all.

    Parameters
    ----------
    models : of those that take the phase function
    segments : Segments, (n,)  in the type to compute in
    phase : Phase
    rounds : int

    Returns
    -------
    list of dict  a row a model: the median time [ns] a segment, and median and quartiles of the ratio to the march of
        the same round
    """
    runs = {model.name: model for model in [*models, MODELS[REFERENCE]]}
    seconds: dict[str, list[float]] = {name: [] for name in runs}
    random = np.random.default_rng(SEED)
    with np.errstate(all="ignore"):
        for model in runs.values():
            model.function(segments, phase)  # tables are made and memory is found before the clock runs
        for _ in range(rounds):
            for name in random.permutation(list(runs)):
                begin = perf_counter()
                runs[name].function(segments, phase)
                seconds[name].append(perf_counter() - begin)
    march = np.array(seconds[REFERENCE])
    names = {"phase": phase_label(phase), "precision": segments.h.dtype.name}
    return [
        {"model": model.name, **names, **_row(np.array(seconds[model.name]), march, len(segments))} for model in models
    ]


def _row(seconds: NDArray[np.float64], march: NDArray[np.float64], count: int) -> dict[str, float]:
    quartiles = np.quantile(seconds / march, (0.25, 0.5, 0.75))
    ratios = dict(zip(("ratio_lower_quartile", "ratio_median", "ratio_upper_quartile"), quartiles, strict=True))
    return {"ns_a_segment": float(np.median(seconds)) / count * 1e9, **{name: float(x) for name, x in ratios.items()}}


def processor() -> str:
    """Name of the processor and how many of its logical cores this process may use."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return f"{_processor_name()}, {cores} logical cores"


def _processor_name() -> str:
    described = Path("/proc/cpuinfo")  # Linux; platform knows the architecture alone there
    lines = described.read_text().splitlines() if described.is_file() else []
    named = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(named, platform.processor() or platform.machine())
