"""Pixels in which OpenGL and Mitsuba see different surfaces count for nothing in the errors of `same_surface`."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from experiments.measurements import find_measurement
from experiments.measurements.same_surface import is_same_surface
from reference.first_surfaces import first_surfaces
from scenes.loader import load


class MadeUp(SimpleNamespace):
    """A reference of no scene: its airlight, and its noise or None."""

    def noise(self, layer: str) -> np.ndarray | None:
        assert layer == "scattering"
        return self.error


def shot(noise: np.ndarray | None = None) -> SimpleNamespace:
    """1 % off everywhere, and far off in two pixels that look past what the reference sees."""
    scene = load("sphere", size=(32, 24))
    depth = first_surfaces(scene).depth
    depth[:, :16] *= 1.009
    depth[3, 4], depth[12, 20] = 1.012 * depth[3, 4], 0.5 * depth[12, 20]
    airlight = np.full((24, 32, 3), 2.0)
    test = 1.01 * airlight
    test[3, 4] = test[12, 20] = 9.0
    frame = SimpleNamespace(depth=depth.astype(np.float32), scattering=test)
    return SimpleNamespace(scene=scene, frame=frame, reference=MadeUp(scattering=airlight, error=noise))


def test_pixels_of_other_surfaces_are_left_out() -> None:
    found = find_measurement("same_surface").measure(shot())
    assert (found["same_surface.pixels"], found["same_surface.others"]) == (24 * 32 - 2, 2)
    assert found["same_surface.bias"] == pytest.approx(0.02, rel=1e-12)
    assert found["same_surface.rel_95"] == pytest.approx(0.01, rel=1e-12)
    # what was sampled has its variance taken off, what was not has none
    noisy = find_measurement("same_surface").measure(shot(np.full((24, 32, 3), 0.012)))
    assert noisy["same_surface.bias"] == pytest.approx(0.016, rel=1e-12)


def test_alike_is_of_the_reference_s_depth() -> None:
    truth = np.array([[1.0, 1.0, 10.0, 10.0]])
    assert is_same_surface(np.array([[1.009, 1.011, 9.91, 9.89]]), truth).tolist() == [[True, False, True, False]]
