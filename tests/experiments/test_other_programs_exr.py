"""EXR files as other programs write them: their windows, names, parts, colours, and what none of ours can be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from subsampled_exr import write_subsampled

from experiments.pictures import Picture, read_picture
from scenes.errors import InputError

COLOUR = np.random.default_rng(5).uniform(0, 2, (5, 9, 3)).astype(np.float32)
GREY = COLOUR[..., 0].copy()
# linear sRGB from and to CIE XYZ at D65, as IEC 61966-2-1 prints them, and ACES 2065-1's matrix to XYZ at its white
# (SMPTE ST 2065-1); Bradford's response (Lam 1985)
XYZ_TO_SRGB = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])
ACES_TO_XYZ = np.array(
    [[0.9525523959, 0.0, 0.0000936786], [0.3439664498, 0.7281660966, -0.0721325464], [0.0, 0.0, 1.0088251844]]
)
ACES = (0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767)
REC709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def window(left: int, top: int, right: int, bottom: int) -> tuple[np.ndarray, np.ndarray]:
    return np.array([left, top], np.int32), np.array([right, bottom], np.int32)


@pytest.fixture
def read(tmp_path: Path):
    """Write channels by OpenEXR's own library and read them as a picture."""

    def written(channels: dict, **header: object) -> Picture:
        OpenEXR.File(header, channels).write(str(tmp_path / "a.exr"))
        return read_picture(tmp_path / "a.exr")

    return written


def planes(prefix: str = "", letters: str = "RGB", image: np.ndarray = COLOUR) -> dict[str, np.ndarray]:
    return {f"{prefix}{letter}": image[..., place].copy() for place, letter in enumerate(letters)}


@pytest.mark.parametrize("names", ["RGB", "rgb"])
@pytest.mark.parametrize("beside", [{}, {"A": GREY}, {"Z": GREY}, {"normals.X": GREY, "normals.Y": GREY}])
def test_plain_colours_are_the_composite(read, names: str, beside: dict) -> None:
    found = read(planes(letters=names) | beside)
    assert found.layers.keys() == {"composite"}
    np.testing.assert_array_equal(found.layers["composite"], COLOUR)
    assert not found.notices


@pytest.mark.parametrize(
    ("channels", "taken"),
    [
        (planes("Beauty."), "Beauty"),
        (planes("left."), "left"),
        (planes("ViewLayer.Combined.") | planes("ViewLayer.VolumeDir.", image=COLOUR + 1), "ViewLayer.Combined"),
        (planes("FinalImage.") | planes("albedo.", image=COLOUR + 1) | {"depth.Z": GREY}, "FinalImage"),
    ],
)
def test_named_colours_are_the_composite_where_it_is_plain_which(read, channels: dict, taken: str) -> None:
    found = read(channels)
    np.testing.assert_array_equal(found.layers["composite"], COLOUR)
    np.testing.assert_array_equal(found.layers[taken], COLOUR)
    assert [f"The layer {taken} of" in notice for notice in found.notices] == [True]


@pytest.mark.parametrize(
    "channels",
    [
        planes("left.") | planes("right."),
        planes("rgba.") | planes("beauty."),
        planes("scattering."),
        {"Z": GREY},
        {"A": GREY},
        {"depth.Z": GREY},
        {"R": GREY, "G": GREY},
    ],
)
def test_nothing_is_the_composite_where_nobody_says_so(read, channels: dict) -> None:
    found = read(channels)
    assert "composite" not in found.layers
    assert "" not in found.layers
    assert not found.notices


@pytest.mark.parametrize("channels", [{"Y": GREY}, {"Y": GREY, "A": GREY}, {"beauty.Y": GREY}])
def test_a_luminance_is_a_grey_picture_and_says_so(read, channels: dict) -> None:
    found = read(channels)
    np.testing.assert_array_equal(found.layers["composite"], np.stack([GREY] * 3, axis=2))
    assert "taken for a grey picture" in found.notices[-1]


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.uint32])
def test_tiles_and_every_type_of_pixel(read, kind: type) -> None:
    image = np.random.default_rng(1).integers(0, 2000, (70, 90, 3)).astype(kind)
    tiles = {"type": OpenEXR.tiledimage, "tiles": OpenEXR.TileDescription()}
    for header in ({}, tiles):
        np.testing.assert_array_equal(read(planes(image=image), **header).layers["composite"], image)


def test_a_window_of_the_picture_is_put_in_its_place(read) -> None:
    whole = window(2, 3, 10, 7)
    assert not read({"RGB": COLOUR}, dataWindow=whole, displayWindow=whole).notices
    # beyond the picture: what engines call overscan
    found = read({"RGB": COLOUR}, dataWindow=whole, displayWindow=window(3, 5, 9, 7))
    np.testing.assert_array_equal(found.layers["composite"], COLOUR[2:, 1:8])
    assert not found.notices
    # a part of the picture, in its place
    found = read({"RGB": COLOUR}, dataWindow=whole, displayWindow=window(0, 1, 12, 9))
    expected = np.zeros((9, 13, 3), np.float32)
    expected[2:7, 2:11] = COLOUR
    np.testing.assert_array_equal(found.layers["composite"], expected)
    assert f"holds nothing for {9 * 13 - 5 * 9} of its pixels" in found.notices[0]
    # to the left and below, past each other's edge, and nowhere near
    found = read({"RGB": COLOUR}, dataWindow=whole, displayWindow=window(0, 6, 5, 20))
    expected = np.zeros((15, 6, 3), np.float32)
    expected[:2, 2:] = COLOUR[3:, :4]
    np.testing.assert_array_equal(found.layers["composite"], expected)
    assert not read({"RGB": COLOUR}, dataWindow=whole, displayWindow=window(40, 0, 45, 9)).layers["composite"].any()


def test_parts_are_layers(tmp_path: Path) -> None:
    def part(name: str, channels: dict, **header: object) -> OpenEXR.Part:
        return OpenEXR.Part({"type": OpenEXR.scanlineimage, **header}, channels, name)

    def read_parts(*parts: OpenEXR.Part) -> Picture:
        OpenEXR.File(list(parts)).write(str(tmp_path / "a.exr"))
        return read_picture(tmp_path / "a.exr")

    two = read_parts(part("fog", {"RGB": COLOUR + 1}), part("beauty", {"RGB": COLOUR}))
    assert two.layers.keys() == {"fog", "beauty", "composite"}
    np.testing.assert_array_equal(two.layers["fog"], COLOUR + 1)
    np.testing.assert_array_equal(two.layers["composite"], COLOUR)
    # a part that repeats its name in its channels, and one of another layer
    three = read_parts(part("rgba", planes("rgba.")), part("rest", planes("fog.") | {"depth.Z": GREY}))
    assert three.layers.keys() == {"rgba", "composite", "rest.fog", "rest.depth"}


def test_of_two_parts_with_one_layer_the_first_counts(tmp_path: Path) -> None:
    # a layer of a part, and a part of the layer's whole name
    named = {f"b.{letter}": plane for letter, plane in zip("RGB", np.moveaxis(COLOUR, 2, 0).copy(), strict=True)}
    parts = [("a", named), ("a.b", {"RGB": COLOUR + 1})]
    for order, expected in ((parts, COLOUR), (parts[::-1], COLOUR + 1)):
        found = [OpenEXR.Part({"type": OpenEXR.scanlineimage}, channels, name) for name, channels in order]
        OpenEXR.File(found).write(str(tmp_path / "a.exr"))
        np.testing.assert_array_equal(read_picture(tmp_path / "a.exr").layers["a.b"], expected)


def test_other_primaries_are_converted(read) -> None:
    assert not read({"RGB": COLOUR}, chromaticities=REC709).notices
    found = read({"RGB": COLOUR}, chromaticities=ACES)
    white_709, white_aces = np.linalg.inv(XYZ_TO_SRGB) @ np.ones(3), ACES_TO_XYZ @ np.ones(3)
    gain = np.diag((BRADFORD @ white_709) / (BRADFORD @ white_aces))
    matrix = XYZ_TO_SRGB @ np.linalg.inv(BRADFORD) @ gain @ BRADFORD @ ACES_TO_XYZ
    # the standards print four digits; measured: 5.2e-4
    np.testing.assert_allclose(found.layers["composite"], COLOUR @ matrix.T, atol=1e-3)
    assert np.abs(found.layers["composite"] - COLOUR).max() > 0.3
    assert "other primaries" in found.notices[0]
    # white stays white
    grey = read({"RGB": np.ones((2, 3, 3), np.float32)}, chromaticities=ACES)
    np.testing.assert_allclose(grey.layers["composite"], 1, atol=1e-6)  # measured: 0


@pytest.mark.parametrize("wrong", [(0.3,) * 8, (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.0, 0.0), (np.nan,) * 8])
def test_colours_of_no_space_are_refused(read, wrong: tuple) -> None:
    with pytest.raises(InputError, match="has chromaticities of no colour space"):
        read({"RGB": COLOUR}, chromaticities=wrong)


def test_pixels_that_are_not_square_are_refused(read) -> None:
    with pytest.raises(InputError, match="has pixels 2 times as wide as high"):
        read({"RGB": COLOUR}, pixelAspectRatio=2.0)
    assert read({"RGB": COLOUR}, pixelAspectRatio=1.00001).layers


def test_a_picture_that_nobody_could_compare_is_refused(read) -> None:
    with pytest.raises(InputError, match="has 1000000 x 1000000 pixels, and airlight takes 16384 on each side"):
        read({"RGB": COLOUR}, displayWindow=window(0, 0, 999_999, 999_999))


def test_deep_pixels_are_refused(tmp_path: Path) -> None:
    samples = np.empty((5, 9), object)
    for place in np.ndindex(5, 9):
        samples[place] = np.arange(2, dtype=np.float32)
    header = {"type": OpenEXR.deepscanline, "compression": OpenEXR.ZIPS_COMPRESSION}
    OpenEXR.File(header, {"Z": samples}).write(str(tmp_path / "deep.exr"))
    with pytest.raises(InputError, match=r"deep\.exr holds deep pixels"):
        read_picture(tmp_path / "deep.exr")


def test_subsampled_colours_are_refused(tmp_path: Path) -> None:
    image = np.ones((4, 6), np.float32)
    write_subsampled(tmp_path / "whole.exr", {"Y": (image, 1), "A": (image, 1)})
    assert (read_picture(tmp_path / "whole.exr").layers["composite"] == 1).all()
    write_subsampled(tmp_path / "yc.exr", {"Y": (image, 1), "RY": (image[::2, ::2], 2), "BY": (image[::2, ::2], 2)})
    with pytest.raises(InputError, match=r"the channel BY at only every 2 x 2 pixels; save it as RGB"):
        read_picture(tmp_path / "yc.exr")
