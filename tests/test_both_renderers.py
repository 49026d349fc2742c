"""The same scene file in both renderers: surfaces as bright, silhouettes in the same place.

The scenes are the shipped ones and those of tests/others, written as other people and other programs write them.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from reference.estimators import Equiangular
from reference.integrator import dr, eye_path, mi
from scenes.catalogue import shipped
from scenes.loader import load
from scenes.model import Scene

OTHERS = Path(__file__).parent / "others"
# a quarter of a pixel's footprint of depth, and the tessellation's chord error
DEPTH = 0.02


def mitsuba_surface_and_depth(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Surface layer, (H, W, 3), and distance to the surface or the far plane, (H, W)."""
    estimator = Equiangular(scene)
    made = estimator.mitsuba
    ray = estimator.rays(dr.arange(mi.UInt32, scene.camera.width * scene.camera.height))
    depth = np.array(eye_path(made.scene, ray, made.medium).t_end, np.float64).reshape(estimator.shape)
    return estimator.fixed()["surface"], np.minimum(depth, scene.camera.rays()[2])


def far_from_any(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Pixels of `one`, (H, W), whose distance no pixel of `other` within one pixel of it comes near."""
    padded = np.pad(other, 1, mode="edge")
    height, width = one.shape
    near = [padded[y : y + height, x : x + width] for y in range(3) for x in range(3)]
    low, high = np.min(near, axis=0) * (1 - DEPTH), np.max(near, axis=0) * (1 + DEPTH)
    return (one < low) | (one > high)


def agree(scene: Scene) -> None:
    with Renderer(scene) as renderer:
        frame = renderer.render(find_technique("lit_intervals+quadrature", steps=16))
    surface, depth = mitsuba_surface_and_depth(scene)
    # Silhouettes lie within one pixel of each other. Embree lets a ray slip through where triangles meet, now and then:
    # measured one pixel of 65,536, on many_objects.
    assert far_from_any(frame.depth, depth).sum() <= 2
    assert far_from_any(depth, frame.depth.astype(np.float64)).sum() <= 2
    if scene.meshes:
        assert surface.mean() > 0
        # largest measured: 0.3 % (wire_mesh, whose wires are some texels of the shadow map thick)
        assert frame.surface.mean() == pytest.approx(surface.mean(), rel=5e-3)
    assert frame.scattering.mean() > 0


@pytest.mark.parametrize("name", sorted(path.stem for path in OTHERS.glob("*.xml")))
def test_scenes_of_others(name: str, others: Path) -> None:
    agree(load(others / f"{name}.xml"))


@pytest.mark.parametrize("name", shipped())
def test_shipped_scenes(name: str) -> None:
    agree(load(name, size=(512, 512)))


def test_there_are_as_many_as_promised() -> None:
    assert len(list(OTHERS.glob("*.xml"))) >= 10
    assert len(shipped()) == 11
