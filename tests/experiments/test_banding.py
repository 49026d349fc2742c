"""Bands against noise: errors whose spectra are known, and shafts against rays of the camera."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scene_files import POINT, point, write_scene

from experiments.measurements.banding import OCTAVES, banding, columns, spectrum
from experiments.measurements.shafts import shaft_direction, vanishing_point
from gpu_impl.visibilities.blue_noise import blue_noise

SIDE = 256
Y, X = np.mgrid[:SIDE, :SIDE].astype(float)
LIT = np.ones((SIDE, SIDE), bool)
# above the picture, as in the thesis's scenes
ABOVE = np.array([128.0, -200.0, 1.0])
RADIUS, ANGLE = np.hypot(X - 128, Y + 200), np.arctan2(X - 128, Y + 200)
WHITE = np.random.default_rng(7).standard_normal((SIDE, SIDE))
# of every wave shorter than 8 pixels, and longer than 64: pi (1/8^2 - 1/64^2), the share of the frequencies' square
WHITE_SHARE = np.pi * (1 / 64 - 1 / 4096)


def found(error: np.ndarray, **settings) -> dict:
    return {
        name.removeprefix("banding."): value for name, value in columns(spectrum(error, LIT, ABOVE, **settings)).items()
    }


@pytest.mark.parametrize("period", [10, 12, 40])
def test_rings_run_along_the_shafts(period: float) -> None:
    rings = found(0.1 * np.sqrt(2) * np.sin(2 * np.pi * RADIUS / period))
    assert rings["rms"] == pytest.approx(0.1, rel=2e-3)
    assert rings["along"] == pytest.approx(0.1, rel=3e-3)
    # rings of 40 pixels bend within a window: measured 1.7e-3
    assert rings["across"] < 3e-3
    assert rings["coarse_share"] > 0.999
    # as near as the bins of a window are
    assert 1 / rings["period"] == pytest.approx(1 / period, abs=0.75 / 128)


def test_streaks_run_across_them() -> None:
    # 13 pixels apart at the picture's upper edge, 29 at the lower one
    streaks = found(0.1 * np.sqrt(2) * np.sin(100 * ANGLE))
    assert streaks["across"] == pytest.approx(0.1, rel=5e-3)
    # measured 2.9e-4
    assert streaks["along"] < 1e-3
    assert streaks["across_8px"] < 0.1 * streaks["across_16px"]
    assert streaks["across_64px"] < 0.1 * streaks["across_32px"]


@pytest.mark.parametrize("corner", [-150.0, 405.0])
def test_shafts_may_run_aslant(corner: float) -> None:
    """Light from beyond a corner of the picture, upper left and upper right, and rings around it."""
    radius = np.hypot(X - corner, Y + 150)
    numbers = columns(
        spectrum(0.1 * np.sqrt(2) * np.sin(2 * np.pi * radius / 12), LIT, np.array([corner, -150.0, 1.0]))
    )
    assert numbers["banding.along"] == pytest.approx(0.1, rel=3e-3)
    assert numbers["banding.across"] < 1e-3


def test_parallel_shafts_have_parallel_bands() -> None:
    """The vanishing point at infinity, in x: bands along it are stripes that stand upright."""
    stripes = np.sin(2 * np.pi * X / 16)
    at_infinity = columns(spectrum(stripes, LIT, np.array([1.0, 0.0, 0.0])))
    across = columns(spectrum(stripes, LIT, np.array([0.0, -1.0, 0.0])))
    assert at_infinity["banding.along"] == pytest.approx(np.sqrt(0.5), rel=1e-3)
    assert across["banding.across"] == pytest.approx(np.sqrt(0.5), rel=1e-3)
    assert max(at_infinity["banding.across"], across["banding.along"]) < 1e-6


def test_white_noise_has_its_share_everywhere() -> None:
    fields = np.random.default_rng(3).standard_normal((10, SIDE, SIDE))
    numbers = [found(0.1 * field) for field in fields]
    white = {name: np.sqrt(np.mean([one[name] ** 2 for one in numbers])) for name in numbers[0]}
    assert white["rms"] == pytest.approx(0.1, rel=0.005)
    # measured: 1.7 % less, 2.3 % apart, and up to 1.5 % less in the octaves
    assert white["along"] == pytest.approx(0.1 * np.sqrt(WHITE_SHARE / 2), rel=0.03)
    assert white["across"] == pytest.approx(white["along"], rel=0.03)
    for longest in OCTAVES[1:]:
        share = np.pi * (4 / longest**2 - 1 / longest**2)
        rms = np.hypot(white[f"along_{longest}px"], white[f"across_{longest}px"])
        assert rms == pytest.approx(0.1 * np.sqrt(share), rel=0.1), longest


def test_blue_noise_has_no_bands() -> None:
    blue = found(np.tile(blue_noise(), (4, 4)) - 0.5)
    assert blue["rms"] == pytest.approx(np.sqrt(1 / 12), rel=0.01)
    # measured 1.4e-5
    assert blue["coarse_share"] < 1e-3


def test_parts_add_up() -> None:
    mixed = found(0.1 * WHITE + 0.2 * np.sqrt(2) * np.sin(2 * np.pi * RADIUS / 12))
    assert mixed["rms"] == pytest.approx(np.hypot(0.1, 0.2), rel=0.02)
    assert mixed["along"] == pytest.approx(0.2, rel=0.02)
    squares = sum(mixed[f"{way}_{longest}px"] ** 2 for way in ("along", "across") for longest in OCTAVES)
    assert squares == pytest.approx(mixed["rms"] ** 2, rel=1e-9)


def test_a_slow_trend_is_no_band() -> None:
    assert found(3 + 0.02 * X - 0.01 * Y)["rms"] < 1e-12


def test_noise_of_the_reference_is_taken_away() -> None:
    rings = 0.1 * np.sqrt(2) * np.sin(2 * np.pi * RADIUS / 12)
    noise = np.full((SIDE, SIDE), 0.1)
    clean = found(rings + 0.1 * WHITE, noise=noise)
    # measured: 0.1004, 0.1003, and 0.0042 of the noise's own 0.1
    assert clean["rms"] == pytest.approx(0.1, rel=0.02)
    assert clean["along"] == pytest.approx(0.1, rel=0.02)
    # twenty times nothing but noise
    fields = np.random.default_rng(5).standard_normal((20, SIDE, SIDE))
    assert all(spectrum(0.1 * field, LIT, ABOVE, noise) is None for field in fields)
    # a mean square that is larger by 5 %: 3 standard deviations are 2.3 %
    assert found(np.sqrt(1.05) * 0.1 * WHITE, noise=noise)["rms"] == pytest.approx(0.1 * np.sqrt(0.05), rel=0.3)
    # three quarters of the noise are the technique's own
    half = found(0.1 * WHITE, noise=noise / 2)
    assert half["rms"] == pytest.approx(0.1 * np.sqrt(0.75), rel=0.02)
    assert half["coarse_share"] == pytest.approx(WHITE_SHARE, rel=0.1)


def test_the_dark_does_not_count() -> None:
    """Half of the picture unlit: the numbers are those of the lit half, and the edge is no band."""
    lit = X < 128
    rings = np.where(lit, 1 + 0.1 * np.sqrt(2) * np.sin(2 * np.pi * RADIUS / 12), 0)
    numbers = columns(spectrum(rings, lit, ABOVE))
    assert numbers["banding.along"] == pytest.approx(0.1, rel=0.03)
    assert spectrum(rings, np.zeros_like(lit), ABOVE) is None
    assert set(columns(None).values()) == {None}
    assert columns(None).keys() == numbers.keys()


def test_windows_over_the_vanishing_point_are_left_out() -> None:
    small = np.ones((100, 100), bool)
    assert spectrum(WHITE[:100, :100], small, np.array([50.0, 50.0, 1.0])) is None
    # a quarter of a window off its middle, and just beyond its edge
    assert spectrum(WHITE[:100, :100], small, np.array([50.0, 24.0, 1.0])) is None
    assert spectrum(WHITE[:100, :100], small, np.array([50.0, -1.0, 1.0])) is not None
    there = spectrum(WHITE[:100, :100], small, ABOVE)
    # a window of 100 pixels has no room for waves of 64
    assert np.isnan(there.along[-1])
    assert np.isfinite(there.along[:-1]).all()


SUN = "<emitter type='directional'><vector name='direction' x='1' y='-2' z='{z}'/></emitter>"
HELD = "<shape type='cube'><transform name='to_world'><scale value='9'/></transform></shape>"


@pytest.mark.parametrize(
    "position", [(0.3, 2.6, 0), (-4, 1, 2), (1, 3, 9), (2, 1, 5)], ids=["above", "left", "behind", "beside"]
)
def test_a_shaft_lies_in_the_plane_of_the_eye_and_a_light_ray(position: tuple[float, float, float], tmp_path) -> None:
    camera_and_light = write_scene(tmp_path, point(*position), size=(80, 50))
    camera, light = camera_and_light.camera, camera_and_light.lights[0]
    shafts_are_coplanar(camera, light.position - camera.origin, vanishing_point(camera, light))


@pytest.mark.parametrize("z", [0.0, 3.0, -3.0])
def test_parallel_light_has_a_vanishing_point(z: float, tmp_path) -> None:
    camera = write_scene(tmp_path, POINT, size=(80, 50)).camera
    to_world = np.eye(4)
    to_world[:3, 2] = 1, -2, z
    sun = SimpleNamespace(kind="directional", direction=to_world[:3, 2] / np.linalg.norm(to_world[:3, 2]))
    shafts_are_coplanar(camera, sun.direction, vanishing_point(camera, sun))


def shafts_are_coplanar(camera, light_way: np.ndarray, vanishing: np.ndarray) -> None:
    """A pixel's ray, that of the point a little farther along the shaft, and the way of light lie in one plane."""
    direction = camera.rays()[1]
    # rays are linear in the pixel where they have the same depth
    flat = direction / (direction @ camera.to_world[:3, 2])[..., None]
    right, down = flat[0, 1] - flat[0, 0], flat[1, 0] - flat[0, 0]
    for row, column in ((3, 5), (40, 11), (20, 70)):
        way, distance = shaft_direction(vanishing, np.array(float(column)), np.array(float(row)))
        farther = flat[row, column] + 10 * (way[0] * right + way[1] * down)
        volume = np.linalg.det(
            [flat[row, column], farther / np.linalg.norm(farther), light_way / np.linalg.norm(light_way)]
        )
        # measured 1e-16; 1e-3 and more for a way that is off by a tenth
        assert abs(volume) < 1e-12
        assert np.linalg.norm(way) == pytest.approx(1)
        assert distance > 0


class Estimated:
    """A reference with a standard error."""

    def __init__(self, scattering: np.ndarray, standard_error: float) -> None:
        self.scattering, self._standard_error = scattering, standard_error

    def standard_error(self, layer: str) -> np.ndarray:
        assert layer == "scattering"
        return np.full_like(self.scattering, self._standard_error)


def shot(test: np.ndarray, truth: np.ndarray, standard_error: float, scene) -> SimpleNamespace:
    grey = [np.repeat(image[..., None], 3, axis=-1) for image in (test, truth)]
    return SimpleNamespace(
        scene=scene, frame=SimpleNamespace(scattering=grey[0]), reference=Estimated(grey[1], standard_error)
    )


def test_of_a_shot(tmp_path) -> None:
    scene = write_scene(tmp_path, point(0, 9, 0), size=(SIDE, SIDE))
    truth = 1 + X / SIDE
    vanishing = vanishing_point(scene.camera, scene.lights[0])
    radius = np.hypot(X - vanishing[0] / vanishing[2], Y - vanishing[1] / vanishing[2])
    rings = 1 + 0.02 * np.sqrt(2) * np.sin(2 * np.pi * radius / 12)
    numbers = banding(shot(truth * rings, truth, 0.0, scene))
    assert numbers["banding.along"] == pytest.approx(0.02, rel=5e-3)
    assert numbers["banding.across"] < 2e-4
    same = banding(shot(truth, truth, 0.0, scene))
    assert same["banding.rms"] == 0
    assert same["banding.coarse_share"] is same["banding.period"] is None
    # a technique without error, beside a reference with noise
    noisy = banding(shot(truth, truth + 0.01 * WHITE, 0.01, scene))
    assert set(noisy.values()) == {None}
    assert set(banding(shot(truth, 0 * truth, 0.0, scene)).values()) == {None}


def test_light_where_none_should_be_and_faint_light(tmp_path) -> None:
    scene = write_scene(tmp_path, point(0, 9, 0), size=(SIDE, SIDE))
    vanishing = vanishing_point(scene.camera, scene.lights[0])
    radius = np.hypot(X - vanishing[0] / vanishing[2], Y - vanishing[1] / vanishing[2])
    rings = 1 + 0.5 * np.sin(2 * np.pi * radius / 12)
    truth = np.where(X < 160, 1.0, 0.0)
    # the dark third has rings of the floor's size, 1 % of the median: they count as if it were lit by as much
    ghost = banding(shot(truth + 0.01 * np.where(X < 160, 0, rings), truth, 0.0, scene))
    assert ghost["banding.along_16px"] > 0.1
    # as faint as a ten-thousandth of the median: a relative error of a hundredth of what it is of the pixel
    faint = np.where(X < 160, 1.0, 1e-4)
    assert banding(shot(np.where(X < 160, 1, rings) * faint, faint, 0.0, scene))["banding.rms"] < 0.01


@pytest.mark.parametrize(("period", "counted"), [(48, 0.98), (64, 0.76), (80, 0.47), (128, 0.11), (256, 0.01)])
def test_long_waves_count_in_part(period: float, counted: float) -> None:
    waves = (np.sqrt(2) * np.sin(2 * np.pi * Y / period + np.pi * k / 4) for k in range(8))
    assert np.mean([found(wave)["rms"] ** 2 for wave in waves]) == pytest.approx(counted, abs=0.006)
