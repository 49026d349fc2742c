"""Makes the atlas: maps, tables, figures and the page that explains them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from analytic import MODELS, phase
from analytic.models import AirlightModel
from analytic.phase import Phase
from experiments.atlas.counting import count_operations
from experiments.atlas.errors import PRECISIONS, TRUTH, ErrorMap, make_case, map_errors, phase_label
from experiments.atlas.figures import write_figure
from experiments.atlas.grid import CELLS, Grid, make_grid
from experiments.atlas.page import TITLE, write_page
from experiments.atlas.timing import SEGMENTS, time_models
from experiments.atlas.truth import worst_of_truth
from experiments.pages import prepare_page
from scenes.replacing import replacing

if TYPE_CHECKING:
    from polars import DataFrame

__all__ = ["PHASES", "write_atlas"]

PHASES = (phase("isotropic"), phase("rayleigh"), phase("hg", g=0.6), phase("hg", g=0.9))
SEED = 12

Row = dict[str, Any]
Maps = dict[tuple[str, str], ErrorMap]  # of one phase function, by name of the model and precision


def write_atlas(
    folder: Path, report: Callable[[str], None] = lambda step: None, cells: int = CELLS, timed: int = SEGMENTS
) -> None:
    """Measure every model but the truth over the grid, and count and time all of them.

    Parameters
    ----------
    folder : where errors.csv, cost.csv, maps.parquet, a figure a phase function and README.md go
    report : told what begins
    cells : int  number of H, and of T
    timed : int  segments to take the time of, drawn from the grid

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    began = perf_counter()
    prepare_page(folder, TITLE)
    grid = make_grid(cells)
    errors: list[Row] = []
    costs: list[Row] = []
    truths: dict[str, float] = {}
    maps: dict[str, Maps] = {}
    for function in PHASES:
        label = phase_label(function)
        report(f"{label}: truth")
        truths[label] = worst_of_truth(grid, function)
        maps[label] = measure_errors(grid, function, report)
        errors += [row for drawn in maps[label].values() for row in drawn.rows]
        costs += measure_costs(grid, function, timed, report)
    write_tables(folder, grid, errors, costs, maps)
    mapped = [model for name, model in MODELS.items() if name != TRUTH]
    for label, drawn in maps.items():
        report(f"{label}: figure")
        title = (
            f"{label.replace('_', ' ')}: {len(grid.segments):,} segments, {grid.shape[2]} positions of the eye a cell"
        )
        write_figure(folder / f"{label}.png", title, mapped, drawn, grid)
    write_page(folder / "README.md", grid, errors, costs, truths, timed, perf_counter() - began)


def measure_errors(grid: Grid, function: Phase, report: Callable[[str], None] = lambda step: None) -> Maps:
    """Maps of every model that takes the phase function, in both precisions."""
    maps = {}
    for precision in PRECISIONS:
        case = make_case(grid, function, precision)
        for model in _serving(function):
            if model.name != TRUTH:
                report(f"{phase_label(function)}: errors of {model.name} in {precision}")
                maps[model.name, precision] = map_errors(model, case)
    return maps


def measure_costs(
    grid: Grid, function: Phase, timed: int, report: Callable[[str], None] = lambda step: None
) -> list[Row]:
    """Operations and time a segment of every model that takes the phase function; of the truth, in float64 alone."""
    some = np.random.default_rng(SEED).choice(len(grid.segments), min(timed, len(grid.segments)), replace=False)
    rows = []
    for precision in PRECISIONS:
        models = [model for model in _serving(function) if (model.name, precision) != (TRUTH, "float32")]
        report(f"{phase_label(function)}: cost in {precision}")
        segments = grid.segments.astype(precision)
        for row, model in zip(time_models(models, segments[some], function), models, strict=True):
            counted = count_operations(model, segments, function)
            rows.append({**{key: row.pop(key) for key in ("model", "phase", "precision")}, **counted, **row})
    return rows


def write_tables(folder: Path, grid: Grid, errors: list[Row], costs: list[Row], maps: dict[str, Maps]) -> None:
    """errors.csv, cost.csv, and the maps' numbers in maps.parquet."""
    import polars

    for name, rows in (("errors", errors), ("cost", costs)):
        with replacing(folder / f"{name}.csv") as beside:
            polars.DataFrame(rows).write_csv(beside, float_precision=3, float_scientific=name == "errors")
    with replacing(folder / "maps.parquet") as beside:
        cells = [_cells(grid, drawn) for of_one_phase in maps.values() for drawn in of_one_phase.values()]
        polars.concat(cells).write_parquet(beside, compression_level=22)


def _cells(grid: Grid, drawn: ErrorMap) -> DataFrame:
    """A row a cell, to the three digits that a reader can use."""
    import polars

    optical_h, optical_length = np.meshgrid(grid.optical_h, grid.optical_length, indexing="ij")
    numbers = {"H": optical_h, "T": optical_length, "percentile_95": drawn.percentile_95, "worst": drawn.worst}
    table = polars.DataFrame({name: values.ravel() for name, values in numbers.items()})
    names = {name: polars.lit(getattr(drawn, name), polars.Categorical) for name in ("model", "phase", "precision")}
    rounded = polars.all().round_sig_figs(3).cast(polars.Float32)
    return table.select(rounded).select(*(text.alias(name) for name, text in names.items()), polars.all())


def _serving(function: Phase) -> list[AirlightModel]:
    return [model for model in MODELS.values() if model.takes(function)]
