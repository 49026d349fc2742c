"""Spheres that cannot be, or whose sum would not end, are refused by name."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from analytic import spectra

WAVELENGTH = 500.0  # [nm]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"wavelengths": 0.0}, "wavelengths must be positive"),
        ({"wavelengths": [500, np.nan]}, "wavelengths must be positive"),
        ({"radius": -1.0}, "radius must be positive"),
        ({"radius": np.inf}, "radius must be positive"),
        ({"index": -1.5}, "index must be positive"),
        ({"index": complex(1.5, np.nan)}, "index must be one finite number"),
        ({"index": [1.5, 1.5]}, "index must be one finite number, or one a wavelength"),
        ({"spread": 0.9}, "spread must be finite and at least 1"),
        ({"spread": np.nan}, "spread must be finite"),
        ({"angles": 1}, "angles must be a whole number, 2 or more"),
        ({"angles": 2.5}, "angles must be a whole number"),
        ({"angles": "a"}, "angles must be a whole number"),
        ({"wavelengths": []}, "wavelengths must be positive and finite, one or more"),
        ({"wavelengths": [[450, 550]]}, "wavelengths must be .* in a row"),
        ({"wavelengths": 500 + 1j}, "wavelengths must be real numbers"),
        ({"wavelengths": "green"}, "wavelengths must be real numbers"),
        ({"radius": "a"}, "radius must be real numbers"),
        ({"radius": [1.0, 2.0]}, "radius must be one number"),
        ({"radius": 1 + 0j}, "radius must be real numbers"),
        ({"spread": "a"}, "spread must be real numbers"),
        ({"spread": [1.5]}, "spread must be one number"),
        ({"index": "a"}, "index must be one finite number"),
        ({"index": None}, "index must be one finite number"),
        ({"index": [[1.5], [1.5, 1.4]]}, "index must be one finite number"),
        ({"index": 1.0}, "index must differ from 1 .* air in air does not scatter"),
        ({"index": 1 - 9e-7j}, "index must differ from 1"),
        ({"wavelengths": [450, 550], "index": [1.5, 1.0]}, "index must differ from 1"),
        # each of these took 16 s to for ever
        ({"index": 1e6}, "radius or spread must be smaller.*exceeds 4000"),
        ({"radius": 5.0, "spread": 2.0}, "radius or spread must be smaller"),
        ({"radius": 0.1, "spread": 5.0}, "radius or spread must be smaller"),
        ({"spread": 1e300}, "radius or spread must be smaller"),
        ({"radius": 1e300}, "radius or spread must be smaller"),
        ({"wavelengths": 1e-323}, "radius or spread must be smaller"),
        ({"radius": 1e-60}, "radius must be larger: what it scatters underflows"),
    ],
)
def test_spheres_that_cannot_be_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        spectra.mie_optics(**({"wavelengths": 500.0, "radius": 0.5, "index": 1.5} | arguments))


def test_the_largest_sum_ends_where_it_is_said_to():
    # radius 100 um at 500 nm is x = 1257: times 3.1 below 4000, times 3.2 above
    assert spectra.mie_optics(WAVELENGTH, 100.0, 3.1, angles=3).extinction[0] > 0
    with pytest.raises(ValueError, match="exceeds 4000"):
        spectra.mie_optics(WAVELENGTH, 100.0, 3.2, angles=3)
    # of an index below 1 it is x itself that counts
    with pytest.raises(ValueError, match="exceeds 4000"):
        spectra.mie_optics(WAVELENGTH, 320.0, 0.5, angles=3)


@pytest.mark.parametrize("name", ["number_density", "metres_per_unit"])
@pytest.mark.parametrize(
    ("value", "message"),
    [
        (0.0, "positive"),
        (np.inf, "positive"),
        ("a", "real numbers"),
        (None, "real numbers"),
        ([1, 2], "one number"),
        (1 + 1j, "real numbers"),
    ],
)
def test_a_cloud_that_cannot_be_is_refused(name, value, message):
    with pytest.raises(ValueError, match=f"{name} must be {message}"):
        spectra.mie_spheres(**({"radius": 0.5, "index": 1.5, "number_density": 1.0} | {name: value}))


def test_without_miepython_one_sentence_says_the_cure(monkeypatch):
    monkeypatch.setitem(sys.modules, "miepython", None)
    with pytest.raises(
        ModuleNotFoundError, match=r"^Mie scattering needs miepython.*pip install 'airlight\[spectra\]'.$"
    ):
        spectra.mie_optics(500.0, 0.5, 1.5)
