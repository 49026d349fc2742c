"""The public face of airlight, for scripts and notebooks.

>>> import airlight
>>> scene = airlight.load("sphere", size=(64, 64))
>>> frame = airlight.render(scene, "Weng2010")
>>> truth = airlight.reference(scene, rel_error=0.02)
>>> airlight.compare(frame.scattering, truth.scattering).rel_50 < 0.05
True

Import it before `drjit` or `mitsuba`: it chooses an LLVM library that Dr.Jit works with.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from scenes.errors import InputError

if TYPE_CHECKING:
    from experiments.metrics import Image, Metrics
    from gpu_impl.frame import Frame
    from reference.estimate import Reference
    from scenes.model import Scene

__all__ = ["InputError", "compare", "load", "reference", "render"]


def load(scene: str | Path, size: tuple[int, int] | None = None, **parameters: object) -> Scene:
    """Load a scene: a shipped one by name or any Mitsuba XML file; see `scenes.loader.load`."""
    from scenes.loader import load as load_scene

    return load_scene(scene, size, **parameters)


def render(scene: Scene, technique: str = "Weng2010", **settings: int) -> Frame:
    """Draw a scene with an OpenGL technique.

    Parameters
    ----------
    technique : a name, or a cell such as "lit_intervals+quadrature"
    settings : `steps`, `shadow_map`, `downsample`
    """
    from gpu_impl.renderer import Renderer
    from gpu_impl.techniques import find_technique

    chosen = find_technique(technique, **settings)
    with Renderer(scene) as renderer:
        return renderer.render(chosen)


def reference(scene: Scene, rel_error: float = 0.005, time_limit: float = 600.0) -> Reference:
    """Estimate a scene's reference in Mitsuba, or take it from the cache.

    Parameters
    ----------
    rel_error : standard error to reach, relative to the pixel, at the 95th percentile
    time_limit : [s]
    """
    from reference.estimate import estimate_reference
    from reference.goal import Goal

    return estimate_reference(scene, Goal(rel_error, time_limit))


def compare(test: Image, truth: Image, standard_error: Image | None = None) -> Metrics:
    """Measure how far a picture, (H, W, 3), is from its reference; see `experiments.metrics.measure`."""
    from experiments.metrics import measure

    return measure(test, truth, standard_error)
