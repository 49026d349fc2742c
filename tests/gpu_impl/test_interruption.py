"""What stops a frame half-way leaves no trace in the next."""

from __future__ import annotations

import pytest

from gpu_impl import frame_passes, geometry
from gpu_impl.passes import shadow_volume
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from gpu_impl.visibilities import shadow_polygons
from scenes.loader import load

PLACES = ["render_gbuffer", "render_shadow_map", "add_surface", "add_scattering", "combine"]


def interrupt(*_: object, **__: object) -> None:
    raise KeyboardInterrupt


@pytest.mark.parametrize("place", ["mesh 0", "mesh 3", "polygons", "silhouettes", *PLACES])
def test_an_interrupted_frame_leaves_no_trace(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load("slit", size=(24, 16))
    technique = find_technique("Weng2010", steps=8, shadow_map=64, downsample=2)
    with Renderer(scene) as renderer:
        whole = renderer.render(technique)
    with Renderer(scene) as renderer, monkeypatch.context() as patched:
        if place.startswith("mesh"):
            calls, draw = iter(range(100)), geometry.MeshBuffers.draw

            def drawn(*given: object, **settings: object) -> None:
                # the first few are the eye's, the others the light's
                if next(calls) == int(place.split()[1]):
                    raise KeyboardInterrupt
                draw(*given, **settings)

            patched.setattr(geometry.MeshBuffers, "draw", drawn)
        elif place == "silhouettes":
            patched.setattr(shadow_volume, "set_uniforms", interrupt)
        elif place == "polygons":
            patched.setattr(shadow_polygons, "render_shadow_polygons", interrupt)
        else:
            patched.setattr(frame_passes, place, interrupt)
        with pytest.raises(KeyboardInterrupt):
            renderer.render(technique)
        patched.undo()
        again = renderer.render(technique)
    for layer, image in whole.layers.items():
        assert (image == again.layers[layer]).all(), layer
