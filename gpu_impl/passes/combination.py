"""The combination pass: "Bilateral filter" of Weng 2010, Figure 1.3.

A new upsampling is a file under shaders/upsampling and a line in `UPSAMPLINGS`.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from gpu_impl.camera_uniforms import camera_uniforms
from gpu_impl.device import Device
from gpu_impl.lattices.grid import Grid
from gpu_impl.lattices.lattice import Lattice
from gpu_impl.light_uniforms import fog_defines, fog_uniforms
from gpu_impl.passes.geometry import GBuffer
from gpu_impl.shader_source import set_uniforms
from gpu_impl.techniques import UPSAMPLINGS, Technique
from scenes.model import Scene

UNITS = {"scattering": 0, "surface": 1, "cells": 2}
FIRST_GBUFFER_UNIT = 3


def combine(
    device: Device,
    targets: tuple[Any, ...],
    technique: Technique,
    scene: Scene,
    gbuffer: GBuffer,
    surface: Any,
    airlight: Any,
    step: int,
) -> None:
    """Bring `airlight` to full resolution and put it together with the light that `surface` holds.

    Parameters
    ----------
    step : int               airlight is of the grid of every `step`-th pixel
    targets : one texture for the composite, or two for the surface's light as it reaches the eye and the airlight
    surface : RGBA32F    light as it leaves the surfaces
    airlight : RGBA32F   airlight and pieces
    """
    uniforms = camera_uniforms(scene.camera) | fog_uniforms(scene) | UNITS
    uniforms |= Grid.of(scene.camera, step).uniforms | gbuffer.bind(FIRST_GBUFFER_UNIT)
    surface.use(UNITS["surface"])
    defines = fog_defines(scene) | {"SPLIT": int(len(targets) == 2), "DOWNSAMPLED": int(step > 1)}

    def program(upsampling: str, vertex: str) -> Any:
        includes = {"<upsampling>": UPSAMPLINGS[upsampling]}
        found = device.program("combination.frag.glsl", vertex, defines, includes)
        set_uniforms(found, uniforms)
        return found

    with _interpolated(device, airlight, UNITS["scattering"]):
        # where the evaluated pixels around one see one surface, so nearly everywhere, all upsamplings are bilinear
        device.fill(program("bilinear", "fullscreen.vert.glsl"), *targets)
        if step > 1 and technique.upsample != "bilinear":
            cells = _cells(device, airlight.size, uniforms)
            cells.use(UNITS["cells"])
            _draw_points(device, program(technique.upsample, "upsampling/edges.vert.glsl"), targets, cells)
            device.give_back(cells)


def reconstruct(
    device: Device, target: Any, lattice: Lattice, scene: Scene, gbuffer: GBuffer, airlight: Any, *, first: bool
) -> None:
    """Bring one light's airlight from a lattice of its own to full resolution, as that lattice says.

    Parameters
    ----------
    target : RGBA32F      of the image's size; written by the first light, added to by others
    airlight : RGBA32F    airlight and pieces on the lattice's cells
    """
    program = device.program(
        "reconstruction.frag.glsl", includes={"<reconstruction>": str(lattice.kind.reconstruction)}
    )
    set_uniforms(program, camera_uniforms(scene.camera) | lattice.uniforms | {"scattering": UNITS["scattering"]})
    set_uniforms(program, gbuffer.bind(FIRST_GBUFFER_UNIT))
    with _interpolated(device, airlight, UNITS["scattering"]):
        device.fill(program, target, add=not first)


@contextmanager
def _interpolated(device: Device, texture: Any, unit: int) -> Iterator[None]:
    """Bind a texture that interpolates between its texels, and beyond the outermost ends in their values."""
    context = device.context
    sampler = context.sampler(repeat_x=False, repeat_y=False, filter=(context.LINEAR, context.LINEAR), texture=texture)
    sampler.use(unit)
    try:
        yield
    finally:
        sampler.clear(unit)
        sampler.release()


def _cells(device: Device, lattice: tuple[int, int], uniforms: dict[str, Any]) -> Any:
    """What the evaluated pixels around each cell of the lattice see; the caller gives the texture back."""
    program = device.program("upsampling/cells.frag.glsl")
    cells = device.texture((lattice[0] + 1, lattice[1] + 1), 4)
    set_uniforms(program, uniforms)
    device.fill(program, cells)
    return cells


def _draw_points(device: Device, program: Any, targets: tuple[Any, ...], cells: Any) -> None:
    """Draw again what lies in the cells that see more than one surface."""
    context = device.context
    target = context.framebuffer(color_attachments=targets)
    target.use()
    array = context.vertex_array(program, [])
    context.enable(context.PROGRAM_POINT_SIZE)
    array.render(context.POINTS, vertices=cells.width * cells.height)
    context.disable(context.PROGRAM_POINT_SIZE)
    array.release()
    target.release()
