"""Bytes on the GPU are those that were allocated, and what a technique keeps is told from what a frame uses."""

from __future__ import annotations

from scene_files import sphere, write_scene

from gpu_impl.context import create_context
from gpu_impl.device import shared_device
from gpu_impl.memory import ALLOCATORS, footprint, tally
from gpu_impl.renderer import Renderer
from gpu_impl.techniques import find_technique


def test_the_tally_counts_bytes_until_they_are_released() -> None:
    context = shared_device().context
    with tally(context) as counted:
        buffer = context.buffer(reserve=100)
        texture = context.texture((7, 5), 4, dtype="f4")
        assert counted.held == 100 + 7 * 5 * 4 * 4
        layers = context.texture_array((4, 3, 2), 2, dtype="f2")
        depth = context.depth_renderbuffer((8, 8))
        most = 100 + 560 + 4 * 3 * 2 * 2 * 2 + 8 * 8 * 4
        assert counted.held == most
        for one in (buffer, layers, depth):
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
    for found in (march, bounded):
        assert found.compile_milliseconds >= 0
        assert found.setup_milliseconds >= 0


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
