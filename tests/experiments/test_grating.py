"""The scene in which nothing but the number of lit intervals changes, against ray casting and its own geometry."""

from __future__ import annotations

import runpy

import numpy as np
import pytest

import airlight
from experiments.suite.reading import FOLDER
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes.loader import load

SCENE = FOLDER / "scenes" / "grating.xml"
GAPS = (1, 2, 4, 8, 16, 32)
SIZE = 24, 24


def lit_length_of_closed_form(camera) -> np.ndarray:
    """Half of the fan of light, as the light sees it: how far x / (4 - y) goes along a ray is all that counts."""
    origin, direction, _ = camera.rays()
    # on a ray x / (4 - y) = s at t = (s (4 - oy) - ox) / (dx + s dy); the fan is s from -1/2 to 1/2
    ends = [
        (s * (4 - origin[..., 1]) - origin[..., 0]) / (direction[..., 0] + s * direction[..., 1]) for s in (-0.5, 0.5)
    ]
    return ends[1] - ends[0]


def test_the_committed_bars_are_those_of_the_script() -> None:
    script = runpy.run_path(str(FOLDER.parents[1] / "scripts" / "make_gratings.py"))
    assert script["GAPS"] == GAPS
    for gaps in GAPS:
        assert (SCENE.parent / f"grating_{gaps}.xml").read_text() == script["grating"](gaps)


@pytest.mark.parametrize("gaps", GAPS)
def test_every_ray_is_lit_on_as_many_pieces_as_there_are_gaps(gaps: int) -> None:
    scene = load(SCENE, SIZE, gaps=gaps)
    pieces = airlight.lit_intervals(scene)
    counts = np.bincount(pieces.pixel, minlength=SIZE[0] * SIZE[1])
    assert set(counts) == {gaps}
    # half of the fan whatever the number of gaps; where it is cut finely its perspective no longer matters
    share = np.bincount(pieces.pixel, pieces.end - pieces.begin) / lit_length_of_closed_form(scene.camera).ravel()
    # measured: 0.0509 with 1 gap, 0.0515 / gaps with 8, 16 and 32
    assert np.abs(share - 0.5).max() < 0.052 / gaps
    # the same bars in all
    assert sum(len(mesh.faces) for mesh in scene.meshes) == 2 * 32 + 5 * 2


def test_the_march_finds_all_of_them_with_256_samples() -> None:
    for gaps in GAPS:
        with Renderer(load(SCENE, SIZE, gaps=gaps)) as renderer:
            found = renderer.counts(find_technique("lit_intervals+quadrature", steps=256))["pieces"]
        assert (found == gaps).all(), gaps
