"""`airlight accuracy`: errors shrink along its ladders, its limits judge, its page says both."""

from __future__ import annotations

from pathlib import Path

import polars
import pytest
from typer.testing import CliRunner

from experiments.accuracy import page, study
from experiments.accuracy.study import passes
from experiments.cli import app
from scenes.errors import InputError

SMALL = ["--size", "32", "32"]


@pytest.mark.parametrize(
    ("median", "most", "kept"), [(0.02, 0.10, True), (0.021, 0.01, False), (0.0, 0.101, False), (0.0, 0.0, True)]
)
def test_limits(median: float, most: float, kept: bool) -> None:
    assert passes({"rel_50": median, "rel_95": most}) is kept


@pytest.fixture
def one_phase(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "PHASES", study.PHASES[:1])


@pytest.mark.usefixtures("one_phase")
def test_the_page(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["accuracy", "sphere", "eye_in_shadow", *SMALL, "--out", str(tmp_path / "page")])
    assert result.exit_code == 0, result.output
    table = polars.read_csv(tmp_path / "page" / "results.csv")
    assert len(table) == 2 * len(study.settings())
    assert set(table["scene"]) == {"sphere", "eye_in_shadow"}
    # half a texel and half a step are what is wrong: the finest maps are several times better than the coarsest
    for scene in ("sphere", "eye_in_shadow"):
        climbed = table.filter((polars.col("scene") == scene) & (polars.col("steps") == study.STEPS_LADDER[-1]))
        errors = dict(zip(climbed["shadow_map"], climbed["rmse"], strict=True))
        assert errors[2048] < errors[128] / 4
    text = (tmp_path / "page" / "README.md").read_text()
    assert text.startswith(f"# {page.TITLE}\n")
    assert "2 of 2 cases keep that" in text
    assert (tmp_path / "page" / "curves.png").stat().st_size > 10_000


@pytest.mark.usefixtures("one_phase")
def test_a_technique_that_is_wrong_does_not_keep_the_limits(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["accuracy", "sphere", *SMALL, "--technique", "front_final+riemann"])
    assert result.exit_code == 0, result.output
    assert "0 of 1 cases keep that, all but sphere with isotropic" in " ".join(result.output.split())


def test_refusals(tmp_path: Path) -> None:
    (tmp_path / "README.md").write_text("# Mine\n")
    for arguments, message in (
        (["--technique", "nothing"], "There is no technique 'nothing'"),
        (["--out", str(tmp_path)], "is another page"),
        (["no_such_scene"], "no_such_scene"),
    ):
        result = CliRunner().invoke(app, ["accuracy", *arguments])
        assert isinstance(result.exception, InputError)
        assert message in str(result.exception)
