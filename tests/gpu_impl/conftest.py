from __future__ import annotations

from collections.abc import Callable

import pytest

from gpu_impl.frame import Frame
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes.model import Scene


@pytest.fixture
def draw() -> Callable[..., Frame]:
    """Draw a scene with a technique and its settings."""

    def drawn(scene: Scene, technique: str, **settings: int) -> Frame:
        with Renderer(scene) as renderer:
            return renderer.render(find_technique(technique, **settings))

    return drawn
