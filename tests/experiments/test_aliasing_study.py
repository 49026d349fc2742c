"""The study `aliasing` on tables whose answers are known."""

from __future__ import annotations

import re
from dataclasses import replace
from io import BytesIO
from types import SimpleNamespace

import numpy as np
import polars
import pytest

from experiments.measurements.banding import OCTAVES
from experiments.studies import find_study
from experiments.studies.aliasing.convergence import order, order_of
from experiments.studies.marching_strip import TECHNIQUES, figure_1_2
from gpu_impl.techniques import SETTINGS, find_technique

STEPS = (8, 16, 32, 64, 128)
REGULAR, JITTERED, LIT = "Nishita1987", "uniform_march:jittered+riemann", "Weng2010"
# an error's 95th percentile at 64 steps, and how it falls
ERRORS = {REGULAR: (0.08, 1.0), JITTERED: (0.16, 1.0), LIT: (0.02, 2.0)}


def row(product: str, technique: str, phase: str = "isotropic", scene: str = "ball", **more) -> dict:
    drawn = replace(find_technique(technique), steps=more.pop("steps", 64), downsample=more.pop("downsample", 1))
    error, order = ERRORS[technique]
    error *= (64 / drawn.steps) ** order * drawn.downsample
    coarse = 0.5 if technique == REGULAR else 0.05
    return {
        **{
            "product": product,
            "status": "done",
            "reason": "",
            "scene": scene,
            "phase": phase,
            "camera": "",
            "frames": 1,
        },
        **{"width": 64, "height": 48, "rel_error": "1e-6", "technique": technique},
        **{"visibility": drawn.visibility, "airlight_model": drawn.airlight},
        **{name: getattr(drawn, name) for name in SETTINGS},
        **{"scattering.rel_95": error, "scattering.rel_50": error / 10, "scattering.bias": error / 100},
        **{
            "banding.rms": error,
            "banding.along": 0.6 * error * coarse**0.5,
            "banding.across": 0.8 * error * coarse**0.5,
        },
        **{"banding.coarse_share": coarse, "banding.period": 12.0},
        **{f"banding.{way}_{octave}px": error / octave for way in ("along", "across") for octave in OCTAVES},
        **{
            "flicker.rms": None,
            "flicker.high": None,
            "flicker.moved": None,
            "flicker.frames": None,
            "flicker.degrees": None,
        },
    } | more


def refused(made: dict) -> dict:
    measured = ("scattering.", "banding.", "flicker.")
    empty = {name: None for name in made if name.startswith(measured)}
    return made | empty | {"status": "refused", "reason": "it takes no such phase function", "rel_error": None}


def table() -> polars.DataFrame:
    rows = []
    for technique in ERRORS:
        for phase in ("isotropic", "hg 0.6"):
            mine = [row("steps", technique, phase, steps=steps) for steps in STEPS]
            mine += [row("grid", technique, phase, downsample=spacing) for spacing in (1, 2, 4, 8)]
            rows += [refused(one) for one in mine] if (technique, phase) == (LIT, "hg 0.6") else mine
        flicker = {"flicker.high": ERRORS[technique][0] / 4, "flicker.rms": 0.5, "flicker.moved": 0.11}
        rows.append(row("path", technique, frames=5, **flicker, **{"flicker.frames": 5, "flicker.degrees": 0.25}))
    return polars.DataFrame(rows, infer_schema_length=None)


def lines_of(text: str, heading: str) -> list[list[str]]:
    """Cells of the table below a heading, without its two first lines."""
    part = text.split(f"## {heading}")[1].split("\n## ")[0]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in part.splitlines() if line[:1] == "|"][2:]


STUDY = find_study("aliasing")
TEXT = STUDY.text(table())


def test_the_order_of_exact_powers() -> None:
    fitted = order_of((steps, 3 * steps**-1.5) for steps in STEPS)
    assert fitted.points == tuple((steps, 3 * steps**-1.5) for steps in STEPS)
    assert str(fitted) == "1.50 [1.50, 1.50] (8 to 128; 1.50 to 1.50)"


@pytest.mark.parametrize(
    ("errors", "used"),
    [
        ((1.0, 1.0, 0.5, 0.25, 0.125), "(16 to 128; 1.00 to 1.00)"),
        ((0.8, 0.4, 0.2, 0.19, 0.19), "(8 to 32; 1.00 to 1.00)"),
        ((0.8, 0.4, 0.2, 0.1, 0.005), "(8 to 64; 1.00 to 1.00)"),
        # the longer of two stretches
        ((0.8, 0.4, 0.41, 0.2, 0.1), "(32 to 128; 1.0"),
        # what is lost in noise ends a stretch, although the error falls on behind it
        ((0.16, 0.01, 0.16, 0.08, 0.04), "(32 to 128; 1.00 to 1.00)"),
        ((0.01, 0.08, 0.04, 0.02, 0.009), "(16 to 64; 1.00 to 1.00)"),
    ],
    ids=["saturated", "floor", "the reference's noise", "bump", "noise within", "noise at both ends"],
)
def test_points_that_do_not_follow_the_law_are_left_out(errors: tuple[float, ...], used: str) -> None:
    found = order_of(zip(STEPS, errors, strict=True), least=0.01)
    assert str(found).startswith("1.0")
    assert used in str(found)


def test_noise_within_a_fall_breaks_the_stretch() -> None:
    """A point in the noise between two that fall: the two do not count as neighbours."""
    points = [(8, 0.8), (16, 0.4), (32, 0.001), (64, 0.1), (128, 0.05)]
    assert str(order_of(points, least=0.01)) == "falls over 2 points only"


def test_points_that_bend_show_it_in_their_slopes() -> None:
    found = order_of((steps, 1 / steps + 0.01) for steps in STEPS)
    assert str(found).endswith("(8 to 128; 0.52 to 0.90)")


@pytest.mark.parametrize(
    ("exponent", "scatter", "least"),
    # measured of 4,000 ladders: 0.950, 0.932, 0.956, 0.905
    [(1.0, 0.02, 0.93), (0.5, 0.1, 0.91), (2.0, 0.2, 0.93), (0.5, 0.2, 0.88)],
)
def test_intervals_hold_the_order(exponent: float, scatter: float, least: float) -> None:
    errors = np.exp(scatter * np.random.default_rng(3).standard_normal((1000, len(STEPS))))
    fits = [order_of((n, e * n**-exponent) for n, e in zip(STEPS, ladder, strict=True)).fit for ladder in errors]
    fitted = [fit for fit in fits if fit]
    held = np.mean([fit.low <= -exponent <= fit.high for fit in fitted])
    assert len(fitted) > 900
    assert least < held < 0.97


def test_the_order_of_a_relative_error_knows_the_worst_reference() -> None:
    rows = [{"steps": n, "scattering.rel_95": 1 / n, "rel_error": "1e-6"} for n in STEPS]
    rows[0]["rel_error"] = "0.02"
    # half of 1/32 is below 0.02
    assert [n for n, _ in order(rows, "scattering.rel_95").points] == [8, 16]


def test_what_does_not_fall_has_no_order() -> None:
    assert str(order_of((steps, 0.3) for steps in STEPS)) == "does not fall"
    assert str(order_of((steps, 1e-3) for steps in STEPS)) == "does not fall"
    assert str(order_of([(8, 0.4), (16, 0.2), (32, 0.2)])) == "falls over 2 points only"
    assert str(order_of((steps, 1 / steps) for steps in STEPS[:3])).startswith("1.00")
    # less than twice as many steps are no law
    assert str(order_of((steps, 1 / steps) for steps in (10, 12, 14))) == "falls over 3 points only"
    assert str(order_of(((steps, 1e-3 / steps) for steps in STEPS), least=0.01)) == "does not fall"


def test_orders_of_the_table() -> None:
    found = {(phase, name): cells for _, phase, name, *cells in lines_of(TEXT, "Error against steps")}
    assert found["isotropic", REGULAR] == ["1.00 [1.00, 1.00] (8 to 128; 1.00 to 1.00)"] * 3
    assert found["isotropic", LIT][0] == "2.00 [2.00, 2.00] (8 to 128; 2.00 to 2.00)"
    assert found["hg 0.6", LIT] == ["– (1)"] * 3
    assert "- (1) refused: it takes no such phase function" in TEXT


def test_the_grid_has_no_empty_cell() -> None:
    lines = lines_of(TEXT, "Every cell of the grid")
    found = {(phase, name): cells for _, phase, name, *cells in lines}
    assert found["isotropic", REGULAR] == ["0.80 % / 8.0 %", "1.6 % / 16 %", "3.2 % / 32 %", "6.4 % / 64 %"]
    assert found["hg 0.6", LIT] == ["– (1)"] * 4
    assert len(lines) == 6
    # all rows share their steps, which are said once
    assert "bilateral upsampling; 64 samples a ray, shadow maps of 1024 texels on a side." in " ".join(TEXT.split())
    for heading in ("In short", "Error against steps", "Bands and grain", "Flicker", "Every cell of the grid"):
        assert all(all(line) for line in lines_of(TEXT, heading)), heading


def test_a_case_that_is_missing_or_failed_says_so() -> None:
    missing = table().filter(
        ~((polars.col("product") == "grid") & (polars.col("downsample") == 4)) | (polars.col("phase") != "isotropic")
    )
    text = STUDY.text(missing)
    assert "not among the cases of this run" in text
    failed = table().with_columns(
        status=polars.when(polars.col("downsample") == 8).then(polars.lit("failed")).otherwise("status"),
        reason=polars.when(polars.col("downsample") == 8).then(polars.lit("no disk")).otherwise("reason"),
    )
    assert "failed: no disk" in STUDY.text(failed)


def test_in_short_is_over_the_regular_march() -> None:
    found = {name: cells for name, *cells in lines_of(TEXT, "In short")}
    assert found[REGULAR][:5] == ["1"] * 5
    # twice the error, of which a twentieth and not a half is bands
    bands, grain = 2 * np.sqrt(0.05 / 0.5), 2 * np.sqrt(0.95 / 0.5)
    assert found[JITTERED] == ["2", "2", f"{bands:.3g}", f"{grain:.3g}", "2", "1.00; 1.00 to 1.00 (2 of 2)"]
    assert found[LIT][0] == "0.25"
    assert found[LIT][-1] == "2.00; 2.00 to 2.00 (1 of 1)"
    assert "not an interval of the median" in TEXT.replace("\n", " ")


def test_a_technique_without_a_ladder_says_so() -> None:
    text = STUDY.text(table().filter(~((polars.col("product") == "steps") & (polars.col("technique") == LIT))))
    found = {name: cells for name, *cells in lines_of(text, "In short")}
    assert found[LIT] == ["0.25", "0.25", *found[LIT][2:4], "0.25", "– (1)"]
    assert "(1) no order of convergence was found" in text


def test_bands_and_flicker() -> None:
    bands = {(phase, name): cells for _, phase, name, *cells in lines_of(TEXT, "Bands and grain")}
    assert bands["isotropic", REGULAR] == ["8.00%", "3.39%", "4.53%", "50.0%", "12.0"]
    flicker = {name: cells for _, _, name, *cells in lines_of(TEXT, "Flicker")}
    assert flicker[REGULAR] == ["50.00%", "2.00%", "11.00%"]
    assert "5 frames, 0.25 degrees apart" in TEXT


def test_intervals_say_what_they_are_of() -> None:
    introduction = " ".join(TEXT.split("## Error against steps")[1].split())
    assert "scatter about the line, if their errors are independent" in introduction
    assert "of 3 points it is wide" in introduction


def test_every_number_comes_from_the_table() -> None:
    """All errors ten times as large: the orders stay, and so do the ratios; the grid's numbers do not."""
    columns = [name for name in table().columns if name.startswith("scattering.")]
    text = STUDY.text(table().with_columns(polars.col(columns) * 10))
    assert lines_of(text, "Error against steps") == lines_of(TEXT, "Error against steps")
    assert lines_of(text, "In short") == lines_of(TEXT, "In short")
    assert lines_of(text, "Every cell of the grid")[0][3] == "8.0 % / 80 %"


def test_plots() -> None:
    plots = {plot.name: plot for plot in STUDY.plots(table())}
    assert list(plots) == ["convergence", "banding", "flicker", "grid"]
    for plot in plots.values():
        plot.figure.savefig(BytesIO(), format="png")
        assert plot.caption.endswith(".")
    ladder = plots["convergence"].figure.axes[0]
    drawn = [tuple(line.get_ydata()) for line in ladder.lines]
    assert tuple(0.08 * 64 / steps for steps in STEPS) in drawn
    assert ladder.get_yscale() == ladder.get_xscale() == "log"
    texts = [text.get_text() for panel in plots["grid"].figure.axes for text in panel.texts]
    # three techniques, two phase functions, four lattices; one technique refuses one phase function
    assert len(texts) == 24
    assert texts.count("×") == 4
    assert "64" in texts
    heights = [bar.get_height() for bar in plots["flicker"].figure.axes[0].patches]
    assert heights == pytest.approx([0.02, 0.04, 0.005])


def test_a_table_of_refusals_has_text_and_no_plots() -> None:
    nothing = polars.DataFrame([refused(row("grid", LIT)), refused(row("steps", LIT))], infer_schema_length=None)
    text = STUDY.text(nothing)
    assert "it takes no such phase function" in text
    assert "no case with a reference" in " ".join(text.split())
    assert not re.search(r"\bnan\b|\bNone\b", text + TEXT)
    assert list(STUDY.plots(nothing)) == []


def test_figure_1_2() -> None:
    truth = np.random.default_rng(0).random((12, 16, 3)) + 0.5
    reference = SimpleNamespace(scattering=truth, standard_error=lambda layer: np.zeros_like(truth))
    asked = []

    def draw(technique: str, *, steps: int) -> SimpleNamespace:
        asked.append((technique, steps))
        return SimpleNamespace(scattering=truth * (1 + 0.1 * len(asked)))

    figure, caption = figure_1_2(draw, reference, 24)
    assert asked == [(technique, 24) for technique in TECHNIQUES.values()]
    pictures = [axes.images[0].get_array() for axes in figure.axes if axes.images]
    # techniques and reference above, errors below
    assert len(pictures) == len(TECHNIQUES) + 1 + len(TECHNIQUES)
    for number, error in enumerate(pictures[-len(TECHNIQUES) :], start=1):
        np.testing.assert_allclose(error, 10 * number, rtol=1e-9)
    assert "median 10.00%" in caption
    assert "24 samples" in caption
