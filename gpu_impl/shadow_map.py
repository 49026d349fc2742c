"""The shadow-map pass: distance from a light to the nearest surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gpu_impl.device import Device
from gpu_impl.geometry import Geometry
from gpu_impl.matrices import projection_matrix, view_matrix
from scenes.errors import InputError
from scenes.model import Light

# beyond this half-angle one flat map wastes its texels at the rim, and a cube serves
WIDEST_FLAT_MAP = np.radians(60)
# no depth buffer is used and DEPTH_CLAMP keeps what lies outside, so that only their ratio has to be harmless
NEAR, FAR = 1.0, 2.0
DEPTH_CLAMP = 0x864F
# (forward, up) of a cube's faces +x -x +y -y +z -z, in the order of tile_position() in shadow_lookup.glsl
CUBE_FACES = (
    ((1, 0, 0), (0, 1, 0)),
    ((-1, 0, 0), (0, 1, 0)),
    ((0, 1, 0), (0, 0, 1)),
    ((0, -1, 0), (0, 0, 1)),
    ((0, 0, 1), (0, 1, 0)),
    ((0, 0, -1), (0, 1, 0)),
)


def tile_count(light: Light) -> int:
    """How many tiles the light's map has: 1 for a narrow spot, 6 for the faces of a cube."""
    return 1 if light.cutoff_angle <= WIDEST_FLAT_MAP else len(CUBE_FACES)


@dataclass(frozen=True)
class ShadowMap:
    """One light's shadow map.

    Attributes
    ----------
    texture : moderngl.Texture     R32F, (tiles * size, size): distance to the light [scene unit]
    matrices : (tiles, 4, 4)       world to clip space of each tile
    size : int                     texels on a side of a tile
    texel_slope : float            width of a texel at distance 1
    """

    texture: Any
    matrices: np.ndarray
    size: int
    texel_slope: float

    def bind(self, unit: int) -> dict[str, Any]:
        """Bind the texture and give the uniforms of shadow_lookup.glsl."""
        self.texture.use(unit)
        return {
            "shadow_map": unit,
            "tile_matrix": self.matrices[0],
            "tile_size": self.size,
            "texel_slope": self.texel_slope,
        }


def check_map_size(device: Device, light: Light, size: int) -> None:
    """Raise InputError where the light's map would be larger than a texture may be."""
    tiles, widest = tile_count(light), device.largest_texture
    if tiles * size > widest:
        raise InputError(f"A shadow map of {tiles} x {size} texels is wider than this OpenGL allows ({widest}).")


def render_shadow_map(device: Device, geometry: Geometry, light: Light, size: int) -> ShadowMap:
    """Draw the scene from the light; the caller releases the texture."""
    context, tiles = device.context, tile_count(light)
    # a hair wider than the cone, so that its edge falls inside the map
    tan_half = 1.0 if tiles > 1 else np.tan(light.cutoff_angle) * 1.01
    if tiles == 1:
        views = [view_matrix(light.position, light.direction, _any_up(light.direction))]
    else:
        views = [view_matrix(light.position, np.array(f, float), np.array(up, float)) for f, up in CUBE_FACES]
    projection = projection_matrix(tan_half, tan_half, NEAR, FAR)
    matrices = np.stack([projection @ view for view in views]).astype(np.float32)
    program = device.program("shadow_map.frag.glsl", vertex="shadow_map.vert.glsl")
    texture = device.texture((tiles * size, size), 1)
    target = context.framebuffer(color_attachments=[texture])
    target.use()
    target.clear(red=3e38)
    context.disable(context.DEPTH_TEST)
    # an occluder may be as near to the light as it likes
    context.enable_direct(DEPTH_CLAMP)
    context.enable(context.BLEND)
    context.blend_equation = context.MIN
    for tile, matrix in enumerate(matrices):
        target.viewport = (tile * size, 0, size, size)
        for mesh in geometry.meshes:
            mesh.draw(program, {"world_to_clip": matrix, "light_position": tuple(light.position)})
    context.disable_direct(DEPTH_CLAMP)
    context.blend_equation = context.FUNC_ADD
    context.disable(context.BLEND)
    target.release()
    return ShadowMap(texture, matrices, size, 2 * float(tan_half) / size)


def _any_up(forward: np.ndarray) -> np.ndarray:
    """Return the axis that is furthest from parallel to `forward`."""
    return np.eye(3)[np.argmin(np.abs(forward))]
