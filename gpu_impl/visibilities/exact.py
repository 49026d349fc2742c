"""A pyramid of the shadow map's least and largest distances, by which a ray skips what cannot change it.

shaders/visibility/exact.glsl walks it: wherever a square of texels lets all of the ray's part through, or none of it,
none of them is read.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from gpu_impl.device import Device
from gpu_impl.passes.shadow_map import ShadowMap
from gpu_impl.shader_source import set_uniforms
from gpu_impl.visibilities.strategy import FogInputs, Supply

# texture unit in the scattering pass, and while the pyramid is built
UNIT, MAP_UNIT = 9, 0
# of a work group, as in shadow_pyramid.comp.glsl
GROUP = 8


class ShadowPyramid(Supply):
    """Levels 1 and up of one light's map; the map itself is level 0.

    A level has half as many nodes on a side of a tile as the one below, rounded down, like OpenGL's mip levels, and
    lies in one: its tiles stand side by side from the left. Together they take two thirds as many bytes as the map.

    Attributes
    ----------
    texture : moderngl.Texture    RG32F, mip level i is level i + 1: least and largest distance [scene unit]; None over
                                  a map of one texel
    """

    # surface_shadow.glsl is asked about planes alone
    defines: Mapping[str, object] = MappingProxyType({"SOFT_SHADOWS": 0})

    def __init__(self, inputs: FogInputs) -> None:
        shadow_map, device = inputs.shadow_map, inputs.device
        tiles, size = len(shadow_map.matrices), shadow_map.size
        self.texture = None
        if size > 1:
            # moderngl allocates levels by having OpenGL compute its own, so the texture is kept from frame to frame
            self.texture = inputs.kept.get(("pyramid", tiles, size), lambda: _levels(device, tiles, size))
            with inputs.clock.time_pass("shadow map"):
                _fill(device, shadow_map, self.texture)

    def bind(self, program: Any) -> None:
        """Bind the texture."""
        if self.texture:
            self.texture.use(UNIT)
            set_uniforms(program, {"shadow_pyramid": UNIT})


def _levels(device: Device, tiles: int, size: int) -> Any:
    """A texture with as many levels as a tile can be halved, and with anything in them."""
    context = device.context
    texture = context.texture((tiles * (size // 2), size // 2), 2, dtype="f4")
    texture.build_mipmaps(0, size.bit_length() - 2)
    texture.filter = (context.NEAREST_MIPMAP_NEAREST, context.NEAREST)
    return texture


def _fill(device: Device, shadow_map: ShadowMap, texture: Any) -> None:
    """Compute each level from the one below."""
    tiles, size = len(shadow_map.matrices), shadow_map.size
    program = device.compute("shadow_pyramid.comp.glsl", shadow_map.defines | {"DIRECTIONAL": 0, "SHADOW_GIVEN": 0})
    texture.use(UNIT)
    set_uniforms(program, shadow_map.bind(MAP_UNIT) | {"shadow_pyramid": UNIT})
    for level in range(1, size.bit_length()):
        texture.bind_to_image(0, read=False, write=True, level=level - 1)
        set_uniforms(program, {"level": level})
        program.run(-(-tiles * (size >> level) // GROUP), -(-(size >> level) // GROUP))
        # what the next level reads, and the fog after the last
        device.context.memory_barrier()
