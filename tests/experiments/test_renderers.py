"""Techniques that ask rays are told by the reference's ray casting, on whatever rays their lattice has."""

from __future__ import annotations

import numpy as np
import pytest

import airlight
from experiments.renderers import find_lit, open_renderer
from gpu_impl.techniques import find_technique
from reference.deterministic import lit_intervals
from scenes.loader import load


@pytest.mark.parametrize("name", ["slit", "eye_in_shadow", "light_behind_eye"])
def test_given_intervals_make_the_reference(name: str) -> None:
    scene = load(name, size=(32, 24))
    frame = airlight.render(scene, "given+quadrature")
    truth = airlight.reference(scene, deterministic=True)
    # float32, of the brightest: measured 3e-7
    np.testing.assert_allclose(frame.scattering, truth.scattering, atol=2e-6 * truth.scattering.max())


def test_rays_of_a_lattice_are_those_of_its_pixels() -> None:
    scene = load("slit", size=(24, 16))
    with open_renderer(scene) as renderer:
        coarse = renderer.record(find_technique("given+quadrature", downsample=4))[0]
        fine = renderer.record(find_technique("given+quadrature"))[0]
    x, y = np.floor(coarse.positions).astype(int).reshape(-1, 2).T
    for cell, pixel in enumerate(y * 24 + x):
        there, here = (pieces.t0[pieces.cell == one] for pieces, one in ((fine, pixel), (coarse, cell)))
        # casting finds ends to float32's resolution, from probes that neighbours decide
        np.testing.assert_allclose(here, there, atol=1e-4)


def test_positions_between_pixels_are_the_pixels_of_a_finer_image() -> None:
    fine = load("slit", size=(48, 32))
    own = lit_intervals(fine)
    centres = np.stack(np.meshgrid(np.arange(48) + 0.5, np.arange(32) + 0.5), axis=-1)
    found = find_lit(load("slit", size=(24, 16)), 0, centres / 2, np.zeros((32, 48)))
    np.testing.assert_array_equal(found.offsets, own.offsets)
    np.testing.assert_allclose(found.begin, own.begin, rtol=1e-9)
    np.testing.assert_allclose(found.end, own.end, rtol=1e-9)
