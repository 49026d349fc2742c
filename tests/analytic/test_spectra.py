"""Spectra become three bands, and the error of that is what it is said to be."""

from __future__ import annotations

import doctest
import subprocess
import sys

import colour
import numpy as np
import pytest

from analytic import Medium, airlight, phase, spectra, transmittance
from analytic.spectra.bands import LUMINANCE, WAVELENGTHS

AIR = spectra.rayleigh_air(metres_per_unit=1000)
ISOTROPIC = phase("isotropic")


def flat(value=1.0):
    return np.full(WAVELENGTHS.shape, value)


def bell(centre, width):
    return np.exp(-(((WAVELENGTHS - centre) / width) ** 2) / 2)


def test_the_examples_of_the_package_are_its_results():
    result = doctest.testmod(spectra)
    assert result.attempted == 5
    assert result.failed == 0


def test_analytic_alone_imports_neither_colour_nor_miepython():
    code = "import sys, analytic; sys.exit(any(name in sys.modules for name in ('colour', 'miepython', 'matplotlib')))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
    code = code.replace("analytic;", "analytic.spectra;")
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


# --- from the spectrum to Rec.709


@pytest.mark.parametrize("illuminant", colour.SDS_ILLUMINANTS)
def test_each_response_sums_to_one_and_is_right_side_up(illuminant):
    weights = spectra.responses(illuminant)
    # measured: 4e-16
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-14)
    # a light outside Rec.709 would have a negative sum in a channel, and turn its response over
    assert weights[2, WAVELENGTHS == 450] > 0
    assert weights[1, WAVELENGTHS == 545] > 0
    assert weights[0, WAVELENGTHS == 610] > 0


@pytest.mark.parametrize("distance", [10.0, 60.0, 200.0])
def test_the_spectral_side_is_what_colour_science_integrates_in_steps_of_1_nm(distance):
    fine = np.arange(360.0, 831.0)
    sigma = colour.phenomena.scattering_cross_section(fine * 1e-7) * colour.phenomena.rayleigh.molecular_density() * 1e5
    daylight = colour.SDS_ILLUMINANTS["D65"].copy().align(colour.SpectralShape(360, 830, 1))
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]

    def rgb(values):
        spectrum = colour.SpectralDistribution(values, fine)
        xyz = colour.sd_to_XYZ(spectrum, observer, daylight, method="Integration")
        return colour.RGB_COLOURSPACES["ITU-R BT.709"].matrix_XYZ_to_RGB @ xyz

    found = spectra.transmittance_error(AIR, AIR.medium(), distance).spectral
    # measured: 5.3e-5, the tails beyond 380 and 780 nm and the steps
    np.testing.assert_allclose(found, rgb(transmittance(sigma, distance)) / rgb(np.ones_like(fine)), atol=1e-4)


def test_an_illuminant_that_nobody_knows_is_refused():
    with pytest.raises(ValueError, match="illuminant must be a name"):
        spectra.responses("D6500")


# --- three coefficients


def test_the_default_is_the_response_weighted_mean():
    np.testing.assert_allclose(AIR.medium().sigma_t, spectra.responses() @ AIR.sigma_t, rtol=1e-14)
    # what no light is lost on the way to is the mean too: matching at a millimetre differs in the second order
    np.testing.assert_allclose(AIR.medium(distance=1e-6).sigma_t, AIR.medium().sigma_t, rtol=1e-6)


def test_a_grey_medium_has_no_error_at_all():
    grey = spectra.SpectralMedium(flat(0.3), flat(0.5), phase("hg", g=0.6))
    for medium in (grey.medium(), grey.medium(distance=3.0)):
        # measured: 6e-16; the relative error 1e-15, Delta E 2e-13
        np.testing.assert_allclose(medium.sigma_s, 0.3, rtol=1e-14)
        np.testing.assert_allclose(medium.sigma_t, 0.5, rtol=1e-14)
        error = spectra.airlight_error(grey, medium, 1.0, -2.0, [1.0, np.inf])
        np.testing.assert_allclose(error.relative, 0, atol=1e-13)
        np.testing.assert_allclose(error.delta_e, 0, atol=1e-11)


@pytest.mark.parametrize("distance", [0.5, 2.0])
def test_what_is_matched_at_a_distance_is_right_there(distance):
    absorbed = np.exp(-0.014 * (WAVELENGTHS - 440))
    stained = spectra.tabulated(WAVELENGTHS, flat(0.5) + 0.2 * bell(550, 60), flat(0.7) + absorbed, ISOTROPIC)
    medium = stained.medium(distance=distance)
    exact = spectra.responses() @ np.exp(-stained.sigma_t * distance)
    # measured: 6e-15
    np.testing.assert_allclose(transmittance(medium.sigma_t, distance), exact, rtol=1e-13)
    # uniform light: the source function sigma_s / sigma_t, integrated along the ray
    exact = spectra.responses() @ (stained.sigma_s / stained.sigma_t * (1 - np.exp(-stained.sigma_t * distance)))
    found = medium.sigma_s / medium.sigma_t * (1 - transmittance(medium.sigma_t, distance))
    np.testing.assert_allclose(found, exact, rtol=1e-13)


def test_air_absorbs_nothing_in_three_bands_either():
    for medium in (AIR.medium(), AIR.medium(distance=50)):
        np.testing.assert_array_equal(medium.sigma_s, medium.sigma_t)


@pytest.mark.parametrize("part", ["sigma_s", "sigma_t - sigma_s"])
def test_a_negative_channel_is_refused_or_cut_with_its_share(part):
    # light at 505 nm is far outside Rec.709: its red is negative
    narrow = bell(505, 10)
    scattered, absorbed = (narrow, flat(1e-3)) if part == "sigma_s" else (flat(1e-3), narrow)
    medium = spectra.SpectralMedium(scattered, scattered + absorbed, ISOTROPIC)
    bands = spectra.responses() @ narrow
    share = f"{-bands[0] / np.abs(bands).max():.1%} of the largest band in red"
    with pytest.raises(ValueError, match=f"^{part} must not lie in a negative lobe.*below 0 by {share}"):
        medium.medium()
    with pytest.warns(UserWarning, match=f"{part} was below 0 by {share}"):
        cut = medium.medium(clip=True)
    expected = np.maximum(bands, 0)
    found = cut.sigma_s if part == "sigma_s" else cut.sigma_t - cut.sigma_s
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-15)
    assert found[0] == 0
    assert found[1] > 0


def test_a_distance_that_leaves_no_light_in_a_channel_is_refused():
    with pytest.raises(ValueError, match=r"distance must be shorter: at 400 .* no blue"):
        AIR.medium(distance=400)


@pytest.mark.parametrize("distance", [-1.0, np.nan, np.inf])
def test_a_distance_that_is_none_is_refused(distance):
    with pytest.raises(ValueError, match="distance must be finite"):
        AIR.medium(distance=distance)


# --- what they get wrong


def test_the_mean_errs_in_the_second_order_by_half_the_variance():
    error = spectra.transmittance_error(AIR, AIR.medium(), 0.01)
    weights, mean = spectra.responses(), AIR.medium().sigma_t
    variance = np.sum(weights * (AIR.sigma_t - mean[:, None]) ** 2, axis=1)
    # measured: 8e-4, the third order
    np.testing.assert_allclose(error.relative / 0.01**2, -variance / 2, rtol=2e-3)


def test_thin_airlight_is_right_to_the_first_order():
    error = [
        np.abs(spectra.airlight_error(AIR, AIR.medium(), scale, -2 * scale, 3 * scale).relative).max()
        for scale in (1e-3, 1e-2)
    ]
    assert error[1] < 1e-3
    # ten times the depth, ten times the error: measured 9.992
    assert error[1] / error[0] == pytest.approx(10, rel=2e-3)


def test_airlight_is_summed_over_wavelengths_that_keep_their_own_phase_function():
    tables = [phase("tabulated", values=(1.0, 1.0 + number / 80, 2.0)) for number in range(WAVELENGTHS.size)]
    medium = spectra.SpectralMedium(bell(600, 80), flat(1.5), tables)
    error = spectra.airlight_error(medium, medium.medium(), 1.0, -1.0, 2.0)
    each = [
        float(airlight(1.0, -1.0, 2.0, Medium(s, t), p))
        for s, t, p in zip(medium.sigma_s, medium.sigma_t, tables, strict=True)
    ]
    np.testing.assert_allclose(error.spectral, spectra.responses() @ each, rtol=1e-14)
    assert error.white == pytest.approx(float(LUMINANCE @ error.spectral), rel=1e-14)


def test_the_one_phase_function_keeps_the_luminance_of_a_thin_medium():
    tables = [phase("tabulated", values=(1.0, 2.0 - number / 80, 3.0)) for number in range(WAVELENGTHS.size)]
    medium = spectra.SpectralMedium(1e-6 * bell(550, 60), 1e-6 * flat(), tables)
    error = spectra.airlight_error(medium, medium.medium(), 1.0, [-1.0, -1.0, 0.5], [-0.5, 2.0, 2.0])
    luminance = [rgb @ LUMINANCE for rgb in (error.spectral, error.three_band)]
    # measured: 4e-16, where the channels differ by up to 3.5 %
    np.testing.assert_allclose(luminance[1], luminance[0], rtol=1e-12)
    assert np.abs(error.relative).max() > 0.01


@pytest.mark.parametrize("white", [1.0, 4.0])
def test_delta_e_of_a_grey_is_the_formula_of_cie_142(white):
    pair = spectra.ThreeBandError(np.full((1, 3), 0.5), np.full((1, 3), 1.0), np.array([white]))
    dark, light = (116 * (luminance / white) ** (1 / 3) - 16 for luminance in (0.5, 1.0))
    middle = ((dark + light) / 2 - 50) ** 2
    expected = (light - dark) / (1 + 0.015 * middle / np.sqrt(20 + middle))
    # measured: 7e-16
    assert pair.delta_e[0] == pytest.approx(expected, rel=1e-12)


def test_a_negative_channel_has_a_relative_error_of_the_right_sign():
    pair = spectra.ThreeBandError(np.array([0.2, 0.1, -0.1]), np.array([0.1, 0.2, 0.1]), np.array(1.0))
    np.testing.assert_allclose(pair.relative, [-0.5, 1.0, 2.0])


def test_a_ray_through_the_light_is_refused():
    with pytest.raises(ValueError, match="h must not be 0"):
        spectra.airlight_error(AIR, AIR.medium(), 0.0, -1.0, 1.0)


# --- air


def test_air_is_that_of_bodhaine_and_others():
    # their fit, Eq. 29, in 1e-28 cm^2; said to hold within 0.01 %, and measured: 9.2e-5
    um = WAVELENGTHS * 1e-3
    fit = (1.0455996 - 341.29061 * um**-2 - 0.90230850 * um**2) / (1 + 0.0027059889 * um**-2 - 85.968563 * um**2)
    molecules = 2.546899e19  # 1/cm^3 at 288.15 K and 1013.25 hPa
    np.testing.assert_allclose(spectra.rayleigh_air().sigma_s, fit * 1e-28 * molecules * 100, rtol=1e-4)


def test_air_falls_a_little_faster_than_the_fourth_power():
    exponent = np.diff(np.log(AIR.sigma_s)) / np.diff(np.log(WAVELENGTHS))
    # dispersion and King factor; Nicolet 1984 has 4.08 at 550 nm
    assert np.all((exponent < -4.0) & (exponent > -4.25))
    assert exponent[34] == pytest.approx(-4.08, abs=0.02)


def test_air_scatters_by_how_much_of_it_there_is():
    np.testing.assert_allclose(spectra.rayleigh_air(pressure=50662.5).sigma_s * 2000, AIR.sigma_s, rtol=1e-14)
    np.testing.assert_allclose(spectra.rayleigh_air(temperature=576.3).sigma_s * 2000, AIR.sigma_s, rtol=1e-14)


@pytest.mark.parametrize("name", ["metres_per_unit", "temperature", "pressure"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_air_that_cannot_be_is_refused(name, value):
    with pytest.raises(ValueError, match=f"{name} must be positive"):
        spectra.rayleigh_air(**{name: value})


# --- tables


def test_a_table_is_interpolated_linearly():
    medium = spectra.tabulated([300, 500, 900], [1, 3, 1], [2, 6, 2], ISOTROPIC)
    assert medium.sigma_s[WAVELENGTHS == 400] == pytest.approx(2)
    assert medium.sigma_t[WAVELENGTHS == 700] == pytest.approx(4)


@pytest.mark.parametrize(
    ("wavelengths", "sigma_s", "sigma_t", "message"),
    [
        ([380, 780, 600], [0, 0, 0], [1, 1, 1], "wavelengths must be finite numbers in ascending"),
        ([380, 600, 600, 780], [0] * 4, [1] * 4, "wavelengths must be finite numbers in ascending"),
        ([380, np.nan, 780], [0, 0, 0], [1, 1, 1], "wavelengths must be finite"),
        ([[380, 780]], [[0, 0]], [[1, 1]], "wavelengths must be"),
        ([], [], [], "wavelengths must reach from 380 to 780 nm, and are empty"),
        ([400, 780], [0, 0], [1, 1], "wavelengths must reach from 380 to 780 nm, not from 400 to 780 nm"),
        ([380, 700], [0, 0], [1, 1], "wavelengths must reach"),
        ([380, 780], [0, 0, 0], [1, 1], "sigma_s must be 2 numbers"),
        ([380, 780], [0, 0], [1], "sigma_t must be 2 numbers"),
        ([380, 780], [0, np.nan], [1, 1], "sigma_s must be finite"),
        ([380, 780], [0, 0], [1, -1], "sigma_t must be finite and not negative"),
        ([380, 501, 502, 503, 780], [0] * 5, [1, 1, -1, 1, 1], "sigma_t must be finite and not negative"),
        ([380, 501, 502, 503, 780], [0, 0, 2, 0, 0], [1] * 5, "sigma_s must not exceed sigma_t, as it does at 502 nm"),
    ],
)
def test_a_table_that_cannot_be_is_refused(wavelengths, sigma_s, sigma_t, message):
    with pytest.raises(ValueError, match=message):
        spectra.tabulated(wavelengths, sigma_s, sigma_t, ISOTROPIC)


@pytest.mark.parametrize(
    ("sigma_s", "sigma_t", "phases", "message"),
    [
        (np.zeros(80), flat(), ISOTROPIC, "sigma_s must be 81 numbers"),
        (flat(0), flat(np.inf), ISOTROPIC, "sigma_t must be finite"),
        (flat(-1), flat(), ISOTROPIC, "sigma_s must be finite and not negative"),
        (flat(2), flat(), ISOTROPIC, "sigma_s must not exceed sigma_t, as it does at 380 nm"),
        (flat(), flat(), [phase("tabulated", values=(1, 1))] * 80, "phases must be one, or 81 tables"),
        (flat(), flat(), [phase("hg", g=0.1)] * 81, "phases must be one, or 81 tables"),
        (flat(), flat(), [phase("tabulated", values=(1,) * n) for n in [3] * 80 + [2]], "phases must be one, or 81"),
    ],
)
def test_a_medium_that_cannot_be_is_refused(sigma_s, sigma_t, phases, message):
    with pytest.raises(ValueError, match=message):
        spectra.SpectralMedium(sigma_s, sigma_t, phases)
