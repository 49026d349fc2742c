"""Verdicts follow from what is measured: a technique or a model that is wrong changes them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments.figures import FIGURES, models, page, stage
from experiments.figures.claims import CLAIMS, committed, cost, limits, mathematics, pictures
from experiments.figures.claims.claim import Finding, Verdict
from experiments.figures.stage import Stage
from experiments.figures.table_5_1 import Rate
from gpu_impl.frame import Frame
from scenes.errors import InputError


@pytest.fixture(scope="module")
def small() -> Any:
    with pytest.MonkeyPatch.context() as patch, Stage((48, 48)) as made:
        patch.setattr(stage, "FIELD_SIDE", 48)
        for module in (pictures, cost, limits):
            patch.setattr(module, "SCENES", ("donut_dragon",))
        yield made


@pytest.mark.parametrize(
    ("as_printed", "repaired", "verdict"),
    [
        (True, True, "reproduced"),
        (True, False, "reproduced"),
        (False, True, "reproduced with the repair"),
        (False, False, "not reproduced"),
    ],
)
def test_the_rule(as_printed: bool, repaired: bool, verdict: str) -> None:
    assert Finding("", as_printed, repaired).verdict == verdict


def test_claims_name_figures_and_pages() -> None:
    assert len({claim.words for claim in CLAIMS}) == len(CLAIMS) == 19
    for claim in CLAIMS:
        assert not claim.figure or claim.figure in FIGURES
        assert all(one == "II" or 1 <= int(one) <= 39 for one in claim.pages.split(", "))


def test_the_repaired_technique_keeps_what_it_is_drawn_for(small: Stage) -> None:
    for measure in (pictures._more_realistic, pictures._no_dark_gap, pictures._two_parts):
        assert measure(small).verdict == Verdict.WITH_THE_REPAIR


@pytest.mark.parametrize(
    ("measure", "wrong"),
    [
        (pictures._more_realistic, "Nishita1987"),
        (pictures._no_dark_gap, "FrontFinal"),
        (pictures._no_aliasing, "Nishita1987"),
    ],
)
def test_a_wrong_technique_is_not_reproduced(
    small: Stage, measure: Any, wrong: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    frame = Stage.frame

    def exchanged(self: Stage, scene: Any, technique: str, **settings: Any) -> Frame:
        return frame(self, scene, wrong if technique == "Weng2010" else technique, **settings)

    monkeypatch.setattr(Stage, "frame", exchanged)
    assert measure(small).verdict == Verdict.NOT


def test_formulas(small: Stage) -> None:
    assert mathematics._pegoraro_beside_sun(small).verdict == Verdict.REPRODUCED
    assert mathematics._normalised(small).verdict == Verdict.WITH_THE_REPAIR
    assert "12.56637061" in mathematics._normalised(small).measured
    assert mathematics._accurate(small).verdict == Verdict.WITH_THE_REPAIR
    # the minimax terms that mend it are another expansion
    assert mathematics._taylor(small).verdict == Verdict.NOT


def test_intervals_hold_the_statistic(small: Stage) -> None:
    """Over tiles, a share in one tile alone has a wider interval than the same share over the picture."""
    pieces = models.Pieces.of_subject(small)
    everywhere = np.arange(len(pieces.pixel)) % 10 == 0
    in_one_place = np.arange(len(pieces.pixel)) < everywhere.sum()
    widths = []
    for wrong in (everywhere, in_one_place):
        share, low, high = mathematics.over_tiles(small, lambda places, wrong=wrong: float(wrong[places].mean()))
        assert share == pytest.approx(0.1, abs=0.01)
        assert low <= share <= high
        widths.append(high - low)
    assert 3 * widths[0] < widths[1]


def test_shadows_that_are_not_filtered_are_not_soft(small: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    assert pictures._soft_shadows(small).verdict == Verdict.REPRODUCED
    frame = Stage.frame

    def hard(self: Stage, *arguments: Any, surface_shadows: str = "hard", **settings: Any) -> Frame:
        return frame(self, *arguments, **settings)

    monkeypatch.setattr(Stage, "frame", hard)
    assert pictures._soft_shadows(small).verdict == Verdict.NOT


@pytest.mark.parametrize(
    ("printed", "repaired", "verdict"),
    [(40, 40, Verdict.REPRODUCED), (90, 40, Verdict.WITH_THE_REPAIR), (90, 90, Verdict.NOT)],
)
def test_rates_of_either_form_decide(
    small: Stage, printed: float, repaired: float, verdict: Verdict, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Milliseconds a frame, of one scene twice as slow as of the other: 17 frames a second are 59 ms."""
    times = {"printed": printed, "repaired": repaired}
    found = [
        Rate(scene, "isotropic", 20, {name: np.full(6, ms / slower) for name, ms in times.items()})
        for scene, slower in (("one", 1), ("two", 2))
    ]
    monkeypatch.setattr(cost, "rates", lambda _: found)
    assert cost._real_time(small).verdict == verdict


@pytest.mark.parametrize(("factor", "verdict"), [(1.0, Verdict.REPRODUCED), (1.02, Verdict.NOT)])
def test_models_that_are_all_right_or_all_wrong(
    small: Stage, factor: float, verdict: Verdict, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = models.airlight

    def exchanged(*positions: Any, model: str, dtype: type, **others: Any) -> np.ndarray:
        found = right(*positions, model="quadrature", dtype=np.float64, **others)
        return found if model == "quadrature" else factor * found

    monkeypatch.setattr(models, "airlight", exchanged)
    assert mathematics._accurate(small).verdict == verdict
    assert mathematics._taylor(small).verdict == verdict


def test_counts_and_refusals(small: Stage) -> None:
    assert cost._fewer_samples(small).verdict == Verdict.WITH_THE_REPAIR
    assert cost._no_storage(small).verdict == Verdict.NOT
    assert limits._wire_mesh(small).verdict == Verdict.REPRODUCED
    assert limits._point_and_spot(small).verdict == Verdict.REPRODUCED


def test_a_model_that_took_a_sun_would_be_no_restriction(small: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "CLOSED_FORMS", (*limits.CLOSED_FORMS, "quadrature"))
    assert limits._point_and_spot(small).verdict == Verdict.NOT


@pytest.mark.parametrize(("low", "verdict"), [(1.01, Verdict.WITH_THE_REPAIR), (0.99, Verdict.NOT)])
def test_committed_pairs_decide(small: Stage, low: float, verdict: Verdict, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [
        {**row, "ratio_low": low, "scattering_ratio_low": low}
        for first, second in (("four Ei", "three Ei"), ("whole ray as dense", "quadrature"))
        for row in committed.pairs(first, second)
    ]
    assert len(rows) == 4
    monkeypatch.setattr(cost, "pairs", lambda first, second: [row for row in rows if row["first"] == first])
    assert cost._three_evaluations(small).verdict == verdict
    assert cost._faster_sampling(small).verdict == verdict


def test_results_that_are_missing(airlight: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    committed.check_results()
    monkeypatch.setattr(committed, "RESULTS", tmp_path)
    with pytest.raises(InputError, match=r"The claims need .*pairs\.csv"):
        committed.check_results()
    answer = airlight("figures", "--size", "48", "48")
    assert answer.code == 2
    assert "--only" in answer.err


def test_tables_that_lack_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table, audit = (committed.RESULTS / name for name in (committed.PAIRS, committed.AUDIT))
    rows = table.read_text().splitlines(keepends=True)
    equations = json.loads(audit.read_text())
    monkeypatch.setattr(committed, "RESULTS", tmp_path)
    for name in (committed.PAIRS, committed.AUDIT):
        (tmp_path / name).parent.mkdir(parents=True)
    (tmp_path / committed.AUDIT).write_text(audit.read_text())
    one = next(row for row in rows if row.startswith("empty") and "four Ei" in row)
    for wrong in ([rows[0]], [row for row in rows if row != one], [*rows, one]):
        (tmp_path / committed.PAIRS).write_text("".join(wrong))
        with pytest.raises(InputError, match="once for each of donut_dragon, empty"):
            committed.check_results()
    (tmp_path / committed.PAIRS).write_text("".join(rows))
    committed.check_results()
    for wrong in ([row for row in equations if row["equation"] != "Alg. 4.1"], equations + equations):
        (tmp_path / committed.AUDIT).write_text(json.dumps(wrong))
        with pytest.raises(InputError, match=r"'Alg\. 4\.1' once"):
            committed.check_results()


def test_the_page(small: Stage, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page, "CLAIMS", (mathematics.CLAIMS[3], pictures.CLAIMS[1]))
    page.write_page(tmp_path, {"4.6": "X_h = 7.\n\n| a |\n|---|"}, small, "airlight figures")
    text = (tmp_path / "README.md").read_text()
    assert text.startswith(f"# {page.TITLE}\n")
    for words in (
        "    airlight figures\n",
        "| reproduced with the repair | [Figure 5.3](figure-5.3.png) |",
        "**Reproduced with the repair.** [Figure 1.1](figure-1.1.png).",
        "![Figure 4.6](figure-4.6.png)\n\nX_h = 7. [PDF](figure-4.6.pdf)\n\n| a |",
        "- Figure 2.2: ",
    ):
        assert words in text
