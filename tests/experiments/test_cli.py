"""The command line: one sentence and exit code 2 for what cannot be used, and help that costs nothing."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from dataclasses import MISSING, fields
from io import BytesIO, TextIOWrapper
from pathlib import Path

import numpy as np
import pytest
import typer

from experiments import cli
from experiments.exr import read_exr, write_exr
from gpu_impl.techniques import Technique

COMMANDS = ["doctor", "list", "render", "reference", "compare", "run"]
EXECUTABLE = Path(sys.executable).parent / "airlight"
# what Python makes of a byte that is not UTF-8
NO_TEXT = os.fsdecode(b"\xff")
SMALL = ["--size", "16", "16"]
SUITE = 'scenes = ["empty"]\nsize = [16, 16]\n[[techniques]]\nname = "Weng2010"\n'


class Result:
    """What a command answered."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code, self.out, self.err = code, out, err


@pytest.fixture
def airlight(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    """Run a command line in this process."""

    def run(*words: object) -> Result:
        monkeypatch.setattr(sys, "argv", ["airlight", *map(str, words)])
        code = 0
        try:
            cli.main()
        except SystemExit as end:
            code = int(end.code or 0)
        captured = capsys.readouterr()
        return Result(code, captured.out, captured.err)

    return run


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def picture(path: str, value: float = 1.0, size: tuple[int, int] = (4, 6), layer: str = "composite") -> str:
    write_exr(Path(path), {layer: np.full((*size, 3), value, np.float32)}, {})
    return path


# --- what cannot be used ---------------------------------------------------------------------------------------------


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
        (["render", "empty", *SMALL, "-p", "phase=rayleigh", "--out", "a.exr"], "takes the phase function isotropic"),
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
        (["run", "nowhere"], "There is no suite 'nowhere': give the path of a TOML file or one of quick"),
        (["run", "."], "There is no suite '.'"),
        (["run", "n" * 300], "There is no suite"),
        (["run", "text.exr"], "text.exr is not a suite"),
        (["run", "good.exr"], "good.exr is not a suite"),
        (["run", "suite.toml", "--out", "text.exr"], "cannot hold the results"),
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
        (SUITE.replace("[16, 16]", "[16]"), "the key 'size.1'"),
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
        (SUITE + '[[techniques]]\nname = "Weng2010"\nsteps = 128', "'techniques': Weng2010 stands there twice"),
        (SUITE.replace("Weng2010", "Nobody1999"), "There is no technique 'Nobody1999'"),
        (SUITE + "downsample = 3", "downsample is 3"),
        (SUITE + "steps = 0", "steps is 0"),
        (SUITE + '[parameters]\nphase = "hg"', "takes the phase function isotropic"),
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
        ["reference", "empty"],
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


# --- what works ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", [*COMMANDS, "meshes list", "meshes fetch"])
def test_help_has_an_example(airlight, command: str) -> None:
    result = airlight(*command.split(), "--help")
    assert result.code == 0
    assert f"Example: airlight {command}" in " ".join(result.out.split())


def test_list_names_what_there_is(airlight) -> None:
    result = airlight("list")
    assert result.code == 0
    for name in ("donut_dragon", "Weng2010", "lit_intervals", "quadrature", "quick", "torus.ply"):
        assert name in result.out


def test_render_reference_and_compare(airlight) -> None:
    assert (
        airlight(
            "render", "empty", *SMALL, "-p", "sigma_t=0.2", "--technique", "lit_intervals+quadrature", "--out", "t.exr"
        ).code
        == 0
    )
    made = airlight("reference", "empty", *SMALL, "-p", "sigma_t=0.2", "--rel-error", "0.05", "--out", "r.exr")
    assert made.code == 0
    assert "relative standard error" in made.out
    layers, metadata = read_exr(Path("t.exr"))
    assert layers["composite"].shape == (16, 16, 3)
    assert json.loads(metadata["parameters"]) == {"sigma_t": "0.2"}
    assert metadata["technique"] == "lit_intervals+quadrature"
    result = airlight("compare", "t.exr", "r.exr", "--layer", "scattering", "--heatmap", "heat.png", "--json")
    assert result.code == 0
    numbers = json.loads(result.out)
    assert numbers["layer"] == "scattering"
    # what is left is the reference's own noise, a few tenths of a percent
    assert numbers["rel_95"] < 0.05
    assert abs(numbers["image_mean_rel"]) < 0.01
    assert Path("heat.png").read_bytes().startswith(b"\x89PNG")
    again = airlight("reference", "empty", *SMALL, "-p", "sigma_t=0.2", "--rel-error", "0.05", "--out", "r2.exr")
    assert "from the cache" in again.out


def test_render_again(airlight) -> None:
    assert airlight("render", "empty", *SMALL, "-p", "sigma_t=0.2", "--steps", "9", "--out", "f.exr").code == 0
    before = Path("f.exr").read_bytes()
    result = airlight("render", "--again", "f.exr")
    assert result.code == 0
    assert result.out.startswith("f-again.exr: the same pixels as f.exr, bit for bit in composite, scattering")
    assert Path("f.exr").read_bytes() == before
    first, again = read_exr(Path("f.exr")), read_exr(Path("f-again.exr"))
    for layer, image in first[0].items():
        np.testing.assert_array_equal(again[0][layer], image)
    assert first[1] | {"date": ""} == again[1] | {"date": ""}
    layers, metadata = first
    layers["surface"][4, 5, 0] += 0.25
    write_exr(Path("g.exr"), layers, metadata)
    result = airlight("render", "empty", "--again", "g.exr", "--out", "h.exr")
    assert result.code == 1
    assert "h.exr: 1 of 256 pixels differ from g.exr, by at most 0.25, in surface, though drawn by" in result.out
    write_exr(Path("g.exr"), layers, metadata | {"gl_version": "another"})
    result = airlight("render", "--again", "g.exr", "--out", "h.exr")
    assert result.code == 0
    assert "gl_version was another and is" in result.out
    Path("link.exr").symlink_to("f.exr")
    result = airlight("render", "--again", "f.exr", "--out", "link.exr")
    assert result.code == 2
    assert "choose another --out" in result.err


def test_every_setting_of_a_technique_is_an_option() -> None:
    options = {parameter.name for parameter in typer.main.get_command(cli.app).commands["render"].params}
    settings = {field.name for field in fields(Technique) if field.default is not MISSING}
    assert settings
    assert settings <= options


def test_compare_says_which_meshes_are_stand_ins(airlight, monkeypatch: pytest.MonkeyPatch) -> None:
    write_exr(Path("r.exr"), {"composite": np.ones((4, 6, 3), np.float32)}, {"stand_ins": "dragon.ply"})
    notes = []
    monkeypatch.setattr("experiments.compare.write_sheet", lambda *arguments: notes.append(arguments[-1]))
    assert airlight("compare", picture("t.exr"), "r.exr", "--heatmap", "h.png").code == 0
    assert notes == ["stand-in for dragon.ply"]


def test_compare_warns_of_two_scenes(airlight) -> None:
    for name, sigma in (("a.exr", "0.1"), ("b.exr", "0.2"), ("long.exr", "9" * 100_000)):
        metadata = {"scene": "sphere", "scene_digest": sigma, "parameters": json.dumps({"sigma_t": sigma})}
        write_exr(Path(name), {"composite": np.ones((4, 6, 3), np.float32)}, metadata)
    result = airlight("compare", "a.exr", "b.exr", "--json")
    assert result.code == 0
    assert json.loads(result.out)["rmse"] == 0
    for words in ("a.exr is of the scene sphere", '{"sigma_t": "0.1"}', "b.exr is of the scene", '{"sigma_t": "0.2"}'):
        assert words in result.err
    assert len(airlight("compare", "a.exr", "long.exr").err) < 1000
    # one scene, or a file that does not say
    assert airlight("compare", "a.exr", "a.exr").err == airlight("compare", "a.exr", picture("c.exr")).err == ""


def test_a_reference_that_the_full_cache_cannot_keep_is_written_all_the_same(
    airlight, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("reference.cache.np.savez", full)
    result = airlight("reference", "empty", *SMALL, "--rel-error", "0.2", "--out", "r.exr")
    assert result.code == 0
    assert "The reference is not kept for the next time: " in result.err
    assert "No space left on device" in result.err
    assert read_exr(Path("r.exr"))[0]["composite"].any()
    assert [path for path in (tmp_path / "cache").rglob("*") if path.is_file()] == []


def test_a_name_that_the_terminal_cannot_show_is_no_matter(airlight, monkeypatch: pytest.MonkeyPatch) -> None:
    streams = {name: TextIOWrapper(BytesIO(), "ascii") for name in ("stdout", "stderr")}
    for name, stream in streams.items():
        monkeypatch.setattr(sys, name, stream)
    assert airlight("compare", picture("π.exr"), picture("b.exr"), "--heatmap", "π.png").code == 0
    assert airlight("compare", "π.png", "b.exr").code == 2
    for stream in streams.values():
        stream.flush()
    assert b"Heat map: ?.png\n" in streams["stdout"].buffer.getvalue()
    assert streams["stderr"].buffer.getvalue().startswith(b"airlight: ?.png is not an OpenEXR file")


def test_brackets_in_a_name_are_no_markup(airlight) -> None:
    Path("shots[").mkdir()
    name = "shots[/1].exr"
    result = airlight("render", "empty", "--size", "4", "4", "--out", name)
    assert result.code == 0
    assert result.out.startswith(name)
    assert Path(name).is_file()


def test_a_sheet_harms_no_file_beside_it(airlight) -> None:
    Path("heat.part").write_text("mine")
    picture("a.exr")
    assert airlight("compare", "a.exr", "a.exr", "--heatmap", "heat.png").code == 0
    assert sorted(path.name for path in Path().iterdir()) == ["a.exr", "heat.part", "heat.png"]
    assert Path("heat.part").read_text() == "mine"


# --- as a program of its own -----------------------------------------------------------------------------------------


def test_the_installed_program_ends_in_a_sentence() -> None:
    command = [EXECUTABLE, "render", "nowhere", "--out", "a.exr"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert run.returncode == 2
    assert run.stdout == ""
    assert run.stderr.count("\n") == 1
    assert run.stderr.startswith("airlight: There is no scene 'nowhere'")


@pytest.mark.parametrize("words", [["--help"], ["render", "--help"], ["meshes", "--help"]])
def test_help_loads_nothing_heavy(words: list[str]) -> None:
    code = (
        "import sys; from experiments.cli import main; sys.argv = ['airlight', *sys.argv[1:]]\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "print(*sys.modules, file=sys.stderr)"
    )
    run = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, timeout=60, check=True)
    assert "Usage: airlight" in run.stdout
    loaded = {name.split(".")[0] for name in run.stderr.split()}
    assert "experiments" in loaded
    heavy = {"numpy", "mitsuba", "drjit", "moderngl", "matplotlib", "polars", "rich", "OpenEXR", "skimage"}
    assert not loaded & heavy
