"""Renderers that know what is lit: OpenGL's, with the ray casting of the reference for techniques that ask for it."""

from __future__ import annotations

from dataclasses import replace

from gpu_impl.device import Device
from gpu_impl.given import Found
from gpu_impl.renderer import Renderer
from scenes.model import Array, Scene


def open_renderer(scene: Scene, device: Device | None = None) -> Renderer:
    """Hold a scene on the GPU; a context manager. Mitsuba is asked when a technique wants lit intervals, not before."""
    return Renderer(scene, device, find_lit)


def find_lit(scene: Scene, number: int, positions: Array, ends: Array) -> Found:
    """Find lit intervals of one light on the rays through positions in the image; see `gpu_impl.given.Finder`.

    The rays end where Mitsuba's do, whatever surface OpenGL sees there.
    """
    return find_lit_up_to(scene, number, positions, None)


def find_lit_up_to(scene: Scene, number: int, positions: Array, ends: Array | None) -> Found:
    """Find the same on rays that end where OpenGL's do, or where Mitsuba's do."""
    from reference.deterministic import lit_intervals

    found = lit_intervals(replace(scene, lights=(scene.lights[number],)), positions, ends)
    return Found(found.offsets, found.begin, found.end)
