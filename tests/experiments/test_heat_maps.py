"""Heat maps: the scale, the colours, what is shown, and the noise that is marked."""

from __future__ import annotations

from pathlib import Path

import colour
import numpy as np
import pytest
from colour.blindness import matrix_cvd_Machado2009
from matplotlib.image import imread

from experiments.heat_maps.colours import BEYOND, ENTRIES, NOISE_COLOUR, colour_map, table
from experiments.heat_maps.heat_map import NOISE, HeatMap, is_noise, luminance, typical_noise, white
from experiments.heat_maps.scale import Scale, round_up
from experiments.metrics import signed_relative_error
from experiments.sheet import write_sheet, write_sheets

VISIONS = ("", "Deuteranomaly", "Protanomaly")
RELATIVE, ABSOLUTE = HeatMap(True, "relative"), HeatMap(False, "radiance")


def grey(values: np.ndarray) -> np.ndarray:
    """An image (H, W, 3) of these luminances."""
    return np.repeat(np.asarray(values, np.float64)[..., None], 3, axis=2)


def seen(colours: np.ndarray, vision: str) -> np.ndarray:
    """CAM02-UCS (Luo, Cui, Li 2006) of sRGB bytes, as somebody without one kind of cone sees them (Machado 2009)."""
    linear = colour.cctf_decoding(colours / 255, function="sRGB")
    if vision:
        linear = np.clip(linear @ matrix_cvd_Machado2009(vision, 1.0).T, 0, 1)
    return colour.XYZ_to_CAM02UCS(colour.RGB_to_XYZ(linear, "sRGB"))


def halves(name: str, vision: str) -> list[np.ndarray]:
    """Every eighth colour, so that rounding to bytes does not count: from no error to the largest, of either sign."""
    inside = seen(table(colour_map(name)), vision)[:ENTRIES]
    return [inside[128::8], inside[127::-8]] if name == "vik" else [inside[::8]]


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("name", ["vik", "lajolla"])
def test_a_larger_error_is_darker_in_even_steps(name: str, vision: str) -> None:
    for colours in halves(name, vision):
        # measured: -0.63, beside white in vik without red cones, and else -1.17; the hue map has steps of +9
        assert (np.diff(colours[:, 0]) < -0.6).all()
        steps = np.linalg.norm(np.diff(colours, axis=0), axis=1)
        # measured: 1.46 and 0.52, both of lajolla; the hue map has 2.41 and 0.01
        assert steps.max() < 1.5 * steps.mean()
        assert steps.min() > 0.5 * steps.mean()


def test_the_hue_map_is_not_even() -> None:
    # what the two tests above would find in it
    (colours,) = halves("hue", "")
    assert (np.diff(colours[:, 0]) > 0).any()
    steps = np.linalg.norm(np.diff(colours, axis=0), axis=1)
    assert steps.min() < 0.5 * steps.mean()
    blue, red = colour_map("hue")([0.0, 1.0])[:, :3]
    np.testing.assert_allclose([blue, red], [[0, 0, 1], [1, 0, 0]])


@pytest.mark.parametrize("vision", VISIONS)
def test_signs_can_be_told_apart(vision: str) -> None:
    inside = seen(table(colour_map("vik")), vision)[:ENTRIES]
    apart = np.linalg.norm(inside[:112] - inside[:-113:-1], axis=1)
    # measured: 14.4 at 1/8 of the scale, without red cones; 1 is about what is noticed side by side
    assert apart.min() > 14


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("name", ["vik", "lajolla"])
def test_noise_and_what_is_beyond_the_scale_are_in_no_map(name: str, vision: str) -> None:
    colours = seen(table(colour_map(name)), vision)
    inside, (under, over, noise) = colours[:ENTRIES], colours[ENTRIES:]
    beyond = [over, under] if "under" in BEYOND[name] else [over]
    for one in beyond:
        # measured: 16.7, black beside vik without red cones
        assert np.linalg.norm(inside - one, axis=1).min() > 16
        assert np.linalg.norm(noise - one) > 20
    # measured: 12.3, vik without red cones
    assert np.linalg.norm(inside - noise, axis=1).min() > 12


def test_places_on_the_bar() -> None:
    linear = Scale(20, signed=True)
    np.testing.assert_allclose(linear.place([-20, -5, 0, 20, 30]), [0, 0.375, 0.5, 1, 1.25])
    # a linear piece as wide as each of two decades
    log = Scale(100, signed=False, linear=1)
    np.testing.assert_allclose(log.place([0, 0.5, 1, 10, 100, 1000]), np.array([0, 0.5, 1, 2, 3, 4]) / 3)
    signed = Scale(100, signed=True, linear=1)
    np.testing.assert_allclose(signed.place([-100, -1, 0, 10]), np.array([0, 2, 3, 5]) / 6)


@pytest.mark.parametrize("signed", [True, False])
@pytest.mark.parametrize("linear", [None, 0.1])
def test_matplotlib_places_errors_alike(signed: bool, linear: float | None) -> None:
    scale = Scale(100, signed, linear)
    errors = np.linspace(scale.lowest, 100, 1001)
    # measured: 1.1e-16
    np.testing.assert_allclose(scale.norm()(errors), scale.place(errors), rtol=0, atol=1e-15)


def test_ticks() -> None:
    assert Scale(20, signed=True).ticks() == [-20, -15, -10, -5, 0, 5, 10, 15, 20]
    np.testing.assert_allclose(Scale(0.5, signed=False, linear=0.0005).ticks(), [0, 0.0005, 0.005, 0.05, 0.5])


def test_what_is_no_scale_is_refused() -> None:
    for limit in (0, -1, np.inf, np.nan):
        with pytest.raises(ValueError, match="limit must"):
            HeatMap(True, "relative", limit=limit)
    for linear in (0, 1, 2, np.nan):
        with pytest.raises(ValueError, match="linear must"):
            Scale(1, True, linear)
    with pytest.raises(ValueError, match="colours must be 'even' for signed"):
        HeatMap(True, "relative", colours="hue")


@pytest.mark.parametrize(
    ("value", "rounded"),
    [(1, 1), (0.1, 0.1), (0.3, 0.5), (0.0021, 0.005), (51, 100), (5e-7, 5e-7), (5e-324, 1e-300), (0, 1e-300)],
)
def test_round_up(value: float, rounded: float) -> None:
    assert round_up(value) == pytest.approx(rounded, rel=1e-12)


def test_white_is_that_of_the_lit_pixels() -> None:
    """A beam through half a per cent of the picture, and a light that is red alone."""
    beam = np.zeros((20, 20, 3))
    beam[3, 4:6, 0] = 0.2, 0.4
    # the 99th percentile of two red values and four that are 0
    assert white(beam) == pytest.approx(np.percentile([0, 0, 0, 0, 0.2, 0.4], 99))
    assert ABSOLUTE.scale(beam).limit == pytest.approx(0.5)
    assert white(7 * beam) == pytest.approx(7 * white(beam))
    assert white(0 * beam) == 1
    assert ABSOLUTE.scale(np.full_like(beam, 5e-324)).limit > 0


def test_errors_are_those_of_the_metrics() -> None:
    rng = np.random.default_rng(1)
    reference, test = rng.uniform(0, 1, (2, 8, 8, 3))
    reference[:2] = 0
    weights = np.array([0.2126, 0.7152, 0.0722])
    relative = 100 * signed_relative_error(test @ weights, reference @ weights)
    np.testing.assert_allclose(RELATIVE.errors(test, reference), relative, rtol=1e-12)
    absolute = HeatMap(False, "relative").errors(test, reference)
    np.testing.assert_allclose(absolute, np.abs(relative), rtol=1e-12)
    np.testing.assert_allclose(
        HeatMap(True, "radiance").errors(test, reference), test @ weights - reference @ weights, rtol=1e-12
    )
    assert (RELATIVE.errors(test, np.zeros_like(test)) == 0).all()


def test_one_reference_has_one_scale() -> None:
    reference = grey(np.linspace(0, 0.4, 64).reshape(8, 8))
    # the 99th percentile is 0.396
    assert ABSOLUTE.scale(reference) == Scale(0.5, False, 0.0005)
    assert RELATIVE.scale(reference) == RELATIVE.scale(7 * reference) == Scale(100, True, 0.1)
    assert HeatMap(True, "relative", logarithmic=False).scale(reference) == Scale(20, True)
    assert HeatMap(False, "radiance", False).scale(reference).limit == pytest.approx(0.1)
    assert HeatMap(True, "radiance", True, 3.0).scale(reference) == Scale(3.0, True, 0.003)


def test_of_pixels_without_error_few_stick_out_of_noise() -> None:
    rng = np.random.default_rng(2)
    side = 256
    truth, deviation = np.full((side, side), 0.5), np.full((side, side), 0.01)
    reference, standard_error = grey(truth + deviation * rng.standard_normal(truth.shape)), grey(deviation)
    for heat_map in (RELATIVE, ABSOLUTE):
        noise = heat_map.noise(standard_error, reference)
        out = np.count_nonzero(~is_noise(heat_map.errors(grey(truth), reference), noise))
        # 2 (1 - Phi(3)) = 0.0027 of 65,536 pixels: 177 and a standard deviation of 13
        assert 177 - 65 < out < 177 + 65
    assert typical_noise(ABSOLUTE.noise(standard_error, reference)) == pytest.approx(NOISE * 0.01)
    # lit pixels alone say what is typical; one that is known exactly is never noise
    half = grey(np.where(np.arange(side) < 200, 0, deviation))
    assert typical_noise(ABSOLUTE.noise(half, reference)) == pytest.approx(NOISE * 0.01)
    assert not is_noise(np.zeros((1, 1)), np.zeros((1, 1))).any()


def drawn(path: Path) -> np.ndarray:
    """Colours of a picture, bytes (N, 3), each as often as it is there."""
    return np.rint(255 * imread(path)[..., :3]).astype(np.uint8).reshape(-1, 3)


def area(pixels: np.ndarray, wanted: object) -> int:
    """How many pixels have a colour: bytes, or as "#a0a0a0"; matplotlib cuts where we round."""
    rgb = [int(wanted[place : place + 2], 16) for place in (1, 3, 5)] if isinstance(wanted, str) else wanted
    return int((np.abs(pixels.astype(int) - np.asarray(rgb, int)) <= 1).all(axis=1).sum())


def test_a_sheet_shows_errors_in_their_colours(tmp_path: Path) -> None:
    reference = grey(np.full((32, 32), 0.5))
    test = reference.copy()
    test[:, :8] *= 1.12
    test[:, 8:16] *= 0.5
    test[:, 16:24] *= 3
    error = np.full_like(reference, 1e-4)
    write_sheet(tmp_path / "a.png", "a", test, reference, "below", "note", error)
    pixels, colours = drawn(tmp_path / "a.png"), table(colour_map("vik"))
    # a quarter of a picture has 74 x 296 pixels
    for percent in (12, -50):
        place = RELATIVE.scale(reference).place(percent)
        assert area(pixels, colours[int(place * ENTRIES)]) > 10_000
    # 200 % is beyond the scale; 1.0 beyond radiance 0.5 too
    assert area(pixels, BEYOND["vik"]["over"]) > 10_000
    assert area(pixels, BEYOND["lajolla"]["over"]) > 10_000
    # the last quarter is noise in both maps, and the level is marked on both bars
    assert area(pixels, NOISE_COLOUR) > 30_000
    write_sheet(tmp_path / "b.png", "a", test, reference, "below", "note")
    assert area(drawn(tmp_path / "b.png"), NOISE_COLOUR) < 100  # the edges of letters: measured 41


def test_a_bar_marks_the_noise(tmp_path: Path) -> None:
    reference = grey(np.full((16, 16), 0.5))
    # all errors of 40 % are far above the noise, so that grey is on the bars alone
    areas = []
    for level in (0.01, 0.1, 1.0):
        write_sheet(tmp_path / "a.png", "a", 1.4 * reference, reference, "", "", level / 100 * reference)
        areas.append(area(drawn(tmp_path / "a.png"), NOISE_COLOUR))
    assert 20 < areas[0] < areas[1] < areas[2]
    # 3 % stands at 1 + log10(30) of 4 decades on either side of one bar, and of the other at 1.5 % of white, which is
    # the limit 0.5: 1 + log10(15) of 4; both bars are 290 pixels tall and 12 wide
    expected = 12 * 290 * ((1 + np.log10(30)) / 4 + (1 + np.log10(30)) / 4)
    assert areas[2] == pytest.approx(expected, rel=0.08)


def test_several_pictures_have_one_scale(tmp_path: Path) -> None:
    reference = grey(np.full((8, 8), 0.5))
    tests = [("one", 1.12 * reference), ("other", 1.12 * reference)]
    tests[1][1][:4] = 40
    heat_map = HeatMap(True, "radiance", False, 0.2)
    write_sheets(tmp_path / "a.png", "a", tests, reference, heat_maps=(heat_map,))
    found = table(colour_map("vik"))[int(Scale(0.2, True).place(0.06) * ENTRIES)]
    # one and a half pictures, though the second has an error of 40
    assert area(drawn(tmp_path / "a.png"), found) == pytest.approx(1.5 * 298**2, rel=0.06)


def test_luminance_is_of_rec_709() -> None:
    weights = colour.RGB_COLOURSPACES["ITU-R BT.709"].matrix_RGB_to_XYZ[1]
    np.testing.assert_allclose(luminance(np.eye(3)[None])[0], weights, atol=1e-4)
