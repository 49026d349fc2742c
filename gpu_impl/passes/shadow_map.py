"""The shadow-map pass: distance from a light to the nearest surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from gpu_impl.device import DEPTH_CLAMP, Device
from gpu_impl.geometry import Geometry
from gpu_impl.matrices import orthographic_matrix, projection_matrix, view_matrix
from scenes.errors import InputError
from scenes.model import Light

# beyond this half-angle one flat map wastes its texels at the rim, and a cube serves
WIDEST_FLAT_MAP = np.radians(60)
# no depth buffer is used and DEPTH_CLAMP keeps what lies outside, so that only their ratio has to be harmless
NEAR, FAR = 1.0, 2.0
# binding of a map that stands in a buffer; those from 3 on are others'
SHADOW_BUFFER = 2
# Axes of the maps, in columns: any turn that is no symmetry of a cube. Scenes are built along the world's
# axes, and an edge along a row of texels would be off by the same part of a texel in all of it, to one side: with
# 2,688 texels the mean airlight of `light_behind_eye` was off by 4.2e-4 with maps along the axes, and is by 1.8e-5 so
# (exact+quadrature, 128 x 128).
MAP_FRAME = Rotation.from_rotvec([0.3, 0.5, 0.7]).as_matrix()
# (forward, up) of a cube's faces +x -x +y -y +z -z in that frame, in the order of tile_position() in shadow_lookup.glsl
CUBE_FACES = tuple(
    (MAP_FRAME @ forward, MAP_FRAME @ up)
    for forward, up in (
        ((1, 0, 0), (0, 1, 0)),
        ((-1, 0, 0), (0, 1, 0)),
        ((0, 1, 0), (0, 0, 1)),
        ((0, -1, 0), (0, 0, 1)),
        ((0, 0, 1), (0, 1, 0)),
        ((0, 0, -1), (0, 1, 0)),
    )
)


def tile_count(light: Light) -> int:
    """How many tiles the light's map has: 1 for a narrow spot or parallel light, 6 for the faces of a cube."""
    return 1 if light.kind == "directional" or light.cutoff_angle <= WIDEST_FLAT_MAP else len(CUBE_FACES)


@dataclass(frozen=True)
class ShadowMap:
    """One light's shadow map.

    Attributes
    ----------
    texture : moderngl.Texture     R32F, (tiles * size, size): distance to the light [scene unit]; None in a buffer
    matrices : (tiles, 4, 4)       world to clip space of each tile
    size : int                     texels on a side of a tile
    texel_slope : float            width of a texel at distance 1, or anywhere in parallel light
    buffer : moderngl.Buffer       the texture's rows one after another, where it does not hold them itself
    """

    texture: Any
    matrices: np.ndarray
    size: int
    texel_slope: float
    buffer: Any = None

    @property
    def defines(self) -> dict[str, int]:
        """Defines of shadow_lookup.glsl."""
        return {"TILES": len(self.matrices)} | ({"SHADOW_BUFFER": SHADOW_BUFFER} if self.buffer else {})

    @property
    def memory(self) -> Any:
        """The texture or the buffer, whichever holds the map."""
        return self.buffer or self.texture

    def bind(self, unit: int) -> dict[str, Any]:
        """Bind the texture or the buffer and give the uniforms of shadow_lookup.glsl."""
        if self.buffer:
            self.buffer.bind_to_storage_buffer(SHADOW_BUFFER)
        else:
            self.texture.use(unit)
        return {
            "shadow_map": unit,
            "tile_matrix": self.matrices[0],
            "tile_size": self.size,
            "texel_slope": self.texel_slope,
            "map_frame": MAP_FRAME,
        }


def check_map_size(device: Device, light: Light, size: int) -> None:
    """Raise InputError where the light's map would be larger than a texture may be."""
    tiles, widest = tile_count(light), device.largest_texture
    if tiles * size > widest:
        raise InputError(f"A shadow map of {tiles} x {size} texels is wider than this OpenGL allows ({widest}).")


def render_shadow_map(device: Device, geometry: Geometry, light: Light, size: int) -> ShadowMap:
    """Draw the scene from the light; the caller releases the texture."""
    context, tiles = device.context, tile_count(light)
    matrices, texel_slope = _tiles(light, size, geometry.bounds)
    program = device.program("shadow_map.frag.glsl", vertex="shadow_map.vert.glsl")
    texture = device.texture((tiles * size, size), 1)
    target = context.framebuffer(color_attachments=[texture])
    target.use()
    target.clear(red=3e38)
    context.disable(context.DEPTH_TEST)
    parallel_to = tuple(light.direction) if light.kind == "directional" else (0.0, 0.0, 0.0)
    source = {"light_position": tuple(light.position), "parallel_to": parallel_to}
    # an occluder may be as near to the light as it likes
    context.enable_direct(DEPTH_CLAMP)
    context.enable(context.BLEND)
    context.blend_equation = context.MIN
    eye = None if light.kind == "directional" else light.position
    for tile, matrix in enumerate(matrices):
        target.viewport = (tile * size, 0, size, size)
        for mesh in geometry.meshes:
            mesh.draw(program, {"world_to_clip": matrix, **source}, eye)
    context.disable_direct(DEPTH_CLAMP)
    context.blend_equation = context.FUNC_ADD
    context.disable(context.BLEND)
    target.release()
    return ShadowMap(texture, matrices, size, texel_slope)


def _tiles(light: Light, size: int, bounds: np.ndarray) -> tuple[np.ndarray, float]:
    """World to clip space of each tile, (tiles, 4, 4), and the width of a texel; see `ShadowMap`."""
    if tile_count(light) > 1:
        views = [view_matrix(light.position, forward, up) for forward, up in CUBE_FACES]
        projections, tan_half = [projection_matrix(1.0, 1.0, NEAR, FAR)] * len(views), 1.0
    elif light.kind == "directional":
        view = view_matrix(light.position, light.direction, _any_up(light.direction))
        seen = bounds @ view[:3, :3].T + view[:3, 3]
        low, high = seen.min(axis=0)[:2], seen.max(axis=0)[:2]
        # a hair wider than what casts shadows; nothing beyond it does
        half = np.maximum(1.01 * (high - low) / 2, 1e-6)
        views, tan_half = [view], float(half.max())
        projections = [orthographic_matrix((low + high) / 2, half)]
    else:
        # a hair wider than the cone, so that its edge falls inside the map
        tan_half = float(np.tan(light.cutoff_angle)) * 1.01
        views = [view_matrix(light.position, light.direction, _any_up(light.direction))]
        projections = [projection_matrix(tan_half, tan_half, NEAR, FAR)]
    tiles = [projection @ view for projection, view in zip(projections, views, strict=True)]
    return np.stack(tiles).astype(np.float32), 2 * tan_half / size


def _any_up(forward: np.ndarray) -> np.ndarray:
    """Return the axis of the maps' frame that is furthest from parallel to `forward`."""
    return MAP_FRAME[:, np.argmin(np.abs(forward @ MAP_FRAME))]
