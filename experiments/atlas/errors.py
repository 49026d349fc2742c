"""Relative errors of the models over the grid, and what is said of them: maps and a row of the table."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic import MODELS
from analytic.models import AirlightModel
from analytic.phase import Phase
from analytic.segments import Segments
from experiments.atlas.grid import Grid

__all__ = ["PRECISIONS", "TRUTH", "Case", "ErrorMap", "make_case", "map_errors", "percentile", "phase_label"]

PRECISIONS = ("float64", "float32")
# of analytic.MODELS, in float64 on the very inputs that the model got
TRUTH = "quadrature"
# the table's columns: share of segments off by more than this
LIMITS = {"off_by_1e-2": 1e-2, "off_by_1e-3": 1e-3, "off_by_1e-9": 1e-9}
PERCENTILES = {"median": 50, "percentile_95": 95, "worst": 100}


@dataclass(frozen=True, eq=False)
class Case:
    """What every model is asked for one phase function in one precision, and the answer.

    Attributes
    ----------
    grid : Grid
    phase : Phase
    precision : str               "float64" or "float32"
    segments : Segments, (n,)     the grid's, rounded to that precision
    truth : ndarray, (n,)         L / (I sigma_s) of the rounded segments, in float64
    expressible : ndarray, (n,)   where the truth is not below the smallest normal number of the precision
    """

    grid: Grid
    phase: Phase
    precision: str
    segments: Segments
    truth: NDArray[np.floating]
    expressible: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class ErrorMap:
    """Errors of one model in one case.

    Attributes
    ----------
    model, phase, precision : str
    percentile_95, worst : ndarray, (m, m)  over the positions of each cell (H, T): of the visible segments, or of all
        where none is; NaN where no segment is expressible
    rows : list of dict  two rows of the table: over the visible segments, and over all
    """

    model: str
    phase: str
    precision: str
    percentile_95: NDArray[np.float64]
    worst: NDArray[np.float64]
    rows: list[dict[str, Any]]


def phase_label(phase: Phase) -> str:
    """Name of a phase function with its parameter, as in tables and names of files: "hg_0.6"."""
    return f"{phase.name}_{phase.g:g}" if hasattr(phase, "g") else phase.name


def make_case(grid: Grid, phase: Phase, precision: str) -> Case:
    """Round the segments and integrate what became of them."""
    segments = grid.segments.astype(precision)
    truth = MODELS[TRUTH].function(segments.astype(np.float64), phase)
    return Case(grid, phase, precision, segments, truth, truth >= np.finfo(precision).tiny)


def map_errors(model: AirlightModel, case: Case) -> ErrorMap:
    """Run a model on a case.

    Raises
    ------
    ValueError
        If the model answers in another floating-point type than it was asked in.
    """
    with np.errstate(all="ignore"):
        value = model.function(case.segments, case.phase)
    if value.dtype != np.dtype(case.precision):
        raise ValueError(f"{model.name} answers {case.precision} segments in {value.dtype}")
    error = relative_error(value, case.truth)
    visible, expressible = case.grid.visible, case.expressible
    names = {"model": model.name, "phase": phase_label(case.phase), "precision": case.precision}
    rows = [
        {**names, "segments": what, **summary(error[counted])}
        for what, counted in (("visible", visible & expressible), ("all", expressible))
    ]

    shape = case.grid.shape
    seen = visible.reshape(shape)
    counted = (seen | ~seen.any(axis=2, keepdims=True)) & expressible.reshape(shape)
    percentile_95, worst = (percentile(error.reshape(shape), counted, percent) for percent in (95, 100))
    return ErrorMap(percentile_95=percentile_95, worst=worst, rows=rows, **names)


def relative_error(value: NDArray[np.floating], truth: NDArray[np.floating]) -> NDArray[np.float64]:
    """|value - truth| / truth, (n,); what is not finite is infinitely wrong."""
    with np.errstate(invalid="ignore"):
        return np.where(np.isfinite(value), np.abs(value.astype(np.float64) - truth) / truth, np.inf)


def summary(error: NDArray[np.float64]) -> dict[str, Any]:
    """What the table says of a set of errors, (n,)."""
    shares = {name: float(np.mean(error > limit)) for name, limit in LIMITS.items()}
    everything = np.ones_like(error, dtype=bool)
    ranks = {name: float(percentile(error, everything, percent)) for name, percent in PERCENTILES.items()}
    return {"count": error.size, **shares, **ranks, "not_finite": float(np.mean(np.isinf(error)))}


def percentile(error: NDArray[np.float64], counted: NDArray[np.bool_], percent: int) -> NDArray[np.float64]:
    """The smallest error that at least `percent` % of the counted ones of the last axis do not exceed.

    Nearest rank: nothing is interpolated, for between a finite error and an infinite one there is nothing.

    Parameters
    ----------
    error : ndarray, (..., n)    may be inf
    counted : ndarray, (..., n)  which to look at
    percent : int                1 to 100

    Returns
    -------
    ndarray, (...)  NaN where nothing counts
    """
    ordered = np.sort(np.where(counted, error, np.nan), axis=-1)  # NaN comes last
    count = np.count_nonzero(counted, axis=-1)
    rank = np.maximum(-(-count * percent // 100), 1)
    return np.take_along_axis(ordered, np.asarray(rank)[..., None] - 1, axis=-1)[..., 0]
