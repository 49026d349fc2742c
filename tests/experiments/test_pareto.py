"""The study `pareto` on tables whose fronts are known: words, lattices, cases without numbers, figures, the command."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from study_tables import Row, all_cells, cells, row, table

from experiments.pareto.figure import OUR_MARK
from experiments.pareto.front import Standing
from experiments.pareto.lattices import served
from experiments.pareto.ours import verdict
from experiments.pareto.points import BIAS, PERCENTILE_95, over_all, scenes_of
from experiments.studies import find_study
from experiments.studies.pareto import STUDY
from gpu_impl.techniques import find_technique
from gpu_impl.timing import WALL_CLOCK

OURS = "exact+quadrature"
BASELINE_MS = 20.0


def case(technique: str, error: float, ms: float, reach: float = 0.05, **columns: Any) -> Row:
    """A case; its 95th percentile is ten times its bias, its interval a share of its cost."""
    found = find_technique(technique)
    ratio = ms / BASELINE_MS
    return row(
        technique,
        **{
            "visibility": found.visibility,
            "airlight_model": found.airlight,
            "same_surface.bias": error,
            "same_surface.rel_95": 10 * error,
            "same_surface.others": 5,
            "timing.ms_50": ms,
            "timing.baseline_ms_50": BASELINE_MS,
            "timing.ratio_50": ratio,
            "timing.ratio_low": ratio * (1 - reach),
            "timing.ratio_high": ratio * (1 + reach),
            "timing.no_interval": None,
            "timing.baseline": "Nishita1987, steps 16",
            "timing.rounds": 9,
            "timing.clock": WALL_CLOCK,
            "timing.others": 0.02,
            "timing.geometry_ms": 0.2 * ms,
            "timing.scattering_ms": 0.6 * ms,
            "rel_error": "0",
            "estimator": "deterministic 2",
        }
        | columns,
    )


def on_the_front() -> list[Row]:
    """Ours errs least and is dear; Wyman2008 is behind Weng2010, FrontFinal all but beside it."""
    return [
        case("Nishita1987", 0.1, 10.0),
        case("Weng2010", 0.01, 20.0),
        case("FrontFinal", 0.025, 20.5),
        case("Wyman2008", 0.02, 40.0),
        case(OURS, 0.001, 50.0),
        case(OURS, 0.004, 25.0, downsample=2),
        case(OURS, 0.03, 15.0, downsample=4),
        case(OURS, 0.02, 60.0, downsample=2, lattice="epipolar"),
    ]


def behind() -> list[Row]:
    """Another scene, in which Weng2010 beats ours in both."""
    return [
        case("Nishita1987", 0.1, 10.0, scene="dragon"),
        case("Weng2010", 0.001, 20.0, scene="dragon"),
        case(OURS, 0.004, 50.0, scene="dragon"),
    ]


def text_of(rows: Sequence[Row]) -> str:
    return STUDY.text(table(rows))


def flat(text: str) -> str:
    return " ".join(text.split())


def test_it_is_in_the_registry() -> None:
    assert find_study("pareto") is STUDY


def test_the_front_is_a_table_from_the_cheapest_on() -> None:
    text = text_of(on_the_front())
    names = [line.split("|")[3].strip() for line in text.splitlines() if line.startswith("| sphere | bias |")]
    assert names == [
        "Nishita1987",
        f"{OURS}, downsample 4",
        "Weng2010",
        f"{OURS}, downsample 2",
        OURS,
        "*not to be told apart: FrontFinal*",
    ]
    assert cells(text, "sphere", "bias", OURS) == ["0.001", "50 [47.5, 52.5]"]
    assert cells(text, "sphere", "95 %", OURS) == ["1 %", "50 [47.5, 52.5]"]
    # and every case stands there once with where it stands
    front, _, open_, behind = (str(one) for one in Standing)
    assert cells(text, "sphere", "Weng2010") == ["0.01", "10 %", "20 [19, 21]", front, front]
    assert cells(text, "sphere", "FrontFinal")[3:] == [open_, open_]
    assert "5 pixels of a picture are left out" in flat(text)
    assert cells(text, "sphere", "Wyman2008")[3:] == [behind, behind]


def test_the_words_where_ours_is_on_it() -> None:
    text = flat(text_of(on_the_front()))
    assert (
        "Ours is on the fronts of 1 of 1 by bias, 1 of them for sure; and of 1 of 1 by 95 %, 1 of them for sure."
        in text
    )
    assert (
        f"**sphere**, by bias: ours is on the front in 3 of 4 settings, 3 of them for sure ({OURS}; "
        f"{OURS}, downsample 2; {OURS}, downsample 4), and errs least of all." in text
    )
    better = [*on_the_front(), case("Weng2010", 0.0005, 90.0, steps=512)]
    assert "; Weng2010, steps 512 errs least of all." in flat(text_of(better))


def test_the_words_where_ours_is_on_it_by_the_median_alone() -> None:
    # 19 to 21 ms beside 19.4 to 21.5
    rows = [*behind()[:2], case(OURS, 0.0009, 20.4, scene="dragon"), case(OURS, 0.0005, 90.0, scene="dragon", steps=99)]
    rows[1] |= {"same_surface.bias": 0.0009, "timing.ratio_50": 1.03}
    text = flat(text_of(rows))
    assert "Ours is on the fronts of 1 of 1 by bias, 1 of them for sure; and" in text
    assert f"in 2 of 2 settings, 1 of them for sure ({OURS}; {OURS}, steps 99), and errs least of all." in text
    assert cells(text_of(rows), "dragon", OURS)[3] == str(Standing.BY_MEDIAN)
    alone = flat(text_of(rows[:3]))
    assert "Ours is on the fronts of 1 of 1 by bias, 0 of them for sure; and" in alone
    assert f"1 settings, 0 of them for sure ({OURS}); none errs less, and Weng2010 as little." in alone


def test_errors_of_0_are_told_in_words_that_hold() -> None:
    rows = [case("Weng2010", 0.0, 20.0), case("Wyman2008", 0.0, 20.0), case("Nishita1987", 0.1, 10.0)]
    text = flat(text_of([*rows, case(OURS, 0.0, 50.0)]))
    assert "errs as much in 0.4 of its time. It would be on the front with that error in less than 20 ms; of" in text
    assert "below 0" not in text
    assert "An error of 0 counts in means as half of the least other one of its scene." in text
    assert "An error of 0" not in flat(text_of(on_the_front()))
    # a small one is not shown as 0
    assert cells(text_of([*rows, case(OURS, 1e-8, 50.0)]), "sphere", OURS)[1] == "1e-05 %"


def test_the_nearest_of_ours_is_named() -> None:
    rows = [
        *behind(),
        case(OURS, 0.005, 25.0, scene="dragon", steps=99),
        case(OURS, 0.5, 70.0, scene="dragon", steps=9),
    ]
    assert f"**dragon**, by bias: ours is behind. The nearest is {OURS}, steps 99, with" in flat(text_of(rows))


def test_the_words_where_ours_is_not_on_it() -> None:
    text = flat(text_of(behind()))
    assert (
        "Ours is on the fronts of 0 of 1 by bias, 0 of them for sure; and of 0 of 1 by 95 %, 0 of them for sure."
        in text
    )
    assert (
        f"**dragon**, by bias: ours is behind. The nearest is {OURS}, with an error of 0.004 in 50 ms; Weng2010 errs "
        "0.25 of it in 0.4 of its time. It would be on the front with that error in less than 20 ms, or with an error "
        "below 0.001 in the same time; of its time 75% is the pass 'scattering', and 60% would have to go." in text
    )
    # the milliseconds that it names are enough
    moved = [*behind()[:2], case(OURS, 0.004, 19.99, scene="dragon")]
    assert "Ours is on the fronts of 1 of 1 by bias" in flat(text_of(moved))


def test_the_words_where_it_is_open() -> None:
    rows = [*behind()[:2], case(OURS, 0.004, 21.0, scene="dragon")]
    text = flat(text_of(rows))
    assert f"ours is not on the front, but {OURS} is not to be told apart from it: Weng2010 errs 0.25 of it" in text
    assert "in 0.952 of its time, and the interval of its own cost, 19.9 to 22.1 ms, reaches as low." in text


def test_nothing_is_said_of_ours_where_it_is_not_there() -> None:
    rows = on_the_front()[:4]
    assert "nothing is said of ours" in text_of(rows)
    assert "Its lattice" not in text_of(rows)
    assert verdict(scenes_of([])).startswith("No case of exact x quadrature")


def test_cases_without_numbers_are_told_and_are_on_no_front() -> None:
    unclocked = case("Chen2011", 1e-9, 0.1) | {"timing.ratio_low": None, "timing.no_interval": "3 rounds, and 6"}
    rows = [
        *on_the_front(),
        row("James2003", "refused", "It takes no such fog.", visibility="shadow_faces", airlight_model="depth_fog"),
        unclocked,
        case("Dobashi2002", 1e-9, 0.1) | {"same_surface.bias": None},
        case("Dobashi2002", 1e-9, 0.1, steps=8) | {"timing.ms_50": None},
    ]
    text = text_of(rows)
    assert cells(text, "sphere", "James2003") == ["– (1)"] * 5
    assert cells(text, "sphere", "Chen2011") == ["– (2)"] * 5
    for reason in (
        "- (1) refused: It takes no such fog.",
        "- (2) its time has no interval: 3 rounds, and 6",
        "- (3) the run did not measure same_surface.bias",
        "- (4) the run did not time it",
    ):
        assert reason in text
    without = text_of(on_the_front())
    assert text.split("## Every case")[0] == without.split("## Every case")[0]
    assert text_of(rows[-4:]).startswith("No case has an error and a cost.")
    assert not list(STUDY.plots(table(rows[-4:])))
    assert [cell for cell in all_cells(text.split("## Every case")[1]) if not cell] == []


def test_the_mean_is_over_what_every_scene_has() -> None:
    scenes = scenes_of([*on_the_front(), *behind()])
    means = {point.name: point for point in over_all(scenes, BIAS)}
    assert set(means) == {"Nishita1987", "Weng2010", OURS}
    assert means["Weng2010"].error == pytest.approx((0.01 * 0.001) ** 0.5)
    assert means[OURS].cost == pytest.approx(50.0)
    assert means[OURS].low == pytest.approx(47.5)
    assert over_all(scenes, PERCENTILE_95)[0].error == pytest.approx(1.0)
    # in the mean ours errs 2e-3 in 50 ms, Weng2010 3.2e-3 in 20 ms
    text = flat(text_of([*on_the_front(), *behind()]))
    assert f"**all scenes**, by bias: ours is on the front in 1 of 1 settings, 1 of them for sure ({OURS}), " in text
    # 0 counts as half of 0.001
    zero = [*on_the_front(), *behind()[:2], case(OURS, 0.0, 50.0, scene="dragon")]
    mean = next(point for point in over_all(scenes_of(zero), BIAS) if point.name == OURS)
    assert mean.error == pytest.approx((0.001 * 0.0005) ** 0.5)


def test_costs_are_ratios_to_one_clock() -> None:
    """A case that was timed while all was twice as slow, its baseline too, costs no more."""
    rows = on_the_front()
    slow = rows[1] | {"timing.ms_50": 40.0, "timing.baseline_ms_50": 2 * BASELINE_MS}
    fast = rows[2] | {"timing.ms_50": 10.25, "timing.baseline_ms_50": 0.5 * BASELINE_MS}
    points = scenes_of([rows[0], slow, fast, *rows[3:]])[0].points(BIAS)
    assert [point.cost for point in points[:3]] == pytest.approx([10.0, 20.0, 20.5])


def test_what_is_drawn_otherwise_is_compared_apart() -> None:
    same = [case("Weng2010", 0.01, 20.0), case(OURS, 0.02, 40.0)]
    other = [one | {"phase": "rayleigh", "width": 99} for one in same]
    thick = [one | {"parameters": '{"sigma_t": "0.3", "phase": "isotropic"}'} for one in same]
    names = [scene.name for scene in scenes_of([*same, *other, *thick])]
    assert names == [
        "sphere, isotropic, 64 x 48",
        "sphere, rayleigh, 99 x 48",
        "sphere, isotropic, 64 x 48, sigma_t 0.3",
    ]
    assert [scene.name for scene in scenes_of([*same, *behind()])] == ["sphere", "dragon"]


def test_the_lattice_that_serves_best() -> None:
    ranking, dropped = served(scenes_of(on_the_front()))
    assert [(one.name, one.fronts, one.sure) for one in ranking] == [
        # 0.001 x 50 ms, 0.004 x 25 ms, 0.03 x 15 ms
        ("grid, every pixel, map 1024", 2, 2),
        ("grid, N = 2, bilateral, map 1024", 2, 2),
        ("grid, N = 4, bilateral, map 1024", 2, 2),
        ("epipolar, N = 2, map 1024", 0, 0),
    ]
    assert not dropped
    text = flat(text_of(on_the_front()))
    assert (
        "serve ours best are **grid, every pixel, map 1024**: on 2 of 2 fronts, 2 of them for sure, as grid, N = 2, "
        "bilateral, map 1024 and grid, N = 4, bilateral, map 1024, and of these with the least error times cost."
        in text
    )
    # one that is on more fronts goes before, whatever its product
    cheaper = [*on_the_front(), case("Weng2010", 0.0005, 45.0, steps=512)]
    assert served(scenes_of(cheaper))[0][0].name == "grid, N = 2, bilateral, map 1024"
    assert "Next is" not in flat(text_of(cheaper)).split("### Its lattice")[1]
    # of those on as many, error times cost decides, and not the error
    dearer = [
        one | {"timing.ratio_50": 20.0, "timing.ratio_high": 21.0} if n == 4 else one
        for n, one in enumerate(on_the_front())
    ]
    assert served(scenes_of(dearer))[0][0].name == "grid, N = 2, bilateral, map 1024"


def test_other_shadow_maps_are_ranked_beside_it() -> None:
    finer = [*on_the_front(), case(OURS, 1e-4, 0.1, shadow_map=512)]
    errors = {one.name: one.errors[0] for one in served(scenes_of(finer))[0]}
    assert errors["grid, every pixel, map 1024"] == pytest.approx(0.001)
    assert errors["grid, every pixel, map 512"] == pytest.approx(1e-4)
    # in the other scene only one of them ran, and the others are named
    ranking, dropped = served(scenes_of([*on_the_front(), *behind()]))
    assert [one.name for one in ranking] == ["grid, every pixel, map 1024"]
    assert len(dropped) == 3
    text = flat(text_of([*on_the_front(), *behind()]))
    assert "Not ranked, as they have no numbers in some scene: grid, N = 2, bilateral, map 1024; grid, N = 4" in text
    # none serves best where none is on a front
    assert "Ours is on no front on any lattice; the least error times cost has grid, every" in flat(text_of(behind()))
    assert "serve ours best" not in text_of(behind())


def test_noise_of_the_references_is_said() -> None:
    assert "The references are deterministic" in text_of(on_the_front())
    noisy = [one | {"estimator": "equiangular 3", "rel_error": "0.004"} for one in on_the_front()]
    assert "have noise (relative standard errors of 0.40%)" in flat(text_of(noisy))


def test_a_figure_a_scene_and_one_over_all(tmp_path: Path) -> None:
    rows = [*on_the_front(), *behind(), case("Weng2010", 0.0, 90.0, steps=512)]
    plots = list(STUDY.plots(table(rows)))
    assert [plot.name for plot in plots] == ["scene-sphere", "scene-dragon", "all"]
    assert "geometric means over the scenes" in plots[2].caption
    assert [plot.name for plot in STUDY.plots(table(on_the_front()))] == ["scene-sphere"]
    panel, _, names, _ = plots[0].figure.axes
    assert (panel.get_xscale(), panel.get_yscale()) == ("log", "log")
    assert "1  Nishita1987\n" in names.texts[0].get_text()
    assert [text.get_text() for text in panel.texts] == ["1", "2", "3", "4", "5", "6"]
    drawn = {line.get_marker() for line in panel.lines}
    assert OUR_MARK in drawn
    hollow = [line.get_xdata()[0] for line in panel.lines if line.get_markerfacecolor() == "white"]
    assert hollow == pytest.approx([20.5])
    # what errs by nothing stands at half of the least error
    assert min(float(line.get_ydata()[0]) for line in panel.lines) == 0.0005
    legend = [text.get_text() for text in plots[0].figure.legends[0].texts]
    assert f"{OURS} (ours)" in legend
    assert len(legend) == 5
    for plot in plots:
        plot.figure.savefig(tmp_path / f"{plot.name}.png")


def test_the_command_runs_the_suite_and_writes_the_page(airlight, tmp_path: Path) -> None:
    techniques = f'techniques=[{{name="Nishita1987", steps=4}}, {{name="{OURS}"}}, {{name="Wyman2008", steps=4}}]'
    words = ["half_plane", "--set", "size=[16,12]", "--set", techniques, "--set", "rounds=6", "--set", 'phases="hg"']
    result = airlight("pareto", *words, "--out", "page", "--fresh")
    assert result.code == 0, result.err
    assert "Ours is on the fronts of 1 of 1 by bias, " in result.out + result.err
    page = (tmp_path / "page" / "README.md").read_text(encoding="utf-8")
    assert page.startswith("# Error against cost\n")
    assert cells(page, "half_plane", OURS)[3] in (str(Standing.FRONT), str(Standing.BY_MEDIAN))
    # a table of Sun's serves the isotropic function alone
    assert "refused: The airlight model sun2005 takes the phase function isotropic" in page
    assert (tmp_path / "page" / "scene-half_plane.png").stat().st_size > 10_000
    assert len(list((tmp_path / "runs").iterdir())) == 1


def test_another_page_is_not_overwritten(airlight, tmp_path: Path) -> None:
    (tmp_path / "pareto").mkdir()
    (tmp_path / "pareto" / "README.md").write_text("# Mine\n")
    result = airlight("pareto", "half_plane")
    assert result.code == 2
    assert "another page" in result.err
    assert not (tmp_path / "runs").exists()
