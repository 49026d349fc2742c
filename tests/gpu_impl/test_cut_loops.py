"""A picture that lacks what OpenGL did not get to is no picture."""

from __future__ import annotations

import pytest

from gpu_impl.passes import scattering
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes.errors import InputError
from scenes.loader import load


def test_loops_that_opengl_cuts_off_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    # llvmpipe ends them after 65,535 turns; where they end by themselves nothing is to be seen
    scene, long = load("empty", size=(4, 4)), find_technique("uniform_march+riemann", steps=1 << 18, shadow_map=1)
    with Renderer(scene) as renderer:
        if renderer.device.info.is_software:
            for draw in (renderer.render, renderer.record):
                with pytest.raises(InputError, match="fewer steps"):
                    draw(long)
        fine = renderer.render(find_technique("uniform_march+riemann", steps=1 << 14, shadow_map=1))
        assert (fine.lit_intervals == 1 << 14).all()
        # a loop that never had so many turns as it should
        monkeypatch.setattr(scattering, "TURNS", 1 << 18)
        if renderer.device.info.is_software:
            with pytest.raises(InputError, match="fewer steps"):
                renderer.render(find_technique("uniform_march+riemann", steps=1, shadow_map=1))
