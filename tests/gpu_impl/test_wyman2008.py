"""Wyman 2008: its march against the exact shadow and against merged intervals, its table, and the faults of both."""

from __future__ import annotations

import itertools
from functools import cache

import numpy as np
import pytest
from scene_files import write_scene
from shadow_volumes import shadowed_airlight

from analytic import MODELS
from analytic.segments import Segments
from gpu_impl.frame import Frame
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import TECHNIQUES, find_technique
from scenes.loader import load
from scenes.model import Scene

SIZE, SHADOW_MAP = (48, 48), 2048
# a gap between two shadows, and light that comes through a narrow slit
TWO_SHADOWS, SLIT = "light_behind_eye", "slit"
TABLES = ("sun2005:32", "sun2005", "sun2005:128", "sun2005:512")


@cache
def shipped(name: str) -> Scene:
    return load(name, size=SIZE)


@cache
def drawn(name: str, cell: str, steps: int) -> Frame:
    with Renderer(shipped(name)) as renderer:
        return renderer.render(find_technique(cell, steps=steps, shadow_map=SHADOW_MAP))


def signed_error(name: str, airlight: str, steps: int) -> np.ndarray:
    """Error of each pixel's red relative to it, or to a thousandth of the mean where it is darker, (H, W)."""
    frame = drawn(name, f"bounded_march+{airlight}", steps)
    truth = shadowed_airlight(shipped(name), frame.depth.astype(np.float64))[..., 0]
    return (frame.scattering[..., 0] - truth) / np.maximum(truth, 1e-3 * truth.mean())


def error(name: str, airlight: str, steps: int, percentile: float) -> float:
    return float(np.percentile(np.abs(signed_error(name, airlight, steps)), percentile))


def test_the_technique_is_the_published_one() -> None:
    technique = TECHNIQUES["Wyman2008"]
    assert (technique.visibility, technique.airlight) == ("bounded_march", "sun2005")


def test_without_an_occluder_it_is_one_piece_and_the_model_alone(tmp_path) -> None:
    scene = write_scene(tmp_path, size=(16, 16))
    with Renderer(scene) as renderer:
        technique = find_technique("Wyman2008", shadow_map=64)
        frame, reads = renderer.render(technique), renderer.counts(technique)["shadow_map_reads"]
    assert (frame.lit_intervals == 1).all()
    # four texels around the middle of the ray decide; no step is taken
    assert reads.max() <= 4
    origin, direction, t_max = scene.camera.rays()
    to_light, sigma_t = scene.lights[0].position - origin, np.ravel(scene.medium.sigma_t)[0]
    t_h = np.einsum("hwi,hwi->hw", to_light, direction).ravel()
    h = np.linalg.norm(np.cross(to_light, direction), axis=-1).ravel()
    end = np.minimum(t_max.ravel(), np.maximum(t_h, 0) + 16 / sigma_t)
    rays = Segments.between(h, -t_h, end - t_h, np.full_like(h, sigma_t))
    scale = np.ravel(scene.medium.sigma_s)[0] * scene.lights[0].intensity[0]
    exact = scale * MODELS["sun2005"].function(rays, scene.phase)
    # measured: 6.9e-7
    assert np.abs(frame.scattering[..., 0].ravel() / exact - 1).max() < 4e-6


@pytest.mark.parametrize("name", [TWO_SHADOWS, SLIT])
def test_its_steps_are_the_samples_of_lit_intervals(name: str) -> None:
    """The same samples, merged to fewer pieces: with an exact model both are one picture."""
    marched, merged = (drawn(name, f"{strategy}+quadrature", 64) for strategy in ("bounded_march", "lit_intervals"))
    light = merged.scattering[..., 0]
    # measured: 1.5e-6 of the pixel
    apart = np.abs(marched.scattering[..., 0].astype(np.float64) - light)
    # where a sample meets a texel's border to a rounding, the loops may differ about it: measured, one ray of the slit
    assert (apart > 1e-5 * light).sum() <= 1
    assert (marched.lit_intervals >= merged.lit_intervals).all()
    # measured: 5.0 and 1.6 pieces a ray with two shadows, 5.6 and 0.5 behind the slit
    assert marched.lit_intervals.mean() > 2.5 * merged.lit_intervals.mean()


def test_more_steps_and_a_larger_table_come_to_the_exact_shadow() -> None:
    # what the table leaves, where most rays meet no shadow: measured 0.132, 2.9e-2, 5.8e-3 and 3.8e-4
    of_table = [error(TWO_SHADOWS, table, 64, 50) for table in TABLES]
    assert all(fine < 0.4 * coarse for coarse, fine in itertools.pairwise(of_table))
    assert of_table[-1] < 1e-3
    # what the steps leave, in the slit: measured 0.218, 5.9e-2 and 1.6e-2
    of_steps = [error(SLIT, "sun2005:512", steps, 95) for steps in (16, 64, 256)]
    assert all(fine < 0.4 * coarse for coarse, fine in itertools.pairwise(of_steps))
    assert of_steps[-1] < 3e-2


def test_steps_are_seen_as_bands() -> None:
    """Its known fault: a shaft's ends are rounded to whole steps, so that the error jumps from pixel to pixel."""

    def jump(steps: int) -> float:
        # between two pixels side by side that are partly lit, beyond the shadow region's ends
        off = signed_error(SLIT, "quadrature", steps)
        pieces = drawn(SLIT, "bounded_march+quadrature", steps).lit_intervals
        partly = (pieces[:, 1:] > 1) & (pieces[:, :-1] > 1)
        return float(np.percentile(np.abs(np.diff(off, axis=1))[partly], 75))

    # measured: 9.7e-2, 5.5e-2, 2.9e-2 and 1.4e-2
    jumps = [jump(steps) for steps in (32, 64, 128, 256)]
    assert jumps[0] > 0.05
    # first order: each a step's light
    assert all(fine < 0.7 * coarse for coarse, fine in itertools.pairwise(jumps))


def test_short_pieces_lose_digits() -> None:
    """Its other fault: a piece is the difference of two reads, which more steps make more alike.

    Both strategies have the same samples lit, so that what is between them is rounding.
    """

    def rounding(airlight: str, steps: int) -> float:
        marched, merged = (
            drawn(TWO_SHADOWS, f"{strategy}+{airlight}", steps) for strategy in ("bounded_march", "lit_intervals")
        )
        several = marched.lit_intervals > merged.lit_intervals
        apart = marched.scattering[..., 0].astype(np.float64) - merged.scattering[..., 0]
        return float(np.percentile(np.abs(apart / merged.scattering[..., 0])[several], 95))

    table, exact = ([rounding(model, steps) for steps in (64, 512, 2048)] for model in ("sun2005", "quadrature"))
    # measured: 2.7e-6, 1.0e-5 and 3.2e-5; the quadrature 2.9e-7, 5.4e-7, 1.6e-6
    assert table[2] > 2 * table[1] > 4 * table[0]
    assert all(lost > 5 * kept for lost, kept in zip(table, exact, strict=True))


def test_a_short_piece_shows_the_slope_between_two_samples() -> None:
    """And a third: F is read as straight between its samples, so that many short steps do not reach the truth."""
    table, exact = (error(SLIT, model, 1024, 95) for model in ("sun2005", "quadrature"))
    # measured: 6.0e-2 and 1.5e-2, where at 64 steps they are 6.4e-2 and 5.9e-2
    assert table > 2 * exact
    assert error(SLIT, "sun2005", 64, 95) < 1.3 * error(SLIT, "quadrature", 64, 95)


def test_two_tables_in_one_renderer() -> None:
    """Each model keeps a table of its own from frame to frame."""
    chosen = [find_technique(f"bounded_march+{table}", shadow_map=64) for table in ("sun2005:32", "sun2005:512")]
    with Renderer(shipped(SLIT)) as renderer:
        together = [renderer.render(technique).scattering for technique in chosen]
    for technique, image in zip(chosen, together, strict=True):
        with Renderer(shipped(SLIT)) as renderer:
            np.testing.assert_array_equal(renderer.render(technique).scattering, image)
    assert (together[0] != together[1]).any()
