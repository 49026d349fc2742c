"""The public face, as its docstring and a script use it."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import numpy as np
import pytest

import airlight
from gpu_impl.frame import Frame
from reference.estimate import Reference
from scenes.model import Scene


def test_the_docstrings_example() -> None:
    scene = airlight.load("sphere", size=(32, 32))
    frame = airlight.render(scene, "Weng2010")
    truth = airlight.reference(scene, rel_error=0.02)
    metrics = airlight.compare(frame, truth, layer="scattering")
    # measured: 3e-4
    assert metrics.rel_50 < 0.05
    assert frame.composite.shape == truth.composite.shape == (32, 32, 3)
    np.testing.assert_array_equal(frame.composite, frame.surface + frame.scattering)


def test_settings_and_parameters_reach_what_they_name() -> None:
    scene = airlight.load("empty", size=(8, 8), sigma_t=0.3)
    frame = airlight.render(scene, "uniform_march+quadrature", steps=9, shadow_map=64, downsample=2)
    assert (frame.technique.steps, frame.technique.shadow_map, frame.technique.downsample) == (9, 64, 2)
    thinner = airlight.render(airlight.load("empty", size=(8, 8), sigma_t=0.03), "uniform_march+quadrature")
    assert frame.scattering.mean() != pytest.approx(thinner.scattering.mean(), rel=0.1)


def test_a_known_error_lowers_the_bias() -> None:
    test, truth = np.full((4, 4, 3), 1.1), np.ones((4, 4, 3))
    assert airlight.compare(test, truth).bias == pytest.approx(0.1)
    assert airlight.compare(test, truth, np.full((4, 4, 3), 0.06)).bias == pytest.approx(0.08)


@pytest.fixture(scope="module")
def pair() -> tuple[Scene, Frame, Reference]:
    scene = airlight.load("sphere", size=(24, 16))
    return scene, airlight.render(scene), airlight.reference(scene, rel_error=0.2)


def test_arrays_have_the_names_of_the_files_layers(tmp_path: Path, pair: tuple[Scene, Frame, Reference]) -> None:
    scene, frame, truth = pair
    assert frame.layers["scattering"] is frame.scattering
    assert truth.layers["surface"] is truth.surface
    for name, result in (("f.exr", frame), ("r.exr", truth)):
        airlight.save(tmp_path / name, scene, result)
        read = airlight.read(tmp_path / name)
        assert read.layers.keys() == result.layers.keys()
        for layer, image in result.layers.items():
            np.testing.assert_array_equal(read.layers[layer], image.astype(np.float32))
        assert read.metadata["scene"] == "sphere"
    airlight.save(str(tmp_path / "c.exr"), scene, frame, truth)
    both = airlight.read(str(tmp_path / "c.exr")).layers
    np.testing.assert_array_equal(both["reference.scattering"], truth.scattering.astype(np.float32))
    np.testing.assert_array_equal(both["scattering"], frame.scattering)


def test_results_files_and_arrays_compare_alike(tmp_path: Path, pair: tuple[Scene, Frame, Reference]) -> None:
    scene, frame, truth = pair
    by_hand = airlight.compare(frame.scattering, truth.scattering, truth.standard_error("scattering"))
    assert airlight.compare(frame, truth, layer="scattering") == by_hand
    assert airlight.compare(frame.scattering, truth, layer="scattering") == by_hand
    # the reference's own noise is taken off: without it the bias is the whole error
    assert by_hand.bias < airlight.compare(frame.scattering, truth.scattering).bias
    assert airlight.compare(frame, truth) == airlight.compare(frame, truth, layer="composite")
    airlight.save(tmp_path / "f.exr", scene, frame)
    airlight.save(tmp_path / "r.exr", scene, truth)
    read = airlight.compare(airlight.read(tmp_path / "f.exr"), airlight.read(tmp_path / "r.exr"), layer="scattering")
    # files hold float32
    assert read.rmse == pytest.approx(by_hand.rmse, rel=1e-4)
    assert read.bias == pytest.approx(by_hand.bias, rel=1e-3)
    airlight.compare(frame, truth, layer="scattering", sheet=tmp_path / "s.png")
    assert (tmp_path / "s.png").read_bytes().startswith(b"\x89PNG")


def test_a_notebook_shows_one_line(tmp_path: Path, pair: tuple[Scene, Frame, Reference]) -> None:
    scene, frame, truth = pair
    airlight.save(tmp_path / "f.exr", scene, frame)
    shown = [
        (scene, "sphere 24 x 16"),
        (frame, "Weng2010, 24 x 16"),
        (truth, "standard error"),
        (airlight.compare(frame, truth), "median"),
        (airlight.compare(frame.scattering, np.zeros((16, 24, 3))), "black"),
        (airlight.read(tmp_path / "f.exr"), "f.exr: composite"),
    ]
    for thing, words in shown:
        assert words in repr(thing)
        assert "\n" not in repr(thing)
        assert len(repr(thing)) < 160


def test_a_frame_takes_time() -> None:
    scene = airlight.load("empty", size=(64, 64))
    assert 0 < airlight.milliseconds(scene, "Nishita1987", steps=4) < 60_000


def test_a_picture_of_another_size_is_not_saved_as_the_scenes(
    tmp_path: Path, pair: tuple[Scene, Frame, Reference]
) -> None:
    with pytest.raises(airlight.InputError, match="is not of the scene empty at 8 x 8 pixels"):
        airlight.save(tmp_path / "f.exr", airlight.load("empty", size=(8, 8)), pair[1])
    assert not list(tmp_path.iterdir())


def test_a_picture_of_another_scene_is_neither_saved_nor_compared_as_the_scenes(
    tmp_path: Path, pair: tuple[Scene, Frame, Reference]
) -> None:
    scene, frame, truth = pair
    other = airlight.load("sphere", size=(24, 16), sigma_t=0.3)
    theirs = airlight.render(other, steps=4)
    for save in (
        lambda path: airlight.save(path, other, frame),
        lambda path: airlight.save(path, other, truth),
        lambda path: airlight.save(path, scene, theirs),
        lambda path: airlight.save(path, scene, theirs, truth),
        lambda path: airlight.save(path, other, theirs, truth),
    ):
        with pytest.raises(airlight.InputError, match="is not of the scene sphere at 24 x 16 pixels") as caught:
            save(tmp_path / "f.exr")
        assert "\n" not in str(caught.value)
    for result, beside in ((truth, truth), (frame, frame)):
        with pytest.raises(airlight.InputError, match="a frame may have a reference beside it, and nothing else"):
            airlight.save(tmp_path / "f.exr", scene, result, beside)
    assert not list(tmp_path.iterdir())
    for pictures in ((theirs, truth), (theirs, frame)):
        with pytest.raises(airlight.InputError, match="is not of the reference's scene"):
            airlight.compare(*pictures)
    # the numbers alone say nothing of where they come from
    assert airlight.compare(theirs.composite, truth).rmse > 0


def test_the_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    example = Path(airlight.__file__).parent / "examples" / "compare_techniques.py"
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(example), "--size", "24", "16", "--rel-error", "0.2"])
    runpy.run_path(str(example), run_name="__main__")
    table = capsys.readouterr().out
    assert all(name in table for name in ("sphere 24 x 16", "Weng2010", "Nishita1987"))
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".exr", ".exr", ".png", ".png"]
    monkeypatch.setattr(sys, "argv", [str(example), "--size", "0", "5"])
    with pytest.raises(SystemExit) as end:
        runpy.run_path(str(example), run_name="__main__")
    assert end.value.code == 2
    assert capsys.readouterr().err.startswith("An image of 0 x 5 pixels cannot be made")


def test_what_cannot_be_used_is_one_exception(tmp_path: Path) -> None:
    for call in (
        lambda: airlight.load(tmp_path / "none.xml"),
        lambda: airlight.render(airlight.load("empty", size=(8, 8)), "Nobody1999"),
        lambda: airlight.reference(airlight.load("empty", size=(8, 8)), rel_error=2),
        lambda: airlight.render(airlight.load("empty", size=(8, 8)), stepps=3),
        lambda: airlight.render(airlight.load("empty", size=(8, 8)), visibility="nothing"),
        lambda: airlight.compare(np.ones((2, 2, 3)), np.ones((3, 2, 3))),
        lambda: airlight.compare(np.ones((2, 2, 3)), np.ones((2, 2, 3)), layer="scattering"),
        lambda: airlight.read(tmp_path / "none.exr"),
    ):
        with pytest.raises(airlight.InputError):
            call()
