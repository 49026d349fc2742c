"""What is written is what another program reads, and a failed write leaves what was there."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from plain_exr import read_plain
from scene_files import point, sphere, write_scene

import airlight
from experiments.exr import check_writable, read_exr, write_exr
from scenes.errors import InputError
from scenes.mitsuba_setup import mitsuba

RNG = np.random.default_rng(11)
# values of every size that float32 has, and a picture that is neither square nor symmetric
COLOUR = (RNG.normal(size=(5, 9, 3)) * 10.0 ** RNG.integers(-30, 30, (5, 9, 3))).astype(np.float32)
DEPTH = RNG.uniform(0, 1e5, (5, 9)).astype(np.float32)
LAYERS = {"composite": COLOUR, "standard_error.scattering": COLOUR[::-1], "depth": DEPTH}


def test_a_round_trip_keeps_every_bit_and_the_metadata(tmp_path: Path) -> None:
    metadata = {"scene": "nébel", "sizes": 3, "empty": "", "long": "x" * 5000}
    write_exr(tmp_path / "a.exr", LAYERS, metadata)
    layers, read = read_exr(tmp_path / "a.exr")
    assert layers.keys() == LAYERS.keys()
    for name, image in LAYERS.items():
        assert layers[name].dtype == np.float32
        np.testing.assert_array_equal(layers[name], image)
    assert read == {key: str(value) for key, value in metadata.items()}


def test_mitsuba_reads_the_same(tmp_path: Path) -> None:
    mi = mitsuba()
    write_exr(tmp_path / "a.exr", LAYERS, {"scene": "empty"})
    bitmap = mi.Bitmap(str(tmp_path / "a.exr"))
    names = [field.name for field in bitmap.struct_()]
    expected = {f"{layer}.{letter}" for layer in ("composite", "standard_error.scattering") for letter in "RGB"}
    assert set(names) == expected | {"depth.Z"} | set("RGB")
    planes = dict(zip(names, np.moveaxis(np.array(bitmap), -1, 0), strict=True))
    assert bitmap.component_format() == mi.Struct.Type.Float32
    # row 0 is the top one in Mitsuba too
    for place, letter in enumerate("RGB"):
        np.testing.assert_array_equal(planes[f"composite.{letter}"], COLOUR[..., place])
    np.testing.assert_array_equal(planes["depth.Z"], DEPTH)
    assert bitmap.metadata()["airlight:scene"] == "empty"
    # what Mitsuba itself takes for the picture, and for its layers
    parts = dict(bitmap.split())
    assert parts.keys() == {"<root>", "composite", "standard_error.scattering", "depth"}
    np.testing.assert_array_equal(np.array(parts["<root>"]), COLOUR)
    np.testing.assert_array_equal(np.array(parts["composite"]), COLOUR)


def test_a_reader_of_our_own_reads_the_same(tmp_path: Path) -> None:
    # more rows than one compressed block holds, and one layer that shrinks
    tall = np.tile(COLOUR, (5, 1, 1))
    layers = {
        "composite": tall,
        "error.surface": np.zeros_like(tall),
        "depth": tall[..., 0],
        "lit_intervals": tall[..., 1],
    }
    write_exr(tmp_path / "a.exr", layers, {"scene": "nébel", "empty": ""})
    plain = read_plain(tmp_path / "a.exr")
    expected = {f"{layer}.{letter}" for layer in ("composite", "error.surface") for letter in "RGB"}
    assert plain.channels.keys() == expected | {"R", "G", "B", "depth.Z", "lit_intervals.Y"}
    for place, letter in enumerate("RGB"):
        for name in (letter, f"composite.{letter}"):
            np.testing.assert_array_equal(plain.channels[name], tall[..., place])
        assert not plain.channels[f"error.surface.{letter}"].any()
    np.testing.assert_array_equal(plain.channels["depth.Z"], tall[..., 0])
    np.testing.assert_array_equal(plain.channels["lit_intervals.Y"], tall[..., 1])
    assert plain.texts["airlight:scene"] == "nébel"
    assert plain.texts["airlight:empty"] == ""


def test_a_case_holds_the_stated_layers_the_right_way_up(tmp_path: Path) -> None:
    # up and to the left, before a camera that looks along -z
    scene = write_scene(tmp_path, emitters=point(-1.2, 1, 0), shapes=sphere(1, -1, 0, 0.5), size=(24, 16))
    frame, truth = airlight.render(scene, steps=40), airlight.reference(scene, rel_error=0.1)
    airlight.save(tmp_path / "a.exr", scene, frame, truth)
    plain = read_plain(tmp_path / "a.exr")
    colours = ["composite", "scattering", "surface"]
    colours += [f"{group}.{layer}" for group in ("reference", "error", "standard_error") for layer in colours]
    singles = {"depth.Z", "lit_intervals.Y"}
    assert plain.channels.keys() == {f"{layer}.{letter}" for layer in colours for letter in "RGB"} | singles | set(
        "RGB"
    )
    for layer in ("scattering", "reference.scattering"):
        row, column = np.unravel_index(np.argmax(plain.channels[f"{layer}.G"]), (16, 24))
        assert row < 8
        assert column < 12
    # the sphere is down and to the right, and nearer than the end of the ray
    row, column = np.unravel_index(np.argmin(plain.channels["depth.Z"]), (16, 24))
    assert row >= 8
    assert column >= 12
    for key in ("scene", "scene_digest", "parameters", "technique", "steps", "seeds", "mitsuba", "gl_renderer"):
        assert plain.texts[f"airlight:{key}"], key
    assert plain.texts["airlight:steps"] == "40"


def test_another_programs_plain_picture_is_the_composite(tmp_path: Path) -> None:
    mi = mitsuba()
    mi.Bitmap(COLOUR).write(str(tmp_path / "plain.exr"))
    layers, metadata = read_exr(tmp_path / "plain.exr")
    assert layers.keys() == {"composite"}
    np.testing.assert_array_equal(layers["composite"], COLOUR)
    assert metadata == {}


def test_a_named_composite_goes_before_plain_channels(tmp_path: Path) -> None:
    channels = {name: np.full((2, 3), value, np.float32) for value, name in enumerate(["R", "G", "B", "A", "depth.Y"])}
    channels |= {f"composite.{letter}": np.full((2, 3), 7, np.float32) for letter in "RGB"}
    channels |= {f"normal.{letter}": np.zeros((2, 3), np.float32) for letter in "XYZ"}
    OpenEXR.File({}, channels).write(str(tmp_path / "a.exr"))
    layers, _ = read_exr(tmp_path / "a.exr")
    assert layers.keys() == {"composite", "depth"}
    assert (layers["composite"] == 7).all()
    assert layers["depth"].shape == (2, 3)


def test_half_floats_are_widened(tmp_path: Path) -> None:
    half = COLOUR.clip(-100, 100).astype(np.float16)
    OpenEXR.File({}, {"RGB": half}).write(str(tmp_path / "half.exr"))
    np.testing.assert_array_equal(read_exr(tmp_path / "half.exr")[0]["composite"], half.astype(np.float32))


def test_a_rewrite_replaces_the_file(tmp_path: Path) -> None:
    write_exr(tmp_path / "a.exr", {"depth": DEPTH}, {})
    write_exr(tmp_path / "a.exr", {"depth": DEPTH + 1}, {})
    np.testing.assert_array_equal(read_exr(tmp_path / "a.exr")[0]["depth"], DEPTH + 1)
    assert [path.name for path in tmp_path.iterdir()] == ["a.exr"]


def test_a_failing_write_leaves_the_old_file_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_exr(tmp_path / "a.exr", {"depth": DEPTH}, {})
    before = (tmp_path / "a.exr").read_bytes()

    def half_a_file(_: object, name: str) -> None:
        Path(name).write_bytes(before[:100])
        raise RuntimeError("no space left on device")

    monkeypatch.setattr(OpenEXR.File, "write", half_a_file)
    with pytest.raises(InputError, match="no space left on device"):
        write_exr(tmp_path / "a.exr", {"depth": DEPTH}, {})
    assert (tmp_path / "a.exr").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["a.exr"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("missing/a.exr", "does not exist; make it first"),
        ("", "is a folder"),
        ("file/a.exr", "cannot be written"),
        ("pipe", "is no ordinary file"),
        ("device", "is no ordinary file"),
        ("n" * 300, "cannot be written"),
        ("zero\0byte", "cannot be written"),
    ],
)
def test_a_place_that_cannot_be_written_is_refused(tmp_path: Path, name: str, words: str) -> None:
    (tmp_path / "file").write_text("")
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "device").symlink_to("/dev/full")
    before = sorted(tmp_path.iterdir())
    for refuse in (check_writable, lambda path: write_exr(path, {"depth": DEPTH}, {})):
        with pytest.raises(InputError, match=words) as caught:
            refuse(tmp_path / name)
        assert "\n" not in str(caught.value)
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("content", [b"", b"not an EXR", b"v/1\x01\x02\x00\x00\x00", bytes(1000)])
def test_what_is_no_exr_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.exr"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.exr is not an OpenEXR file that can be read\.$"):
        read_exr(path)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_a_file_that_is_cut_short_is_refused(tmp_path: Path, share: float) -> None:
    image = np.random.default_rng(4).normal(size=(64, 64, 3)).astype(np.float32)
    write_exr(tmp_path / "whole.exr", {"composite": image}, {})
    data = (tmp_path / "whole.exr").read_bytes()
    (tmp_path / "cut.exr").write_bytes(data[: int(share * len(data))])
    with pytest.raises(InputError, match="is not an OpenEXR file that can be read"):
        read_exr(tmp_path / "cut.exr")


def test_names_that_are_not_text_are_refused(tmp_path: Path) -> None:
    folder = tmp_path / os.fsdecode(b"\xff")
    folder.mkdir()
    (tmp_path / "link.exr").symlink_to(folder / "a.exr")
    for call in (
        lambda: read_exr(folder / "a.exr"),
        lambda: check_writable(folder / "a.exr"),
        lambda: check_writable(tmp_path / os.fsdecode(b"\xff.exr")),
        lambda: check_writable(tmp_path / "link.exr"),
    ):
        with pytest.raises(InputError, match=r"\\xff.* has a name that is not UTF-8; rename it") as caught:
            call()
        str(caught.value).encode()


@pytest.mark.parametrize("name", ["none.exr", "", "n" * 300])
def test_a_file_that_is_not_there_is_named(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="There is no file"):
        read_exr(tmp_path / name)
