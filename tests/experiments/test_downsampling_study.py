"""The study `downsampling` on tables whose growth and whose best upsampling are known."""

from __future__ import annotations

from matplotlib.figure import Figure
from study_tables import all_cells, cells, row, table

from experiments.studies import find_study
from experiments.studies.downsampling import STUDY
from experiments.studies.downsampling_plots import COLOURS

SCENES = {"sphere": 0.01, "dragon": 0.04}
# factors of the errors at edges
EDGES = {"bilateral": 1.0, "nearest_depth": 1.005, "bilinear": 4.0}


def errors(scene: str, downsample: int, upsample: str) -> dict[str, float | None]:
    """Error of a sixth at N = 1; from 2 on N^2 on smooth ground, N at edges; no pixel at shafts."""
    at_one = SCENES[scene] / 6
    smooth = SCENES[scene] * downsample**2 if downsample > 1 else at_one
    edge = SCENES[scene] * EDGES[upsample] * downsample if downsample > 1 else at_one
    return {
        "smooth.rel_50": 0.0,
        "smooth.rel_95": smooth,
        "smooth.bias": smooth / 3,
        "smooth.share": 0.75,
        "shaft.rel_50": None,
        "shaft.rel_95": None,
        "shaft.bias": None,
        "shaft.share": 0.0,
        "edge.rel_50": edge / 2,
        "edge.rel_95": edge,
        "edge.bias": edge / 4,
        "edge.share": 0.25,
    }


def rows() -> list[dict]:
    return [
        row(scene=scene, downsample=n, upsample=upsample, **errors(scene, n, upsample))
        for scene in SCENES
        for upsample in EDGES
        for n in (1, 2, 4, 8)
    ]


def test_it_is_in_the_registry() -> None:
    assert find_study("downsampling") is STUDY


def test_every_error_stands_in_its_table() -> None:
    text = STUDY.text(table(rows()))
    smooth, _, edge = text.split("## ")[1:4]
    begin = ("dragon", "isotropic", "Weng2010", "bilinear")
    # what is the same for all stands there once
    assert cells(smooth, *begin[:3], "all") == ["0% / 0.667%", "0% / 16%", "0% / 64%", "0% / 256%"]
    assert cells(edge, *begin) == ["0.333% / 0.667%", "16% / 32%", "32% / 64%", "64% / 128%"]
    assert cells(text.split("## ")[0], "sphere") == ["75%", "0%", "25%"]
    assert "64 x 48" in text
    assert "8 pixels or less" in text


def test_the_best_upsampling_is_counted_and_ties_are_shared() -> None:
    text = STUDY.text(table(rows()))
    # half a per cent is as good
    assert cells(text, "edge", "4") == ["2 of 2; 0.25", "2 of 2; 0.251", "0 of 2; 1"]
    assert cells(text, "smooth", "8") == ["2 of 2; 1"] * 3
    assert cells(text.split("Scene by scene")[1], "dragon") == ["bilateral, nearest_depth; 0.25"] * 3


def test_a_scene_with_large_errors_has_no_more_weight() -> None:
    some = rows()
    for one in some:
        # where all upsamplings come to the same, hundreds of times as large
        if one["scene"] == "dragon":
            one["edge.rel_95"] = 10.0 * one["downsample"]
    text = STUDY.text(table(some))
    # over bilinear's 1/4 and 1, so that their geometric mean is 1/2; of the means themselves nearly 1
    assert cells(text, "edge", "4")[0] == "2 of 2; 0.5"


def test_growth_is_fitted_behind_one() -> None:
    text = STUDY.text(table(rows()))
    # two scenes of three spacings; at N = 1 there is another error, which would bend the line
    assert cells(text, "Weng2010", "smooth", "bilateral") == [
        "– (1)",
        "2.00 [2.00, 2.00]; 2.00 to 2.00 (2 scenes, n = 6)",
        "2.00 [2.00, 2.00]; 2.00 to 2.00 (2 scenes, n = 6)",
    ]
    assert cells(text, "Weng2010", "edge", "bilinear") == ["1.00 [1.00, 1.00]; 1.00 to 1.00 (2 scenes, n = 6)"] * 3
    assert "- (1) no error above zero" in text


def test_the_interval_of_growth_is_over_the_scenes() -> None:
    # the dragon's errors grow faster by 1, in both phase functions alike
    some = [one | {"phase": phase} for one in rows() for phase in ("isotropic", "rayleigh")]
    for one in some:
        if one["scene"] == "dragon":
            one["edge.rel_95"] *= one["downsample"]
    text = STUDY.text(table(some))
    # 1.5 -+ 12.7062 / 2, Student's with one degree of freedom
    assert cells(text, "Weng2010", "edge", "bilinear")[1] == "1.50 [-4.85, 7.85]; 1.00 to 2.00 (2 scenes, n = 12)"
    assert "Student's t over the scenes' exponents" in " ".join(text.split())
    alone = STUDY.text(table([one for one in some if one["scene"] == "dragon"]))
    assert cells(alone, "Weng2010", "edge", "bilinear")[1] == "2.00 [2.00, 2.00] (1 scene, n = 6)"


def test_a_picture_s_height_is_not_taken_for_growth() -> None:
    some = [one for one in rows() if one["scene"] == "sphere"]
    # another phase function with a hundred times the error, and none but at N = 8
    for one in rows():
        if one["scene"] == "sphere":
            more = 100 * one["edge.rel_95"] if one["downsample"] == 8 else 0.0
            some.append(one | {"phase": "rayleigh", "edge.rel_95": more})
    text = STUDY.text(table(some))
    assert cells(text, "Weng2010", "edge", "bilinear")[1] == "1.00 [1.00, 1.00] (1 scene, n = 3)"


def test_a_picture_that_is_drawn_twice_counts_once() -> None:
    again = [one | {"product": "look"} for one in rows() if one["downsample"] == 4]
    assert STUDY.text(table(rows() + again)) == STUDY.text(table(rows()))


def test_no_cell_is_empty_without_saying_why() -> None:
    some = [one for one in rows() if not (one["upsample"] == "bilinear" and one["downsample"] == 8)]
    reason = "The airlight model takes\nno such phase function."
    for n in (1, 2, 4, 8):
        for upsample in EDGES:
            some.append(row(phase="hg 0.6", downsample=n, upsample=upsample, status="refused", reason=reason))
    some.append(row(scene="wire_mesh", status="failed", reason="out of memory"))
    text = STUDY.text(table(some))
    assert "" not in all_cells(text)
    assert "refused: The airlight model takes no such phase function." in text
    smooth = text.split("## ")[1]
    assert cells(smooth, "sphere", "hg 0.6", "Weng2010", "all") == ["– (2)"] * 4
    assert cells(smooth, "sphere", "isotropic", "Weng2010", "bilinear")[-1] == "– (1)"
    assert "- (1) not among the cases of this run" in smooth
    assert "failed: out of memory" in smooth
    # what was not drawn with every upsampling is not compared
    assert "no picture has an error with every upsampling" in text


def test_a_run_in_which_all_refused_says_so() -> None:
    text = STUDY.text(table([row(status="refused", reason="No."), row(status="failed", reason="Oh.", downsample=2)]))
    assert "refused: No." in text
    assert not list(STUDY.plots(table([row(status="refused", reason="No.")])))


def test_a_figure_a_technique_with_every_curve() -> None:
    both = rows() + [one | {"technique": "lit_intervals+quadrature"} for one in rows()]
    plots = list(STUDY.plots(table(both)))
    assert [plot.name for plot in plots] == ["downsampling-1", "downsampling-2"]
    assert isinstance(plots[0].figure, Figure)
    panels = plots[0].figure.axes
    assert len(panels) == 6
    curves = {line.get_color(): list(line.get_ydata()) for line in panels[5].lines}
    drawn = [one["edge.rel_95"] for one in rows() if (one["scene"], one["upsample"]) == ("dragon", "bilinear")]
    assert curves[COLOURS["bilinear"]] == drawn
    # the region without pixels says that it has none
    assert [text.get_text() for text in panels[2].texts] == ["no error above zero"]
