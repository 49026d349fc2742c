"""The public face, as its docstring and a script use it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import airlight


def test_the_docstrings_example() -> None:
    scene = airlight.load("sphere", size=(32, 32))
    frame = airlight.render(scene, "Weng2010")
    truth = airlight.reference(scene, rel_error=0.02)
    metrics = airlight.compare(frame.scattering, truth.scattering)
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


def test_what_cannot_be_used_is_one_exception(tmp_path: Path) -> None:
    for call in (
        lambda: airlight.load(tmp_path / "none.xml"),
        lambda: airlight.render(airlight.load("empty", size=(8, 8)), "Nobody1999"),
        lambda: airlight.reference(airlight.load("empty", size=(8, 8)), rel_error=2),
        lambda: airlight.compare(np.ones((2, 2, 3)), np.ones((3, 2, 3))),
    ):
        with pytest.raises(airlight.InputError):
            call()
