"""`airlight exactness`: what it says of the controls, and that it notices controls that are none."""

from __future__ import annotations

import numpy as np
import pytest
from typer.testing import CliRunner

from experiments.cli import app
from experiments.exactness import study
from experiments.exactness.study import Stable, against_reference, lit_length
from experiments.renderers import open_renderer
from gpu_impl.techniques import find_technique
from reference.estimate import deterministic_reference, estimate_reference
from reference.goal import Goal
from scenes.loader import load

SMALL = ("--size", "24", "24", "--shadow-map", "128")


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "GOAL", Goal(rel_error=0.05))


def test_the_command_says_what_holds(tmp_path) -> None:
    result = CliRunner().invoke(app, ["exactness", "sphere", "eye_in_shadow", *SMALL, "--out", str(tmp_path / "page")])
    assert result.exit_code == 0, result.output
    page = (tmp_path / "page" / "README.md").read_text()
    assert "an image mean within the limit: 2 of 2" in page
    assert "given intervals within the reference's noise: 2 of 2" in page
    assert "| sphere | 256 |" in page
    assert "--shadow-map 128" in page


def test_controls_that_are_none_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half as many texels as the limit needs, and a march in place of given intervals."""
    monkeypatch.setattr(study, "EXACT", "uniform_march+riemann")
    monkeypatch.setattr(study, "GIVEN", "front_final+quadrature")
    result = CliRunner().invoke(app, ["exactness", "slit", *SMALL])
    assert result.exit_code == 1
    assert "an image mean within the limit: 0 of 1, not slit" in " ".join(result.output.split())
    assert "given intervals within the reference's noise: 0 of 1, not slit" in " ".join(result.output.split())


def test_given_intervals_are_within_the_noise_and_a_shifted_light_is_not() -> None:
    scene = load("sphere", size=(24, 24))
    sampled = estimate_reference(scene, Goal(rel_error=0.02))
    with open_renderer(scene) as renderer:
        picture = renderer.render(find_technique("given+quadrature")).scattering
    truth = deterministic_reference(scene)
    assert against_reference(scene, sampled, picture, truth, "given").agrees
    # measured: the image mean's score is 27
    assert not against_reference(scene, sampled, 1.01 * picture, truth, "brighter").agrees


def test_lit_lengths_are_those_of_the_rays() -> None:
    """Without an occluder all of a ray is lit."""
    scene = load("empty", size=(8, 8))
    with open_renderer(scene) as renderer:
        technique = find_technique("exact+quadrature", shadow_map=32)
        lights, frame = renderer.record(technique), renderer.render(technique)
    assert np.allclose(lit_length(lights), frame.depth.ravel(), rtol=1e-6)


def test_stable_pixels_are_counted() -> None:
    change, error = np.array([0, 5e-4, 2e-3, 0]), np.array([0, 3e-3, 1, 1e-3])
    found = Stable.among(change, error)
    assert found.share == pytest.approx(0.75)
    assert found.within == pytest.approx(2 / 3)
    assert not found.passes
    assert Stable.among(change[[0, 3]], error[[0, 3]]).passes
    assert not Stable.among(np.ones(4), error).passes
