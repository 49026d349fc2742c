"""Slices parallel to the image, drawn cell by cell (Dobashi 2002; shaders/visibility/slices.vert.glsl)."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import Any

from gpu_impl.camera_uniforms import camera_uniforms
from gpu_impl.device import Device
from gpu_impl.light_uniforms import light_defines, light_uniforms
from gpu_impl.shader_source import set_uniforms
from gpu_impl.visibilities.strategy import FogInputs, Supply, Visibility
from scenes.errors import InputError

# binding of the storage block of shaders/slices/range.glsl, and bits of infinity, above those of any depth
RANGE, INFINITY = 4, 0x7F800000


def check_slices(device: Device) -> None:
    """Raise InputError where this OpenGL cannot draw slices."""
    if device.context.info["GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS"] < 1:
        raise InputError(
            "Slices need a storage block in a vertex shader, and this OpenGL has none "
            "(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS): use a cell without them, such as uniform_march+riemann."
        )


class Slices(Supply):
    """The range of depths that the slices of one light share evenly, and how they are drawn.

    Parameters
    ----------
    defines : CELL, pixels of the lattice on a side of a cell, and IN_BEAM; see shaders/slices/range.frag.glsl
    """

    def __init__(self, inputs: FogInputs, defines: Mapping[str, int]) -> None:
        self._steps, self._size, self._cell = inputs.technique.steps, inputs.lattice.size, defines["CELL"]
        device, scene, light = inputs.device, inputs.scene, inputs.light
        self._range = device.buffer(8)
        self._range.write(struct.pack("2I", INFINITY, 0))
        with inputs.clock.time_pass("scattering"):
            program = device.program(
                "slices/range.frag.glsl",
                defines={**light_defines(scene, light), **defines},
                includes={"<lattice>": inputs.lattice.kind.source},
            )
            set_uniforms(program, camera_uniforms(scene.camera) | light_uniforms(scene, light, inputs.pictures))
            set_uniforms(program, inputs.lattice.uniforms | inputs.gbuffer.bind(first_unit=1))
            self._range.bind_to_storage_buffer(RANGE)
            target = device.texture(self._size, 1)
            device.fill(program, target)
            device.context.memory_barrier()
            device.give_back(target)

    def bind(self, program: Any) -> None:
        """Bind the range."""
        self._range.bind_to_storage_buffer(RANGE)

    def draw(self, device: Device, program: Any, targets: tuple[Any, ...], add: bool) -> None:
        """Draw all cells of all slices, added up."""
        context = device.context
        target = context.framebuffer(color_attachments=targets)
        if not add:
            target.clear()
        target.use()
        columns, rows = (-(-pixels // self._cell) for pixels in self._size)
        array = context.vertex_array(program, [])
        context.enable(context.BLEND)
        context.blend_func = context.ONE, context.ONE
        array.render(context.TRIANGLE_STRIP, vertices=2 * (columns + 1), instances=rows * self._steps)
        context.disable(context.BLEND)
        array.release()
        target.release()

    def give_back(self, device: Device) -> None:
        """Give the range's buffer back."""
        device.give_back(self._range)


def slices(cell: int, in_beam: bool = False) -> Visibility:
    """Slices from the viewpoint to where fog or the scene ends, or those of them that meet a spot's beam.

    Parameters
    ----------
    cell : int       pixels of the lattice on a side of a cell
    in_beam : bool   whether what lies outside a spot's cone is left out
    """
    defines = {"CELL": cell, "IN_BEAM": int(in_beam)}
    where = " between the ends of the beam" if in_beam else ""
    return Visibility(
        "visibility/slices.glsl",
        f"slices parallel to the image{where}, airlight interpolated over cells of {cell} x {cell} (Dobashi 2002)",
        supply=lambda inputs: Slices(inputs, defines),
        vertex="visibility/slices.vert.glsl",
        defines=defines,
        grid_only=True,
        airlight_at_corners=True,
        check=check_slices,
    )
