"""What is drawn leaves nothing behind on the GPU or in memory."""

from __future__ import annotations

import ctypes
import os
from pathlib import Path

import pytest

from gpu_impl import frame_passes
from gpu_impl.context import shared_context
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique
from scenes.loader import load


def live_objects() -> dict[str, int]:
    """How many OpenGL objects of each kind there are."""
    context = shared_context()
    opengl = ctypes.CDLL("libGL.so.1")
    vertex = "#version 430\nvoid main() { gl_Position = vec4(0.0); }"
    made = {
        "Texture": context.texture((1, 1), 4),
        "Buffer": context.buffer(reserve=4),
        "Renderbuffer": context.depth_renderbuffer((1, 1)),
        "Program": context.program(vertex_shader=vertex),
    }
    made["Framebuffer"] = context.framebuffer([made["Texture"]])
    made["VertexArray"] = context.vertex_array(made["Program"], [])
    # names are handed out in rising order, so those of new objects bound the others'
    last = {kind: item.glo for kind, item in made.items()}
    for item in made.values():
        item.release()
    live = {}
    for kind, bound in last.items():
        exists = getattr(opengl, f"glIs{kind}")
        exists.restype = ctypes.c_ubyte
        live[kind] = sum(exists(name) for name in range(1, bound))
    return live


def test_nothing_is_left_on_the_gpu() -> None:
    scene = load("sphere", size=(8, 8))
    technique = find_technique("Weng2010", steps=4, shadow_map=16, downsample=2)
    # programs are compiled once a process and stay
    with Renderer(scene) as renderer:
        renderer.render(technique)
        renderer.milliseconds(technique, frames=1)
    outside = live_objects()
    with Renderer(scene) as renderer:
        renderer.render(technique)
        # a frame that is shown takes textures beside the view that `render` keeps
        renderer.milliseconds(technique, frames=1)
        before = live_objects()
        assert before["Texture"] > outside["Texture"]
        for _ in range(5):
            renderer.render(technique)
        renderer.milliseconds(technique, frames=5)
        assert live_objects() == before
        # the count sees one forgotten texture
        forgotten = shared_context().texture((1, 1), 4)
        assert live_objects()["Texture"] == before["Texture"] + 1
        forgotten.release()
    assert live_objects() == outside


def resident_megabytes() -> float:
    """Memory of this process that is in use: llvmpipe's textures are part of it."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def test_a_thousand_frames_leave_nothing() -> None:
    scene = load("slit", size=(64, 64))
    technique = find_technique("Weng2010", steps=4, shadow_map=64, downsample=2)
    with Renderer(scene) as renderer:
        renderer.milliseconds(technique, frames=100)
        objects, before = live_objects(), resident_megabytes()
        renderer.milliseconds(technique, frames=1000)
        assert live_objects() == objects
        # a full-size texture lost in each frame would be 62 MB; measured 0.1
        assert resident_megabytes() - before < 6


def test_another_size_leaves_nothing() -> None:
    technique = find_technique("Weng2010", steps=4, shadow_map=64, downsample=2)
    sizes = [(8, 8), (33, 17), (64, 64), (5, 70)]
    counts = []
    for _ in range(2):
        for size in sizes:
            with Renderer(load("slit", size=size)) as renderer:
                renderer.render(technique)
                renderer.milliseconds(technique, frames=2)
        counts.append(live_objects())
    assert counts[0] == counts[1]


@pytest.mark.parametrize("name", ["Chen2011", "Dobashi2002", "James2003", "Weng2010"])
@pytest.mark.parametrize("place", ["add_scattering", "add_surface", "combine"])
def test_an_interrupted_frame_leaves_nothing(name: str, place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its textures and buffers serve the next; and views that were kept before are still there."""

    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    technique = find_technique(name, steps=4, shadow_map=16, downsample=2)
    with Renderer(load("slit", size=(24, 16))) as renderer:
        whole = renderer.render(technique)
        renderer.picture(technique)
        before = live_objects()
        for _ in range(3):
            with monkeypatch.context() as patched:
                patched.setattr(frame_passes, place, stop)
                with pytest.raises(KeyboardInterrupt):
                    renderer.picture(technique)
                # of a view that is kept, which has its surfaces already
                if place != "add_surface":
                    with pytest.raises(KeyboardInterrupt):
                        renderer.render(technique)
            renderer.picture(technique)
        assert live_objects() == before
        again = renderer.render(technique)
    for layer, image in whole.layers.items():
        assert (image == again.layers[layer]).all(), layer


def test_an_interrupted_recording_leaves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    technique = find_technique("Chen2011", steps=4, shadow_map=16)
    with Renderer(load("slit", size=(24, 16))) as renderer:
        renderer.record(technique)
        before = live_objects()
        with monkeypatch.context() as patched:

            def stop(*_: object) -> None:
                raise KeyboardInterrupt

            patched.setattr(renderer.passes, "rays", stop)
            for _ in range(3):
                with pytest.raises(KeyboardInterrupt):
                    renderer.record(technique)
        renderer.record(technique)
        assert live_objects() == before
