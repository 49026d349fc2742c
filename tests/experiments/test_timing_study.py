"""The study `timing` on tables whose ratios and whose growth are known."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from study_tables import Row, all_cells, cells, row, table

from experiments.measurements.timing import pass_column
from experiments.studies import find_study
from experiments.studies.timing import STUDY
from experiments.studies.timing_growth import AXES
from gpu_impl.timing import PASSES, WALL_CLOCK

BASELINE = "Nishita1987"


def timed(ms: float, ratio: float = 0.5, **columns: object) -> Row:
    """A case with its times; the fog takes half of a frame, everything else the other."""
    times = {
        "timing.ms_50": ms,
        "timing.ratio_50": ratio,
        "timing.ratio_low": ratio - 0.01,
        "timing.ratio_high": ratio + 0.01,
        **{pass_column(name): ms / 10 for name in PASSES},
        "timing.scattering_ms": ms / 2,
        "timing.rounds": 11,
        "timing.clock": WALL_CLOCK,
        "timing.load": 0.5,
        "timing.others": 0.02,
        "timing.baseline": BASELINE,
        "timing.baseline_refusal": None,
        "timing.no_interval": None,
        "counts.pieces": 3.0,
        "counts.triangles": 1000,
    }
    return row(**(times | columns))


def grid() -> list[Row]:
    """Two techniques and the baseline itself; a frame costs 8 ms + 32 ms / N, the fog 64 ms / N^2."""
    rows = []
    for scene, slower in (("sphere", 1.0), ("dragon", 3.0)):
        for n in (1, 2, 4, 8):
            columns = {"scene": scene, "downsample": n, "timing.scattering_ms": slower * 64.0 / n**2}
            rows.append(timed(slower * 40.0 / n, 0.995 if (scene, n) == ("dragon", 1) else 0.5, **columns))
            ratio = 1.2 if n < 8 else 1.005
            rows.append(timed(slower * 90.0, ratio, technique="lit_intervals+quadrature", **columns))
        rows.append(timed(slower * 80.0, 1.005, technique=BASELINE, scene=scene))
    return rows


def test_it_is_in_the_registry() -> None:
    assert find_study("timing") is STUDY


def test_the_grid_is_one_table_and_has_no_unexplained_cell() -> None:
    refused = row(phase="hg 0.6", status="refused", reason="It takes no hg.")
    no_ratio = {f"timing.ratio_{part}": None for part in ("50", "low", "high")} | {"timing.no_interval": "It refused."}
    few = {"timing.ratio_low": None, "timing.ratio_high": None, "timing.no_interval": "3 rounds, and it takes 6"}
    text = STUDY.text(
        table(
            [
                *grid(),
                refused,
                timed(7.0, phase="rayleigh") | no_ratio,
                timed(9.0, downsample=2, phase="rayleigh") | few,
            ]
        )
    )
    assert cells(text, "sphere", "isotropic", "Weng2010") == [
        "40 ms, 0.500 [0.490, 0.510]",
        "20 ms, 0.500 [0.490, 0.510]",
        "10 ms, 0.500 [0.490, 0.510]",
        "5 ms, 0.500 [0.490, 0.510]",
    ]
    # the baseline was not asked for with a lattice
    assert cells(text, "sphere", "isotropic", BASELINE)[1:] == ["– (1)"] * 3
    assert cells(text, "sphere", "hg 0.6", "Weng2010")[0] == "– (2)"
    assert cells(text, "sphere", "rayleigh", "Weng2010")[:2] == ["7 ms, – (3)", "9 ms, 0.500 – (4)"]
    assert "- (1) not among the cases of this run" in text
    assert "- (2) refused: It takes no hg." in text
    assert "- (3) no ratio: It refused." in text
    assert "- (4) no interval: 3 rounds, and it takes 6" in text
    assert "" not in all_cells(text)


def test_what_the_machine_was_and_what_equal_things_cost_is_said() -> None:
    text = " ".join(STUDY.text(table(grid())).split())
    assert "Drawn by made-up renderer; passes timed by wall clock around glFinish" in text
    assert "software rasteriser" in text
    assert "0.02 and 0.02 processors busy" in text
    assert "the load average before a case was 0.50" in text
    assert "2 cases are the baseline itself" in text
    # 1.005 - 0.01 to 1.005 + 0.01
    assert "Their ratios are 1.005, and 2 of 2 intervals hold 1." in text
    assert "7 of 16 cases are faster than the baseline by their interval, 6 are slower, 3 are not" in text
    assert "The least ratio is 0.500 [0.490, 0.510]: Weng2010 in sphere, isotropic, N = 1." in text
    assert "not quiet" not in text
    noisy = [*grid()[1:], grid()[0] | {"timing.others": 1.5}]
    assert "in 1 of 18 cases others kept more than 0.1 processors busy" in STUDY.text(table(noisy))
    hardware = [one | {"timing.clock": "GL_TIME_ELAPSED"} for one in grid()]
    assert "software" not in STUDY.text(table(hardware))


def test_growth_is_fitted_along_every_axis() -> None:
    rows = grid()
    rows += [
        timed(1e-3 * side**1.5, product="resolution", width=side, height=side)
        | {"timing.scattering_ms": 1e-4 * side**2}
        for side in (128, 256, 512, 1024)
    ]
    rows += [
        timed(4.0 * n**0.5, product="steps", steps=n) | {"timing.scattering_ms": 1.0 * n}
        for n in (16, 32, 64, 128, 256)
    ]
    for count in (5_000, 20_000, 80_000):
        # their sum is a power law, and none of them
        shared = {
            "timing.geometry_ms": 5.0,
            "timing.shadow_map_ms": 2e-3 * count - 6.0,
            "timing.shadow_polygons_ms": 1.0,
        }
        rows.append(timed(2.0, product="triangles") | shared | {"counts.triangles": count, "triangles": count})
    for pieces in (1.0, 1.7, 16.0):
        rows.append(timed(3.0 * pieces**0.25, product="intervals", scene="grating") | {"counts.pieces": pieces})
    # another scene costs something else, and has no growth of its own
    rows.append(timed(100.0, product="intervals", scene="wire_mesh") | {"counts.pieces": 4.0})
    text = STUDY.text(table(rows))
    pixels, steps, triangles = (f"1.00 [1.00, 1.00] (1 scene, n = {n})" for n in (4, 5, 3))
    assert cells(text, "pixels of the image", "Weng2010") == [
        "16,384 to 1,048,576",
        "0.75 [0.75, 0.75] (1 scene, n = 4)",
        pixels,
    ]
    assert cells(text, "spacing N of evaluated pixels", "Weng2010") == [
        "1 to 8",
        "-1.00 [-1.00, -1.00]; -1.00 to -1.00 (2 scenes, n = 8)",
        "-2.00 [-2.00, -2.00]; -2.00 to -2.00 (2 scenes, n = 8)",
    ]
    assert cells(text, "samples a ray", "Weng2010") == ["16 to 256", "0.50 [0.50, 0.50] (1 scene, n = 5)", steps]
    assert cells(text, "lit pieces a ray", "Weng2010")[:2] == ["1 to 16", "0.25 [0.25, 0.25] (1 scene, n = 3)"]
    assert cells(text, "triangles", "Weng2010") == [
        "5,000 to 80,000",
        "0.00 [0.00, 0.00] (1 scene, n = 3)",
        triangles,
    ]


def test_the_interval_of_growth_is_over_the_scenes() -> None:
    rows = [
        timed(n**slope, product="steps", steps=n, scene=scene, phase=phase)
        for scene, slope in (("sphere", 0.5), ("dragon", 1.0))
        for phase in ("isotropic", "rayleigh")
        for n in (16, 32, 64)
    ]
    text = STUDY.text(table(rows))
    # 0.75 -+ 12.7062 / 4, Student's with one degree of freedom
    assert cells(text, "samples a ray", "Weng2010")[1] == "0.75 [-2.43, 3.93]; 0.50 to 1.00 (2 scenes, n = 12)"
    assert "Student's t over the scenes' exponents" in " ".join(text.split())


def test_what_costs_more_is_not_taken_for_growth() -> None:
    """A phase function of ten times the cost, and a size of ten times it, each measured further along the axis."""
    rows = []
    for n, more in (
        (16, {}),
        (32, {}),
        (64, {}),
        (128, {"phase": "mie"}),
        (256, {"phase": "mie"}),
        (512, {"phase": "mie"}),
    ):
        rows.append(timed((10.0 if more else 1.0) * n**0.5, product="steps", steps=n) | more)
    for count, width in ((1, 64), (2, 64), (4, 64), (8, 128), (16, 128), (32, 128)):
        rows.append(
            timed((10.0 if width > 64 else 1.0) * count**0.5, product="triangles", width=width)
            | {"counts.triangles": count}
        )
    text = STUDY.text(table(rows))
    assert cells(text, "samples a ray", "Weng2010")[1] == "0.50 [0.50, 0.50] (1 scene, n = 6)"
    assert cells(text, "triangles", "Weng2010")[1] == "0.50 [0.50, 0.50] (1 scene, n = 6)"


def test_an_axis_that_is_missing_or_too_short_says_so() -> None:
    text = STUDY.text(table([*grid(), timed(3.0, product="steps", steps=16), timed(5.0, product="steps", steps=32)]))
    assert "no timed case of the product 'resolution'" in text
    assert "no exponent: x must have 3 values or more" in text
    assert "" not in all_cells(text)


def test_what_hardly_varies_has_no_exponent() -> None:
    rows = [timed(1.0 + n, product="intervals") | {"counts.pieces": 80.0 + n} for n in range(4)]
    text = STUDY.text(table(rows))
    assert cells(text, "lit pieces a ray", "Weng2010")[0] == "80 to 83"
    assert "no exponent: x must grow by a factor of 2 or more, not 1.04." in text


def test_a_run_in_which_nothing_was_timed_says_why() -> None:
    text = STUDY.text(table([row(status="refused", reason="No such light.")]))
    assert text.startswith("Nothing was timed.")
    assert "refused: No such light." in text
    assert not list(STUDY.plots(table([row(status="refused", reason="No such light.")])))


def test_the_figures_show_the_numbers() -> None:
    plots = {plot.name: plot for plot in STUDY.plots(table(grid()))}
    assert list(plots) == ["ratios", "passes", "growth"]
    assert all(isinstance(plot.figure, Figure) for plot in plots.values())
    # bars: 2 scenes, 4 spacings, 2 techniques, and the baseline twice at N = 1, a part for each pass
    parts = sum(len(panel.patches) for panel in plots["passes"].figure.axes)
    assert parts == (2 * 4 * 2 + 2) * len(PASSES)
    bar = plots["passes"].figure.axes[0].patches[: len(PASSES)]
    # one behind the other: five passes of 4 ms, and the fog's 64
    assert bar[-1].get_x() + bar[-1].get_width() == pytest.approx(64.0 + 5 * 4.0)
    assert bar[1].get_x() == pytest.approx(4.0)
    # only the grid varies anything
    top, below = plots["growth"].figure.axes
    weng = top.lines[0]
    np.testing.assert_allclose(weng.get_xdata(), [1, 2, 4, 8])
    # the median of the two scenes'
    np.testing.assert_allclose(weng.get_ydata(), 2 * 40.0 / np.array([1, 2, 4, 8]))
    np.testing.assert_allclose(below.lines[0].get_ydata(), 2 * 64.0 / np.array([1, 2, 4, 8]) ** 2)
    assert below.get_xlabel() == AXES[1].name
