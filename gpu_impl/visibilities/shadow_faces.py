"""Faces of shadow volumes, added and taken away unsorted (James 2003; shaders/visibility/shadow_faces.glsl)."""

from __future__ import annotations

from typing import Any

import numpy as np

from gpu_impl.device import Device
from gpu_impl.lattices.grid import Grid
from gpu_impl.passes.shadow_volume import world_to_grid
from gpu_impl.shader_source import set_uniforms
from gpu_impl.shadow_casters import ShadowCasters
from gpu_impl.visibilities.strategy import FogInputs, Supply
from scenes.errors import InputError
from scenes.model import Array, Camera

# bindings of the two storage blocks of shadow_faces.vert.glsl, and how many those are
FACES, DRAWS, VERTEX_BLOCKS = 4, 5, 2
# Nearer to the eye than this share of the near plane's distance a face is clipped away. The eye's volumes are counted
# at the eye itself, so that a face in between would be missed; OpenGL needs some distance to divide by.
NEAREST = 2.0**-10


def check_faces(device: Device) -> None:
    """Raise InputError where this OpenGL cannot draw faces of shadow volumes."""
    blocks = device.context.info["GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS"]
    if blocks < VERTEX_BLOCKS:
        raise InputError(
            f"Faces of shadow volumes need {VERTEX_BLOCKS} storage blocks in a vertex shader, and this OpenGL has "
            f"{blocks} (GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS): use a cell without them, such as exact+quadrature."
        )


class ShadowFaces(Supply):
    """The faces of one light's shadow volumes, which it draws behind a first piece that covers the picture."""

    def __init__(self, inputs: FogInputs) -> None:
        device, scene = inputs.device, inputs.scene
        self._casters = inputs.kept.get("shadow casters", lambda: ShadowCasters(device.context, scene))
        with inputs.clock.time_pass("shadow polygons"):
            self._casters.find_faces(device, scene, inputs.light, inputs.pictures)
        self._matrix = _world_to_lattice(scene.camera, inputs.technique.downsample)

    def bind(self, program: Any) -> None:
        """Bind both buffers, and set the faces' projection."""
        self._casters.faces.bind_to_storage_buffer(FACES)
        self._casters.draw_calls.bind_to_storage_buffer(DRAWS)
        set_uniforms(program, {"world_to_lattice": self._matrix})

    def draw(self, device: Device, program: Any, targets: tuple[Any, ...], add: bool) -> None:
        """Draw the whole ray's piece and those behind all faces, added up."""
        context = device.context
        target = context.framebuffer(color_attachments=targets)
        if not add:
            target.clear()
        target.use()
        array = context.vertex_array(program, [])
        context.enable(context.BLEND)
        context.blend_func = context.ONE, context.ONE
        array.render_indirect(self._casters.draw_calls, context.TRIANGLES, count=self._casters.draws)
        context.disable(context.BLEND)
        array.release()
        target.release()


def _world_to_lattice(camera: Camera, downsample: int) -> Array:
    """As `world_to_grid`, but that OpenGL clips much nearer to the eye."""
    matrix = world_to_grid(camera, Grid.of(camera, downsample))
    # its last row is the depth along the viewing axis: -w <= w - 2 n where that is n or more
    matrix[2] = matrix[3] - np.array([0, 0, 0, 2 * NEAREST * camera.near])
    return matrix
