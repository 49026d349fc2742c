"""Spectra become three bands, and the error of that is what it is said to be."""

from __future__ import annotations

import doctest
import subprocess
import sys

import colour
import numpy as np
import pytest

from analytic import Medium, airlight, phase, spectra, transmittance
from analytic.spectra.bands import WAVELENGTHS

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


@pytest.mark.parametrize("illuminant", ["D6500", [], None, 65, ["D65"]])
def test_an_illuminant_that_nobody_knows_is_refused(illuminant):
    with pytest.raises(ValueError, match="illuminant must be a name"):
        spectra.responses(illuminant)
    with pytest.raises(ValueError, match="illuminant must be a name"):
        AIR.medium(illuminant=illuminant)


def incandescent():
    """Weights of the channels under illuminant A: Planck's formula of ISO 11664-2, the primaries of BT.709."""
    exponent = 1.435e7 / 2848
    light = (560 / WAVELENGTHS) ** 5 * np.expm1(exponent / 560) / np.expm1(exponent / WAVELENGTHS)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"][WAVELENGTHS]
    x, y = np.array([[0.64, 0.30, 0.15], [0.33, 0.60, 0.06]])
    primaries = np.array([x / y, np.ones(3), (1 - x - y) / y])
    white = np.array([0.3127, 0.3290, 0.3583]) / 0.3290
    matrix = np.linalg.inv(primaries * np.linalg.solve(primaries, white))
    weights = matrix @ (observer.T * light)
    return weights / weights.sum(axis=1, keepdims=True)


def test_each_function_takes_the_light_that_it_is_given():
    weights = incandescent()
    mean = weights @ AIR.sigma_t
    # measured: 8e-7; under D65 the mean differs by 4 to 15 %
    np.testing.assert_allclose(spectra.three_bands(AIR.sigma_s, AIR.sigma_t, illuminant="A").sigma_t, mean, rtol=5e-6)
    np.testing.assert_allclose(AIR.medium(illuminant="A").sigma_s, mean, rtol=5e-6)
    assert np.abs(AIR.medium().sigma_t / mean - 1).max() > 0.03
    error = spectra.transmittance_error(AIR, AIR.medium(), 50.0, "A")
    np.testing.assert_allclose(error.spectral, weights @ np.exp(-50 * AIR.sigma_t), rtol=5e-6)
    each = [float(airlight(1.0, -30.0, 20.0, Medium(s, s), phase("rayleigh"))) for s in AIR.sigma_s]
    error = spectra.airlight_error(AIR, AIR.medium(), 1.0, -30.0, 20.0, "A")
    np.testing.assert_allclose(error.spectral, weights @ each, rtol=5e-6)


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


@pytest.mark.parametrize(
    ("distance", "message"),
    [
        (-1.0, "finite"),
        (np.nan, "finite"),
        (np.inf, "finite"),
        ("a", "real numbers"),
        (None, "real numbers"),
        (1j, "real numbers"),
        ([1, 2], "one number"),
    ],
)
def test_a_distance_that_is_none_is_refused(distance, message):
    with pytest.raises(ValueError, match=f"distance must be {message}"):
        AIR.medium(distance=distance)


@pytest.mark.parametrize("distance", [5e-324, 1e-310])
def test_a_distance_that_is_hardly_one_takes_the_mean(distance):
    np.testing.assert_allclose(AIR.medium(distance=distance).sigma_t, AIR.medium().sigma_t, rtol=1e-14)


@pytest.mark.parametrize(
    ("sigma_s", "sigma_t", "message"),
    [
        (flat(2.0), flat(), "sigma_s must not exceed sigma_t, as it does at 380 nm"),
        (-flat(), flat(), "sigma_s must be finite and not negative"),
        (flat(), flat(np.inf), "sigma_t must be finite and not negative"),
        (flat() * 1j, flat(), "sigma_s must be real numbers"),
        (flat(), flat() * (1 + 0j), "sigma_t must be real numbers"),
        (np.ones(3), np.ones(3), "sigma_s must be 81 numbers"),
        (0.5, flat(), "sigma_s must be 81 numbers"),
        (None, flat(), "sigma_s must be real numbers"),
    ],
)
def test_bands_of_spectra_that_cannot_be_are_refused(sigma_s, sigma_t, message):
    with pytest.raises(ValueError, match=message):
        spectra.three_bands(sigma_s, sigma_t)


def test_bands_of_lists_are_those_of_arrays():
    found = spectra.three_bands(AIR.sigma_s.tolist(), AIR.sigma_t.tolist())
    np.testing.assert_array_equal(found.sigma_t, AIR.medium().sigma_t)


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
@pytest.mark.parametrize(
    ("value", "message"),
    [(value, "positive") for value in (0.0, -1.0, np.nan, np.inf)]
    + [("a", "real numbers"), (None, "real numbers"), (1j, "real numbers"), ([288, 300], "one number")],
)
def test_air_that_cannot_be_is_refused(name, value, message):
    with pytest.raises(ValueError, match=f"{name} must be {message}"):
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
        ("a", [0, 0], [1, 1], "wavelengths must be real numbers"),
        ([380, 780 + 1j], [0, 0], [1, 1], "wavelengths must be real numbers"),
        ([380, 780], [1j, 1j], [1, 1], "sigma_s must be real numbers"),
        ([380, 780], [0, 0], [1 + 0j, 1], "sigma_t must be real numbers"),
        ([380, 780], [0, 0], None, "sigma_t must be real numbers"),
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
        (flat() * 1j, flat(), ISOTROPIC, "sigma_s must be real numbers"),
        (flat(), None, ISOTROPIC, "sigma_t must be real numbers"),
        (flat(), flat(), "h", "phases must be made by analytic.phase, not be a str"),
        (flat(), flat(), None, "phases must be made by analytic.phase, not be a NoneType"),
        (flat(), flat(), np.array([1]), "phases must be made by analytic.phase, not be a ndarray"),
        (flat(), flat(), [phase("tabulated", values=(1, 1))] * 80 + [1], "phases must be made .* not be a int"),
        (flat(), flat(), [], "phases must be one, or 81"),
        (flat(), flat(), [phase("tabulated", values=(1, 1))] * 80, "phases must be one, or 81 tables"),
        (flat(), flat(), [phase("hg", g=0.1)] * 81, "phases must be one, or 81 tables"),
        (flat(), flat(), [phase("tabulated", values=(1,) * n) for n in [3] * 80 + [2]], "phases must be one, or 81"),
    ],
)
def test_a_medium_that_cannot_be_is_refused(sigma_s, sigma_t, phases, message):
    with pytest.raises(ValueError, match=message):
        spectra.SpectralMedium(sigma_s, sigma_t, phases)


@pytest.mark.parametrize("stranger", [None, "isotropic", 1.0])
def test_a_table_takes_no_stranger_for_a_phase_function(stranger):
    with pytest.raises(ValueError, match="phase must be made by"):
        spectra.tabulated([380, 780], [0, 0], [1, 1], stranger)
