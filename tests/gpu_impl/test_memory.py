"""Bytes on the GPU are those that were allocated, and what a technique keeps is told from what a frame uses."""

from __future__ import annotations

from typing import ClassVar

from scene_files import sphere, write_scene

from gpu_impl import memory
from gpu_impl.context import create_context
from gpu_impl.device import shared_device
from gpu_impl.memory import ALLOCATORS, footprint, tally
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import Technique, find_technique
from gpu_impl.timing import NO_CLOCK, Clock


def test_the_tally_counts_bytes_until_they_are_released() -> None:
    context = shared_device().context
    with tally(context) as counted:
        buffer = context.buffer(reserve=100)
        texture = context.texture((7, 5), 4, dtype="f4")
        assert counted.held == 100 + 7 * 5 * 4 * 4
        display = context.texture((4, 3), 2, dtype="f1")
        depth = context.depth_renderbuffer((8, 8))
        most = 100 + 560 + 4 * 3 * 2 + 8 * 8 * 4
        assert counted.held == most
        for one in (buffer, display, depth):
            one.release()
        assert counted.held == 560
        assert counted.peak() == most
        # from what is there now
        assert counted.peak() == 560
        texture.release()
        assert counted.held == 0
    # nothing is counted any more, and nothing in the way
    context.buffer(reserve=8).release()
    assert counted.peak() == 560
    assert not set(ALLOCATORS) & set(vars(context))


def test_a_context_without_a_tally_is_untouched_by_another() -> None:
    other = create_context()
    with tally(shared_device().context) as counted:
        other.buffer(reserve=64).release()
        assert counted.peak() == 0
    other.release()
    # the first is the one that is current again
    shared_device().context.__enter__()


def test_the_footprint_of_a_march_and_of_shadow_polygons(tmp_path) -> None:
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), size=(32, 24))
    march, bounded = (
        footprint(scene, find_technique(name, steps=4, shadow_map=16), shared_device(), frames=1)
        for name in ("uniform_march+riemann", "lit_intervals+riemann")
    )
    mesh = scene.meshes[0]
    # positions and normals of three floats, three indices
    assert march.scene_bytes == bounded.scene_bytes == 2 * mesh.vertices.size * 4 + mesh.faces.size * 4
    assert march.storage_bytes == 0
    # a closed mesh has 3/2 edges a face, and an edge at least two corners and two opposite ones
    assert bounded.storage_bytes >= 1.5 * len(mesh.faces) * 4 * 4
    # the first and the last shadow polygon of each pixel
    assert bounded.frame_bytes >= march.frame_bytes + 32 * 24 * 2 * 4


def test_compiling_and_set_up_are_what_first_frames_take_beyond_later_ones(tmp_path, monkeypatch) -> None:
    class Slow(Renderer):
        """A renderer in which compiling takes 100 ms, set-up 30 and a frame 5."""

        compiled: ClassVar[set[str]] = set()

        def __init__(self, *settings: object) -> None:
            super().__init__(*settings)
            self.ready: set[str] = set()

        def frame_time(self, technique: Technique, number: int, clock: Clock = NO_CLOCK) -> float:
            super().frame_time(technique, number, clock)
            name = technique.name
            took = 5.0 + 30.0 * (name not in self.ready) + 100.0 * (name not in self.compiled)
            self.ready.add(name)
            self.compiled.add(name)
            return took

    monkeypatch.setattr(memory, "Renderer", Slow)
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), size=(8, 8))
    found = footprint(scene, find_technique("uniform_march+riemann", steps=4, shadow_map=16), shared_device())
    assert found.compile_milliseconds == 100
    assert found.setup_milliseconds == 30
    assert found.scene_milliseconds > 0


def test_shadow_maps_are_the_frame_s_and_once_more_in_a_buffer(tmp_path) -> None:
    scene = write_scene(tmp_path, shapes=sphere(0.3, 1.3, 0, 0.4), size=(16, 16))

    def peak(**settings: object) -> int:
        device = shared_device()
        device.release_spare_textures()
        with tally(device.context) as counted, Renderer(scene) as renderer:
            renderer.frame_time(find_technique("uniform_march+riemann", steps=4, **settings), 0)
            return counted.peak()

    small = peak(shadow_map=64)
    # six faces of a cube
    assert peak(shadow_map=128) - small == 6 * (128**2 - 64**2) * 4
    assert peak(shadow_map=64, shadow_storage="buffer") - small == 6 * 64**2 * 4
