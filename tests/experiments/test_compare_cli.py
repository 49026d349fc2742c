"""`airlight compare` with several pictures and its heat maps' options."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from experiments.exr import write_exr
from experiments.heat_maps.heat_map import HeatMap


def picture(name: str, factor: float) -> str:
    """A file of six bright pixels, times a factor."""
    image = np.linspace(0.1, 1, 18, dtype=np.float32).reshape(2, 3, 3)
    write_exr(Path(name), {"composite": factor * image}, {})
    return name


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[tuple]:
    """Instead of drawing: what would be drawn."""
    calls: list[tuple] = []
    monkeypatch.setattr("experiments.compare.write_sheets", lambda *arguments: calls.append(arguments))
    return calls


def test_several_pictures_and_last_their_reference(airlight) -> None:
    files = [picture("a.exr", 1.1), picture("b.exr", 0.8), picture("r.exr", 1)]
    result = airlight("compare", *files, "--json", "--heatmap", "h.png")
    assert result.code == 0
    rows = json.loads(result.out)
    assert [row["picture"] for row in rows] == files[:2]
    assert [row["rel_50"] for row in rows] == pytest.approx([0.1, 0.2], rel=1e-5)
    assert [row["image_mean_rel"] for row in rows] == pytest.approx([0.1, -0.2], rel=1e-5)
    assert Path("h.png").is_file()
    one = json.loads(airlight("compare", "b.exr", "r.exr", "--json").out)
    assert {"picture": "b.exr", **one} == rows[1]
    table = airlight("compare", *files).out
    assert "a.exr" in table
    assert "b.exr" in table


def test_options_become_heat_maps(airlight, drawn: list[tuple]) -> None:
    files = [picture("a.exr", 1.1), picture("b.exr", 0.8), picture("r.exr", 1)]

    def maps(*options: str) -> list[HeatMap]:
        result = airlight("compare", *files, "--heatmap", "h.png", *options)
        assert result.code == 0, result.err
        return drawn[-1][-1]

    assert maps() == [HeatMap(True, "relative"), HeatMap(False, "radiance")]
    assert [line.split(";")[0] for line, _ in drawn[-1][2]] == ["a.exr", "b.exr"]
    assert maps("--map", "signed", "--scale", "linear", "--range", "5") == [HeatMap(True, "relative", False, 5.0)]
    assert maps("--map", "absolute", "--colours", "hue") == [HeatMap(False, "radiance", True, None, "hue")]
    assert maps("--unit", "radiance", "--range", "0.5") == [
        HeatMap(True, "radiance", True, 0.5),
        HeatMap(False, "radiance", True, 0.5),
    ]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["a.exr"], "Give at least one picture, and its reference after it."),
        (["a.exr", "a.exr", "--range", "3", "--heatmap", "h.png"], "say which error or which unit"),
        (["a.exr", "a.exr", "--map", "signed", "--range", "0", "--heatmap", "h.png"], "--range 0 is no scale"),
        (["a.exr", "a.exr", "--map", "signed", "--range", "inf", "--heatmap", "h.png"], "--range inf is no scale"),
        (["a.exr", "a.exr", "--map", "signed", "--colours", "hue", "--heatmap", "h.png"], "give --map absolute"),
        (["a.exr", "a.exr", "--scale", "linear", "--map", "signed"], "nothing to draw with --map and --scale"),
    ],
)
def test_what_contradicts_itself_is_refused(airlight, words: list[str], said: str) -> None:
    picture("a.exr", 1)
    result = airlight("compare", *words)
    assert result.code == 2
    assert said in result.err
    assert not Path("h.png").exists()
