"""The study of errors says of every case its numbers, or why there are none."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import polars
import pytest

from experiments.studies.errors import COLUMNS, plots, text
from gpu_impl.techniques import SETTINGS, find_technique

NUMBERS = {
    "scattering.rel_50": 0.00125,
    "scattering.rel_95": 0.02,
    "scattering.rel_99": 0.04,
    "scattering.image_mean_rel": -0.005,
    "scattering.flip": 0.0312,
    "rel_error": "0.0049",
}


def row(**changes: Any) -> dict[str, Any]:
    """A row as a run keeps it."""
    technique = find_technique("Weng2010")
    return {
        "case": "a",
        "scene": "sphere",
        "phase": "hg 0.6",
        "camera": "",
        "technique": technique.name,
        **{setting: getattr(technique, setting) for setting in SETTINGS},
        "status": "done",
        "reason": "",
        **changes,
    }


def told(*rows: dict[str, Any]) -> str:
    """What is said of a run of these rows."""
    return text(polars.DataFrame(rows, infer_schema_length=None))


def test_a_case_has_its_numbers() -> None:
    expected = "| sphere hg 0.6 | Weng2010, steps 7 | 0.125% | 2.000% | 4.000% | -0.500% | 0.0312 | 0.49% |"
    lines = told(row(steps=7, **NUMBERS)).splitlines()
    assert lines[2:] == [expected]
    assert lines[1].count("--:") == 6


@pytest.mark.parametrize("column", list(COLUMNS)[1:])
def test_a_number_that_is_missing_says_so(column: str) -> None:
    found = told(row(**NUMBERS | {column: None}), row(scene="empty", **NUMBERS))
    first = found.splitlines()[2]
    assert first.count("– (1)") == 1
    assert first.split("|")[3 + list(COLUMNS).index(column)].strip() == "– (1)"
    assert found.endswith(f"- (1) the run did not measure {column}")


def test_a_run_that_measured_something_else_says_so() -> None:
    found = told(row(**{"counts.lit": 3}))
    assert found.count("– (1)") == len(COLUMNS)
    assert "None" not in found
    assert found.endswith("- (1) the run did not measure scattering.rel_50")


def test_what_is_not_done_says_why_whatever_the_reason_holds() -> None:
    found = told(
        row(scene="a | b", status="refused", reason="no\nspots | <script>alert(1)</script>"),
        row(status="failed", reason="x"),
        row(**NUMBERS),
    )
    lines = found.splitlines()
    assert "a \\| b hg 0.6" in lines[2]
    # the same cells in each line, those of the hostile one among them
    assert {line.replace("\\|", "").count("|") for line in lines[:5]} == {len(COLUMNS) + 3}
    assert lines[6:] == [
        "- (1) refused: no spots \\| \\<script>alert(1)\\</script>",
        "- (2) failed: x",
    ]


def test_a_plot_of_some_cases() -> None:
    rows = [
        row(scene="price $x$ \\frac $\\nonsense$", **NUMBERS),
        row(scene="empty", **NUMBERS | {"scattering.rel_50": None}),
        row(scene="zero", **NUMBERS | {"scattering.rel_95": 0.0}),
        row(scene="refused", status="refused"),
    ]
    (plot,) = plots(polars.DataFrame(rows, infer_schema_length=None))
    plot.figure.savefig(BytesIO())
    (axes,) = plot.figure.axes
    assert [label.get_text() for label in axes.get_xticklabels()] == ["price $x$ \\frac $\\nonsense$ hg 0.6"]
    assert not list(plots(polars.DataFrame(rows[1:], infer_schema_length=None)))
    assert not list(plots(polars.DataFrame([row(**{"counts.lit": 3})])))
