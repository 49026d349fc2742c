"""`airlight compare` with several pictures and its heat maps' options."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import OpenEXR
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


def test_another_engines_picture_is_compared_with_a_layer_and_its_mistakes_are_named(airlight) -> None:
    truth = np.random.default_rng(2).uniform(0.1, 1, (8, 6, 3)).astype(np.float32)
    write_exr(Path("r.exr"), {"composite": truth + 1, "scattering": truth}, {"scene": "sphere"})
    OpenEXR.File({}, {"RGB": (truth[::-1] / np.float32(np.pi)).astype(np.float16)}).write("engine.exr")
    result = airlight("compare", "engine.exr", "r.exr", "--layer", "scattering", "--json")
    assert result.code == 0
    assert json.loads(result.out)["rel_50"] > 0.5
    only, better = result.err.splitlines()
    assert only == "The only picture in engine.exr is taken for its scattering layer."
    assert better.startswith("engine.exr fits far better upside down and times 3.14")
    # as it should be, and nothing is left to say of it
    OpenEXR.File({}, {"RGB": truth}).write("engine.exr")
    result = airlight("compare", "engine.exr", "r.exr", "--layer", "scattering", "--json")
    assert json.loads(result.out)["rmse"] == 0
    assert result.err.splitlines() == [only]


def test_which_of_an_engines_pictures_is_meant_has_to_be_plain(airlight) -> None:
    planes = {f"{view}.{letter}": np.ones((2, 3), np.float32) for view in ("left", "right") for letter in "RGB"}
    OpenEXR.File({}, planes).write("engine.exr")
    picture("r.exr", 1)
    for layer in ("composite", "scattering"):
        result = airlight("compare", "engine.exr", "r.exr", "--layer", layer)
        assert result.code == 2
        assert f"engine.exr has no layer '{layer}'; it has left, right" in result.err
    # nor is a picture that says what it is taken for something else
    result = airlight("compare", "r.exr", "r.exr", "--layer", "surface")
    assert result.code == 0
    write_exr(Path("ours.exr"), {"composite": np.ones((2, 3, 3), np.float32)}, {"scene": "sphere"})
    result = airlight("compare", "ours.exr", "r.exr", "--layer", "surface")
    assert result.code == 2
    assert "ours.exr has no layer 'surface'; it has composite" in result.err


def test_where_a_picture_is_not_finite_is_said(airlight) -> None:
    broken = np.ones((4, 6, 3), np.float32)
    broken[2, 5, 1], broken[3, 0] = np.inf, np.nan
    OpenEXR.File({}, {"RGB": broken}).write("engine.exr")
    write_exr(Path("r.exr"), {"composite": np.ones((4, 6, 3), np.float32)}, {})
    result = airlight("compare", "engine.exr", "r.exr")
    assert result.code == 2
    assert "not finite in 2 of its pixels, the first in row 2, column 5; nothing can be measured" in result.err
