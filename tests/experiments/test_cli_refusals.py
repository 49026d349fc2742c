"""What cannot be used ends in one sentence and exit code 2."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from flat_exr import picture

from experiments.exr import write_exr

# what Python makes of a byte that is not UTF-8
NO_TEXT = os.fsdecode(b"\xff")
SMALL = ["--size", "16", "16"]
SUITE = 'scenes = ["empty"]\nsize = [16, 16]\n[[techniques]]\nname = "Weng2010"\n'


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["render", "empty"], "render needs a SCENE and --out"),
        (["render", "--out", "a.exr"], "render needs a SCENE and --out"),
        (["render", "--again", "none.exr"], "There is no file none.exr"),
        (["render", "--again", "."], "There is no file ."),
        (["render", "--again", "good.exr"], "good.exr does not say how it was drawn"),
        (["render", "--again", "good.exr", "--out", "good.exr"], "choose another --out"),
        (["render", "--again", "good.exr", "--out", "missing/a.exr"], "make it first"),
        (["render", "--again", "good.exr", "--steps", "3", "-p", "a=b"], "leave --parameter and --steps out"),
        (["render", "nowhere", "--out", "a.exr"], "There is no scene 'nowhere'"),
        (["render", "n" * 300, "--out", "a.exr"], "There is no scene"),
        (["render", "two\nlines", "--out", "a.exr"], "There is no scene 'two lines'"),
        (["render", "empty", "--technique", "Nobody1999", "--out", "a.exr"], "There is no technique 'Nobody1999'"),
        (["render", "empty", "--technique", "a+quadrature", "--out", "a.exr"], "There is no visibility 'a'"),
        (["render", "empty", "--technique", "lit_intervals+", "--out", "a.exr"], "There is no airlight model ''"),
        (["render", "empty", "-p", "sigma_t", "--out", "a.exr"], "-p sigma_t should be NAME=VALUE"),
        (["render", "empty", "-p", "=3", "--out", "a.exr"], "-p =3 should be NAME=VALUE"),
        (["render", "empty", "-p", "sigma_t=", "--out", "a.exr"], "was given no value"),
        (["render", "empty", "-p", "sigma=1", "--out", "a.exr"], "no use for the parameter $sigma "),
        (["render", "empty", "-p", "scene=1", "--out", "a.exr"], "no use for the parameter $scene "),
        (["render", "empty", "-p", "size=1", "--out", "a.exr"], "is set by --size W H"),
        (["render", "empty", "--size", "0", "8", "--out", "a.exr"], "An image of 0 x 8 pixels cannot be made"),
        (["render", "empty", "--size", "8", "-1", "--out", "a.exr"], "An image of 8 x -1 pixels cannot be made"),
        (["render", "empty", "--steps", "0", "--out", "a.exr"], "steps is 0; use 1 to"),
        (["render", "empty", "--shadow-map", "0", "--out", "a.exr"], "shadow_map is 0; use 1 to"),
        (["render", "empty", "--downsample", "3", "--out", "a.exr"], "downsample is 3; use 1, 2, 4, 8"),
        (["render", "empty", *SMALL, "-p", "phase=hg", "--out", "a.exr"], "takes the phase function isotropic"),
        (["render", "empty", "--out", "missing/a.exr"], "make it first"),
        (["render", "empty", "--out", "."], "is a folder; name a file in it"),
        (["render", "empty", "--out", ""], "is a folder; name a file in it"),
        (["render", "empty", "--out", "/dev/full"], "is no ordinary file"),
        (["render", "empty", "--out", "n" * 300], "cannot be written"),
        (["reference", "nowhere", "--out", "a.exr"], "There is no scene"),
        (["reference", "empty", "--rel-error", "0", "--out", "a.exr"], "use a number between 0 and 1"),
        (["reference", "empty", "--rel-error", "nan", "--out", "a.exr"], "use a number between 0 and 1"),
        (["reference", "empty", "--time-limit", "-1", "--out", "a.exr"], "use a positive number"),
        (["reference", "empty", "--time-limit", "nan", "--out", "a.exr"], "use a positive number"),
        (["reference", "empty", "--out", "missing/a.exr"], "make it first"),
        (["render", "empty", "-p", "g=1", "-p", "g=2", "--out", "a.exr"], "-p g is given twice; leave one out"),
        (
            ["render", "empty", "-p", f"g=0.{NO_TEXT}2", "--out", "a.exr"],
            "-p g or its value holds bytes that are not UTF",
        ),
        (["render", "empty", "-p", f"{NO_TEXT}=2", "--out", "a.exr"], "or its value holds bytes that are not UTF-8"),
        (["render", "empty", "--technique", NO_TEXT, "--out", "a.exr"], "There is no technique '?'"),
        (["render", f"b{NO_TEXT}.xml", "--out", "a.exr"], "b\\xff.xml has a name that is not UTF-8; rename it"),
        (["render", "empty", "--out", f"b{NO_TEXT}.exr"], "b\\xff.exr has a name that is not UTF-8; rename it"),
        (["render", "--again", f"b{NO_TEXT}.exr"], "b\\xff-again.exr has a name that is not UTF-8; rename it"),
        (["compare", "good.exr", f"b{NO_TEXT}.exr"], "b\\xff.exr has a name that is not UTF-8; rename it"),
        (["run", f"b{NO_TEXT}.toml"], "b\\xff.toml has a name that is not UTF-8; rename it"),
        (["run", "suite.toml", "--out", NO_TEXT], "\\xff has a name that is not UTF-8; rename it"),
        (["compare", "good.exr", "none.exr"], "There is no file none.exr"),
        (["compare", "none.exr", "good.exr"], "There is no file none.exr"),
        (["compare", "good.exr", "."], "There is no file ."),
        (["compare", "good.exr", "text.exr"], "text.exr is not an OpenEXR file that can be read"),
        (["compare", "good.exr", "large.exr"], "different sizes, 6 x 4 and 7 x 5 pixels"),
        (["compare", "good.exr", "good.exr", "--layer", "fog"], "has no layer 'fog'; it has composite"),
        (["compare", "good.exr", "scattering.exr"], "scattering.exr has no layer 'composite'; it has scattering"),
        (["compare", "good.exr", "grey.exr"], "it has no colour layer"),
        (["compare", "nan.exr", "good.exr"], "The picture holds values that are not finite"),
        (["compare", "good.exr", "nan.exr"], "The reference holds values that are not finite"),
        (["compare", "good.exr", "good.exr", "--heatmap", "missing/a.png"], "make it first"),
        (["compare", "good.exr", "good.exr", "--heatmap", "good.exr"], "give it a name that ends in .png"),
        (["run", "nowhere"], "There is no suite 'nowhere': give the path of a TOML file or one of aliasing, "),
        (["run", "."], "There is no suite '.'"),
        (["run", "n" * 300], "There is no suite"),
        (["run", "text.exr"], "text.exr is not a suite"),
        (["run", "good.exr"], "good.exr is not a suite"),
        (["run", "suite.toml", "--out", "text.exr"], "text.exr cannot be made (File exists): choose another --out"),
    ],
)
def test_what_cannot_be_used_ends_in_one_sentence_and_code_2(airlight, words: list[str], sentence: str) -> None:
    for path, value in (("good.exr", 1.0), ("nan.exr", np.nan)):
        picture(path, value)
    picture("large.exr", size=(5, 7))
    picture("scattering.exr", layer="scattering")
    write_exr(Path("grey.exr"), {"depth": np.ones((4, 6), np.float32)}, {})
    Path("text.exr").write_text("not [ a picture")
    Path("suite.toml").write_text(SUITE)
    before = {path: path.read_bytes() for path in Path().iterdir()}
    result = airlight(*words)
    assert result.code == 2
    assert result.out == ""
    assert result.err.startswith("airlight: ")
    assert result.err.count("\n") == 1
    assert sentence in result.err
    # nothing was written, and nothing that was there was harmed
    assert {path: path.read_bytes() for path in Path().iterdir()} == before


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "the key 'scenes': Field required"),
        (SUITE.replace("scenes", "scene"), "the key 'scenes'"),
        ("colour = 3\n" + SUITE, "the key 'colour'"),
        (SUITE.replace('["empty"]', "[]"), "the key 'scenes'"),
        (SUITE.replace('"empty"', "3"), "the key 'scenes.0'"),
        (SUITE.replace("[16, 16]", "[0, 16]"), "the key 'size.0'"),
        (SUITE.replace("[16, 16]", "[16]"), "the key 'size"),
        (SUITE.replace("[16, 16]", "[16.5, 16]"), "the key 'size.0'"),
        (SUITE + "steps = true", "the key 'techniques.0.steps'"),
        (SUITE + "steps = 3.0", "the key 'techniques.0.steps'"),
        (SUITE + '[reference]\nrel_error = "0.1"', "the key 'reference.rel_error'"),
        (SUITE + "[parameters]\nsigma_t = true", "the key 'parameters.sigma_t"),
        (SUITE + "a = " + "[" * 100_000, "is not a suite: its values are nested too deeply"),
        (SUITE.replace('"Weng2010"', "3"), "the key 'techniques.0.name'"),
        (SUITE + 'steps = "many"', "the key 'techniques.0.steps'"),
        (SUITE + "stepps = 3", "the key 'techniques.0.stepps'"),
        (SUITE + "[reference]\nrel_error = 0", "the key 'reference.rel_error'"),
        (SUITE + "[reference]\ntime_limit = -1", "the key 'reference.time_limit'"),
        (SUITE + "[parameters]\nsize = 3", "the key 'parameters'"),
        (SUITE.replace('["empty"]', '["empty", "empty.xml"]'), "the key 'scenes': two scenes are called empty."),
        (SUITE + '[[techniques]]\nname = "Weng2010"\nsteps = 128', "empty-Weng2010 stands in the suite twice"),
        (SUITE.replace("Weng2010", "Nobody1999"), "There is no technique 'Nobody1999'"),
        (SUITE + "downsample = 3", "downsample is 3"),
        (SUITE + "steps = 0", "steps is 0"),
        (SUITE + "[parameters]\nsigma = 1", "no use for the parameter $sigma "),
        (SUITE.replace('["empty"]', '["empty", "nowhere"]'), "There is no scene 'nowhere'"),
        ("\0", "is not a suite"),
        (b"\xff\xfe", "is not a suite"),
    ],
)
def test_a_bad_suite_is_refused_before_anything_is_made(airlight, text: str | bytes, words: str) -> None:
    Path("bad.toml").write_bytes(text if isinstance(text, bytes) else text.encode())
    result = airlight("run", "bad.toml", "--out", "runs")
    assert result.code == 2
    assert words in result.err
    assert result.err.strip().count("\n") == 0
    assert not Path("runs").exists()


def test_a_mesh_folder_that_is_not_there_is_named(airlight, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("AIRLIGHT_MESH_DIR", "/nowhere")
    for words in (["render", "donut_dragon", *SMALL, "--out", "a.exr"], ["list"]):
        result = airlight(*words)
        assert result.code == 2
        assert "AIRLIGHT_MESH_DIR names the folder /nowhere, which does not exist" in result.err


@pytest.mark.parametrize(
    "words",
    [
        ["reference", "--out", "a.exr"],
        ["draw"],
        ["render", "empty", "--sise", "3"],
        ["render", "empty", "--size", "8", "--out", "a.exr"],
        ["render", "empty", "--steps", "many", "--out", "a.exr"],
    ],
)
def test_a_command_line_that_cannot_be_read_is_code_2(airlight, words: list[str]) -> None:
    result = airlight(*words)
    assert result.code == 2
    assert "Error: " in result.err
    assert "Traceback" not in result.err


def test_an_interrupt_is_code_130(airlight, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("experiments.listing.listing", interrupted)
    assert airlight("list").code == 130
