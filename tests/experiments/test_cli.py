"""The command line: what works, and help that costs nothing."""

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
from flat_exr import picture

from experiments import cli
from experiments.exr import read_exr, write_exr
from gpu_impl.device import shared_device
from gpu_impl.techniques import CHOICES, RANGES, Technique

COMMANDS = ["doctor", "list", "render", "reference", "compare", "run", "audit", "atlas", "quadrature", "spectra"]
EXECUTABLE = Path(sys.executable).parent / "airlight"
SMALL = ["--size", "16", "16"]


# --- what works ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("command", [*COMMANDS, "meshes list", "meshes fetch"])
def test_help_has_an_example(airlight, command: str) -> None:
    result = airlight(*command.split(), "--help")
    assert result.code == 0
    assert f"Example: airlight {command}" in " ".join(result.out.split())


def test_list_names_what_there_is(airlight) -> None:
    result = airlight("list")
    assert result.code == 0
    for name in ("donut_dragon", "Weng2010", "lit_intervals", "quadrature", "weng2010:printed", "quick", "torus.ply"):
        assert name in result.out
    for name, known in CHOICES.items():
        assert name in result.out or name == "airlight"
        assert all(str(choice) in result.out for choice in known)
    assert all(name in result.out and str(most) in result.out for name, (_, most) in RANGES.items())


def test_doctor_says_that_shadow_polygons_cannot_be_drawn(airlight, monkeypatch: pytest.MonkeyPatch) -> None:
    for slow in ("_mitsuba", "_meshes"):
        monkeypatch.setattr(f"experiments.doctor.{slow}", list)
    assert airlight("doctor").code == 0
    monkeypatch.setitem(shared_device().context.info, "GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS", 1)
    result = airlight("doctor")
    assert result.code == 1
    said = " ".join(result.out.replace("│", " ").split())
    assert "shadow polygons" in said
    assert "lit_intervals:unb" in said


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
    monkeypatch.setattr("experiments.compare.write_sheets", lambda *arguments: notes.append(arguments[-2]))
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

    monkeypatch.setattr("reference.cache.entry_file.write", full)
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
