"""What is recorded of a technique is what it hands to its airlight model, and no more."""

from __future__ import annotations

import numpy as np
import pytest
from scene_files import point, sphere, spot, write_scene

from analytic import airlight
from gpu_impl.recording import Pieces
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes.model import Light, Scene

SIZE = (24, 18)


def evaluated(scene: Scene, light: Light, pieces: Pieces) -> np.ndarray:
    """Airlight of recorded pieces in float64 and without OpenGL, (h, w, 3)."""
    height, width = pieces.start.shape
    origin, direction, _ = (
        part.reshape(height * width, -1) for part in scene.camera.rays(pieces.positions.astype(float))
    )
    origin, direction = origin[pieces.cell], direction[pieces.cell]
    begin = pieces.start.ravel()[pieces.cell].astype(float) + pieces.t0
    to_light = light.position - origin
    t_h = np.einsum("ni,ni->n", to_light, direction)
    h = np.linalg.norm(np.cross(to_light, direction), axis=-1)
    value = airlight(h, begin - t_h, begin + pieces.dt - t_h, scene.medium, scene.phase)
    value = value * pieces.w[:, None] * np.exp(-np.multiply.outer(begin, scene.medium.sigma_t)) * light.intensity
    total = np.zeros((height * width, 3))
    np.add.at(total, pieces.cell, value)
    return total.reshape(height, width, 3)


@pytest.mark.parametrize("technique", ["lit_intervals", "uniform_march", "lit_intervals:printed", "front_final"])
@pytest.mark.parametrize("downsample", [1, 2])
def test_recorded_pieces_make_the_picture(technique: str, downsample: int, tmp_path) -> None:
    emitters = spot("1, 3, 1", "0, 0, 0", 25, 25) + point(-2, 1, 1)
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), emitters=emitters, size=SIZE)
    # the model takes pieces of a spot inside its cone, so that they are cut there before they are recorded
    chosen = find_technique(f"{technique}+quadrature", steps=16, shadow_map=64, downsample=downsample)
    with Renderer(scene) as renderer:
        frame = renderer.render(chosen)
        recorded = renderer.record(chosen)
        each = [evaluated(scene, light, pieces) for light, pieces in zip(scene.lights, recorded, strict=True)]
        found = renderer.reconstructed(chosen, each)
    assert frame.scattering.max() > 0
    # float32 against float64, of the brightest: measured 4e-7
    np.testing.assert_allclose(found, frame.scattering, atol=3e-6 * frame.scattering.max())
    if downsample == 1:
        # the strategy reports all that is recorded; what lies outside a cone is not handed on
        counts = sum(np.bincount(pieces.cell, minlength=SIZE[0] * SIZE[1]) for pieces in recorded)
        assert (counts <= frame.lit_intervals.ravel()).all()


def test_pieces_are_sorted_and_a_recording_build_draws_the_same_bits(tmp_path) -> None:
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), emitters=point(1, 2, 1), size=SIZE)
    chosen = find_technique("uniform_march+riemann", steps=16, shadow_map=64)
    with Renderer(scene) as renderer:
        before = renderer.render(chosen).scattering
        (pieces,) = renderer.record(chosen)
        after = renderer.render(chosen).scattering
    np.testing.assert_array_equal(before, after)
    assert (np.diff(pieces.cell) >= 0).all()
    assert (np.diff(pieces.t0)[np.diff(pieces.cell) == 0] > 0).all()
    assert pieces.cell.size == np.unique(np.column_stack([pieces.cell, pieces.t0]), axis=0).shape[0]
