"""The rectified shadow map, with a tree of least and largest thresholds over each of its rows.

In an epipolar plane (epipolar_planes.py) a ray of the eye is at the angle gamma to the axis; a light ray is at the
angle beta to it, seen from the light, and one of parallel light at the distance b. The light ray is lit up to its first
occluder, at the distance r from the light. The further out it crosses a ray of the eye, the larger is that ray's gamma,
so that all with a gamma up to the occluder's are lit where they cross it and all others are dark. The occluder has
    cot gamma = (D - r cos beta) / (r sin beta),    or x / b,
D being the distance from eye to light, and x how far the occluder is from the eye towards parallel light. Nothing but
this one number of it matters, and the ray of the eye compares one number, its own cotangent, with those of all light
rays that it crosses. The least and the largest of 2, 4, 8 ... neighbours in a row tell whether all of them are lit, or
none.

A column of a row has the number of the light ray in its middle. What a shadow map's texel does to the shadow's edge,
the column does once more, as it does not lie on the texel; and off the lattice epipolar, where rays lie between rows,
so does the row.

Source: Chen, Baran, Durand and Jarosz 2011, "Real-Time Volumetric Shadows using 1D Min-Max Mipmaps".
"""

from __future__ import annotations

from typing import Any

from gpu_impl.camera_uniforms import camera_uniforms
from gpu_impl.device import Device
from gpu_impl.epipolar_planes import EpipolarPlanes, border_pixels
from gpu_impl.light_uniforms import light_defines, light_uniforms
from gpu_impl.shader_source import set_uniforms
from gpu_impl.visibilities.strategy import FogInputs, Supply
from scenes.errors import InputError

# storage binding of the trees
TREES = 4
NODE_BYTES = 8


def column_count(inputs: FogInputs) -> int:
    """A power of two, so that columns are no wider than the shadow map's texels where those are widest.

    A narrow spot's row is at most as long as its map is wide. A row of parallel light may cross the map from corner to
    corner; that of a cube runs over half a turn, and texels are widest in the middle of a face, 2 / size.
    """
    spot = len(inputs.shadow_map.matrices) == 1 and inputs.light.kind != "directional"
    return 1 << max(1, (inputs.shadow_map.size * (1 if spot else 2) - 1).bit_length())


class MinMax(Supply):
    """A light's rows and their trees in a storage buffer.

    Where the lattice is made of epipolar planes too, whoever wrote it, the rows are its planes: the shader has one set
    of their uniforms. Otherwise there is a row for each pixel of the image's border.

    Raises
    ------
    InputError
        The trees are larger than a buffer may be.
    """

    def __init__(self, inputs: FogInputs) -> None:
        camera, planes, columns = inputs.scene.camera, inputs.lattice.uniforms, column_count(inputs)
        if "plane_count" not in planes:
            planes = EpipolarPlanes.of(camera, inputs.light, border_pixels(camera, 1)).uniforms
        self._uniforms = planes | {"columns": columns}
        self.buffer = _trees(inputs, planes["plane_count"], columns, self._uniforms) if inputs.given is None else None

    def bind(self, program: Any) -> None:
        """Bind the trees and set the planes' uniforms."""
        set_uniforms(program, self._uniforms)
        if self.buffer:
            self.buffer.bind_to_storage_buffer(TREES)

    def give_back(self, device: Device) -> None:
        """Give the trees back."""
        if self.buffer:
            device.give_back(self.buffer)


def _trees(inputs: FogInputs, rows: int, columns: int, uniforms: dict[str, Any]) -> Any:
    """Resample the shadow map and build the trees; the caller gives the buffer back."""
    device = inputs.device
    size, most = NODE_BYTES * 2 * columns * rows, device.context.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"]
    if size > most:
        raise InputError(
            f"{rows} rows of {columns} thresholds take {size / 1e6:.3g} MB, and a buffer of this OpenGL holds "
            f"{most / 1e6:.3g} MB: make the image or the shadow map smaller, or downsample more."
        )
    with inputs.clock.time_pass("shadow map"):
        buffer = device.buffer(size)
        buffer.bind_to_storage_buffer(TREES)
        defines = light_defines(inputs.scene, inputs.light) | inputs.shadow_map.defines
        program = device.compute("visibility/min_max.comp.glsl", defines | {"SHADOW_GIVEN": 0})
        set_uniforms(program, camera_uniforms(inputs.scene.camera) | uniforms)
        set_uniforms(program, light_uniforms(inputs.scene, inputs.light, inputs.pictures))
        set_uniforms(program, inputs.shadow_map.bind(unit=0))
        program.run(rows)
        device.context.memory_barrier()
    return buffer
