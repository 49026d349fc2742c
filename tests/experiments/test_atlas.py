"""The atlas end to end on a small grid, with models whose errors are known."""

from __future__ import annotations

import numpy as np
import polars
import pytest
from matplotlib.image import imread

from analytic import MODELS, phase
from analytic.models import AirlightModel
from experiments.atlas import atlas
from experiments.atlas.errors import PRECISIONS, make_case, map_errors, percentile
from experiments.atlas.figures import draw_figure
from experiments.atlas.grid import VISIBLE_DEPTH, make_grid
from experiments.atlas.timing import time_models

CELLS = 6


def toy(name, factor, phases=()):
    """The truth times what `factor` says of the segments."""

    def function(segments, function):
        truth = MODELS["quadrature"].function(segments.astype(np.float64), function)
        return (truth * factor(segments)).astype(segments.h.dtype)

    return AirlightModel(name, function, citation="", domain="", cost="", phases=phases)


BROKEN = toy("broken", lambda segments: 1.01)
HOLES = toy("holes", lambda segments: np.where(np.arange(len(segments)) % 2, 1.0, np.nan), ("isotropic",))
FINE = toy("fine", lambda segments: 1 + 1e-6 * (segments.h.dtype == np.float32))
TOYS = {model.name: model for model in (BROKEN, HOLES, FINE)}


@pytest.fixture(scope="module")
def grid():
    return make_grid(CELLS)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """An atlas of five models."""
    made = tmp_path_factory.mktemp("atlas") / "new"
    with pytest.MonkeyPatch.context() as patch:
        kept = {name: MODELS[name] for name in ("quadrature", "riemann")}
        patch.setattr(atlas, "MODELS", kept | TOYS)
        patch.setattr(atlas, "worst_of_truth", lambda grid, function: 1.5e-15)  # tests/experiments/test_atlas_truth.py
        atlas.write_atlas(made, cells=CELLS, timed=50)
    return made


def rows(folder, table, **wanted):
    """Rows of a CSV file that have these values."""
    found = polars.read_csv(folder / f"{table}.csv")
    return found.filter(*(polars.col(name) == value for name, value in wanted.items())).to_dicts()


def test_every_cell_has_the_eye_before_around_and_behind(grid):
    s = grid.segments
    assert np.allclose(s.sigma_t * s.h, np.repeat(grid.optical_h, len(s) // CELLS), rtol=1e-15)
    length = (s.sigma_t * s.length).reshape(grid.shape)
    assert np.allclose(length, grid.optical_length[None, :, None], rtol=1e-15)
    x_a, x_b = s.x_a.reshape(grid.shape), s.x_b.reshape(grid.shape)
    for where in (x_b < 0, (x_a < 0) & (x_b > 0), x_a > 0):
        assert where.any(axis=2).mean() > 0.8  # the longest segments reach the projection from anywhere before it
    assert ((x_a < 0) & (x_b > 0)).any(axis=2).all()
    depth = np.sqrt(grid.optical_h[:, None, None] ** 2 + (s.sigma_t * s.x_a).reshape(grid.shape) ** 2)
    assert np.array_equal(grid.visible.reshape(grid.shape), depth <= VISIBLE_DEPTH)
    assert grid.optical_h[[0, -1]] == pytest.approx([1e-4, 50])


def test_percentile_is_the_nearest_rank_of_what_counts():
    error = np.arange(1.0, 41.0)[::-1]
    counted = np.ones(40, dtype=bool)
    assert [percentile(error, counted, percent) for percent in (1, 50, 95, 96, 100)] == [1, 20, 38, 39, 40]
    assert percentile(error, error <= 20, 95) == 19
    assert np.isnan(percentile(error, error > 99, 95))
    error[error > 37] = np.inf
    assert percentile(error, counted, 92) == 37
    assert np.isinf(percentile(error, counted, 95))


@pytest.mark.parametrize("precision", PRECISIONS)
def test_a_model_wrong_by_one_percent_shows_it_in_every_cell(grid, precision):
    drawn = map_errors(BROKEN, make_case(grid, phase("hg", g=0.6), precision))
    rounding = np.finfo(precision).eps
    for cells in (drawn.percentile_95, drawn.worst):
        assert cells.shape == (CELLS, CELLS)
        assert np.all(np.abs(cells - 0.01) < 2 * rounding)  # measured: 1e-16 and 6e-8
    assert all(abs(row["median"] - 0.01) < rounding for row in drawn.rows)


def test_maps_count_visible_segments_where_there_are_any(grid):
    """A model that is wrong where the light is invisible only."""
    invisible = toy("invisible", lambda segments: np.where(grid.visible, 1.0, 2.0))
    drawn = map_errors(invisible, make_case(grid, phase("isotropic"), "float64"))
    beyond = grid.optical_h > VISIBLE_DEPTH
    assert 0 < beyond.sum() < CELLS
    assert np.all(drawn.worst[beyond] == 1)
    assert np.all(drawn.worst[~beyond] == 0)
    assert [row["worst"] for row in drawn.rows] == [0, 1]


def test_the_error_is_not_that_of_the_rounded_inputs(grid):
    """The truth rounded to float32 is right to half an ulp, though the inputs were rounded too."""
    drawn = map_errors(toy("exact", lambda segments: 1.0), make_case(grid, phase("hg", g=0.9), "float32"))
    assert drawn.rows[1]["worst"] <= 2**-24  # measured: 5.96e-8


def test_a_model_that_widens_is_refused(grid):
    wide = AirlightModel("wide", lambda segments, phase: segments.h.astype(np.float64), "", "", "")
    with pytest.raises(ValueError, match="wide answers float32 segments in float64"):
        map_errors(wide, make_case(grid, phase("isotropic"), "float32"))


def test_tables_hold_the_known_errors(folder):
    for precision, rounding in (("float64", 1e-15), ("float32", 6e-8)):
        for segments in ("visible", "all"):
            (row,) = rows(folder, "errors", model="broken", phase="rayleigh", precision=precision, segments=segments)
            assert row["percentile_95"] == row["median"] == pytest.approx(0.01, abs=rounding)
            assert row["off_by_1e-3"] == row["off_by_1e-9"] == 1
            assert row["not_finite"] == 0
    (row,) = rows(folder, "errors", model="holes", phase="isotropic", precision="float64", segments="all")
    assert row["not_finite"] == row["off_by_1e-2"] == 0.5
    assert row["median"] == 0
    assert row["percentile_95"] == row["worst"] == np.inf
    assert not rows(folder, "errors", model="holes", phase="hg_0.9")
    assert not rows(folder, "errors", model="quadrature")


def test_cost_counts_the_march_and_the_truth(folder):
    found = rows(folder, "cost", model="riemann", phase="isotropic")
    assert [row["precision"] for row in found] == list(PRECISIONS)
    for row in found:
        # by hand: e^-, sqrt; h / (d + |x|), small / (1 + small), / d^2 a step, and the length divided once
        assert (row["exponentials"], row["square_roots"], row["divisions"]) == (64, 64, 64 * 3 + 1)
        assert row["ratio_median"] == row["ratio_lower_quartile"] == 1
    assert [row["precision"] for row in rows(folder, "cost", model="quadrature", phase="hg_0.6")] == ["float64"]


def test_maps_hold_every_cell(folder, grid):
    maps = polars.read_parquet(folder / "maps.parquet")
    of_broken = maps.filter(model="broken", phase="hg_0.9", precision="float64")
    assert of_broken.height == CELLS**2
    assert of_broken["percentile_95"].to_numpy() == pytest.approx(0.01)
    last = of_broken.row(-1, named=True)
    assert (last["H"], last["T"]) == (50, 50)
    second = of_broken.row(1, named=True)  # T runs fastest
    assert (second["H"], second["T"]) == pytest.approx((grid.optical_h[0], grid.optical_length[1]), rel=5e-3)


def test_figures_are_readable_and_small(folder):
    for label in ("isotropic", "rayleigh", "hg_0.6", "hg_0.9"):
        path = folder / f"{label}.png"
        assert imread(path).shape[1] == 1600
        assert path.stat().st_size < 1_000_000


def test_a_model_that_refuses_says_so_in_its_panel(grid):
    maps = {("broken", name): map_errors(BROKEN, make_case(grid, phase("rayleigh"), name)) for name in PRECISIONS}
    figure = draw_figure("toys", [BROKEN, HOLES], maps, grid)
    panels = {axes.get_title(loc="left"): [text.get_text() for text in axes.texts] for axes in figure.axes}
    assert panels["holes\n"] == ["takes only\nisotropic"]
    assert panels["broken\nfloat32"] == []
    drawn = next(axes for axes in figure.axes if axes.get_title(loc="left") == "broken\nfloat64").collections[0]
    assert np.asarray(drawn.get_array()) == pytest.approx(0.01)
    assert (drawn.norm.vmin, drawn.norm.vmax) == (1e-16, 1)


def test_the_page_sorts_models_by_their_numbers(folder):
    page = (folder / "README.md").read_text(encoding="utf-8")
    assert "airlight atlas --out results/atlas" in page
    assert "rayleigh 1.5e-15" in page
    findings = page.partition("(isotropic.png)")[2].partition("### rayleigh")[0].splitlines()
    (over,) = (line for line in findings if "float32, none of these" in line)
    assert "`holes`" in over
    assert "`broken`" in over
    (within,) = (line for line in findings if "float64, every segment within 1e-9" in line)
    assert within.endswith(": `fine`.")
    named = [line for line in findings if "`fine`" in line]
    assert len(named) == 2  # once a precision, where it first fits
    assert named[1].startswith("- float32, every segment within 1e-4")


def test_time_is_a_ratio_to_the_march_in_the_same_round(grid):
    model = MODELS["riemann"]
    thrice = AirlightModel("thrice", lambda s, p: model.function(s, p, steps=192), "", "", "")
    found = time_models([thrice, model], grid.segments, phase("isotropic"), rounds=3)
    assert [row["model"] for row in found] == ["thrice", "riemann"]
    assert all(row["ns_a_segment"] > 0 for row in found)
    assert found[0]["ratio_lower_quartile"] <= found[0]["ratio_median"] <= found[0]["ratio_upper_quartile"]
    assert found[1]["ratio_median"] == 1
