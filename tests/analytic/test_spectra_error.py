"""What three bands get wrong: the error that is stated is the one that is made."""

from __future__ import annotations

import numpy as np
import pytest

from analytic import Medium, airlight, phase, spectra
from analytic.spectra.bands import LUMINANCE, WAVELENGTHS

AIR = spectra.rayleigh_air(metres_per_unit=1000)


def flat(value=1.0):
    return np.full(WAVELENGTHS.shape, value)


def bell(centre, width):
    return np.exp(-(((WAVELENGTHS - centre) / width) ** 2) / 2)


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


def test_the_one_phase_function_is_that_of_the_light():
    tables = [phase("tabulated", values=(1.0, 2.0 - number / 80, 3.0)) for number in range(WAVELENGTHS.size)]
    medium = spectra.SpectralMedium(bell(550, 60), flat(), tables)
    found = spectra.airlight_error(medium, medium.medium(), 1.0, -1.0, 2.0, "A").three_band
    expected = airlight(1.0, -1.0, 2.0, medium.medium(), medium.phase("A"))
    np.testing.assert_allclose(found, expected, rtol=1e-14)
    # measured: 2.6e-4 between D65 and A
    assert np.abs(airlight(1.0, -1.0, 2.0, medium.medium(), medium.phase()) / expected - 1).max() > 1e-4


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


@pytest.mark.filterwarnings("error")
def test_where_no_light_is_left_the_relative_error_is_nan_in_silence():
    far = spectra.transmittance_error(AIR, AIR.medium(), [1.0, np.inf])
    assert np.all(np.isnan(far.relative[1]))
    assert np.all(np.isfinite(far.relative[0]))
    assert far.delta_e[1] == 0
    empty = spectra.airlight_error(AIR, AIR.medium(), 1.0, 2.0, [2.0, 3.0])
    assert np.all(np.isnan(empty.relative[0]))
    assert np.isnan(empty.delta_e[0])
    assert np.all(np.isfinite([*empty.relative[1], empty.delta_e[1]]))
    pair = spectra.ThreeBandError(np.zeros(3), np.array([1.0, -1.0, 0.0]), np.array(1.0))
    np.testing.assert_array_equal(pair.relative, [np.inf, -np.inf, np.nan])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"spectral": AIR.medium()}, "spectral must be a SpectralMedium, not a Medium"),
        ({"medium": AIR}, "medium must be an RGB"),
        ({"medium": Medium(1, 1)}, "medium must be an RGB"),
        ({"illuminant": []}, "illuminant must be a name"),
    ],
)
def test_an_error_of_what_is_no_medium_is_refused(arguments, message):
    given = {"spectral": AIR, "medium": AIR.medium()} | arguments
    with pytest.raises(ValueError, match=message):
        spectra.transmittance_error(**given, distance=1.0)
    with pytest.raises(ValueError, match=message):
        spectra.airlight_error(**given, h=1.0, x_a=0.0, x_b=1.0)


@pytest.mark.parametrize("value", ["a", None, 1j, [[1.0], [1.0, 2.0]]])
def test_an_error_over_what_is_no_length_is_refused(value):
    with pytest.raises(ValueError, match="distance must be real numbers"):
        spectra.transmittance_error(AIR, AIR.medium(), value)
    for name in ("h", "x_a", "x_b"):
        with pytest.raises(ValueError, match=f"{name} must be real numbers"):
            spectra.airlight_error(AIR, AIR.medium(), **({"h": 1.0, "x_a": 0.0, "x_b": 1.0} | {name: value}))


def test_a_ray_through_the_light_is_refused():
    with pytest.raises(ValueError, match="h must not be 0"):
        spectra.airlight_error(AIR, AIR.medium(), 0.0, -1.0, 1.0)
