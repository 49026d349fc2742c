"""The shadow-volume pass: on each ray of the grid the first and the last shadow polygon of a light.

"User just creates the frontmost shadow polygon and the final shadow polygon from the eye view" (Weng 2010, section 1.2;
"front distance" and "final distance" of Figure 4.7). Edges of the light's silhouette are gathered on the GPU and drawn
as polygons that go on behind them; blending keeps the smallest and the largest distance of each ray.
"""

from __future__ import annotations

import struct
from typing import Any

from gpu_impl.camera_uniforms import camera_uniforms, world_to_clip
from gpu_impl.device import Device
from gpu_impl.lattices.grid import GRID, Grid
from gpu_impl.light_uniforms import light_defines, light_uniforms
from gpu_impl.passes.geometry import GBuffer
from gpu_impl.passes.shadow_map import ShadowMap
from gpu_impl.shader_source import set_uniforms
from gpu_impl.silhouettes import Adjacency
from gpu_impl.textures import PictureTextures
from scenes.errors import InputError
from scenes.model import Array, Camera, Light, Scene

# what a ray without a shadow polygon holds
NO_CROSSING = 3e38
# invocations of a work group of silhouette.comp.glsl
GROUP = 128
# work groups along one axis that every OpenGL takes; more are silently none
MOST_GROUPS = 65535
# storage blocks that polygon.vert.glsl declares; OpenGL 4.3 promises a vertex shader none
VERTEX_BLOCKS = 3


def check_polygons(device: Device) -> None:
    """Raise InputError where this OpenGL cannot draw shadow polygons."""
    blocks = device.context.info["GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS"]
    if blocks < VERTEX_BLOCKS:
        raise InputError(
            f"Shadow polygons need {VERTEX_BLOCKS} storage blocks in a vertex shader, and this OpenGL has {blocks} "
            "(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS): use a cell without them, such as lit_intervals:unbounded+one_ei."
        )


def render_shadow_polygons(
    device: Device,
    adjacency: Adjacency,
    scene: Scene,
    light: Light,
    gbuffer: GBuffer,
    shadow_map: ShadowMap,
    pictures: PictureTextures,
    *,
    grid: Grid,
    repaired: bool,
) -> Any:
    """Draw the shadow polygons of one light; the caller gives the texture back.

    Parameters
    ----------
    repaired : leave out crossings that cannot matter: behind the surface that the pixel sees, outside the light's cone
        or the fog, and those of edges that something hides from the light. As printed, every polygon counts.

    Returns
    -------
    texture RG32F
        Of the grid's size: t of the first crossing and -t of the last, along the ray as the contract has it [scene
        unit]; NO_CROSSING in both where there is none.
    """
    context, camera = device.context, scene.camera
    crossings, limits = device.texture(grid.size, 2), device.texture(grid.size, 4)
    pixels = camera_uniforms(camera) | grid.uniforms
    drawn = pixels | {"limits": 0, "world_to_lattice": world_to_grid(camera, grid)}
    adjacency.bind()
    defines = light_defines(scene, light) | shadow_map.defines | {"CULL": int(repaired)}
    uniforms = light_uniforms(scene, light, pictures) | shadow_map.bind(unit=0)
    # no corners of one instance; `reach` grows to what is seen, or is without end from the beginning
    adjacency.draw_call.write(struct.pack("4If", 0, 1, 0, 0, 0.0 if repaired else NO_CROSSING))
    narrow = device.program("shadow_volume/limits.frag.glsl", defines=defines, includes={"<lattice>": GRID.source})
    set_uniforms(narrow, pixels | uniforms | gbuffer.bind(first_unit=1))
    device.fill(narrow, limits)
    context.memory_barrier()
    gather = device.compute("shadow_volume/silhouette.comp.glsl", defines)
    set_uniforms(gather, uniforms | {"edge_count": adjacency.edge_count})
    groups = -(-adjacency.edge_count // GROUP)
    gather.run(min(groups, MOST_GROUPS), -(-groups // MOST_GROUPS))
    context.memory_barrier()
    program = device.program("shadow_volume/polygon.frag.glsl", "shadow_volume/polygon.vert.glsl", defines)
    set_uniforms(program, drawn | uniforms)
    array = context.vertex_array(program, [])
    target = context.framebuffer(color_attachments=[crossings])
    target.clear(NO_CROSSING, NO_CROSSING)
    limits.use(0)
    target.use()
    context.enable(context.BLEND)
    context.blend_equation = context.MIN
    array.render_indirect(adjacency.draw_call, context.TRIANGLES, count=1)
    context.blend_equation = context.FUNC_ADD
    context.disable(context.BLEND)
    array.release()
    target.release()
    device.give_back(limits)
    return crossings


def world_to_grid(camera: Camera, grid: Grid) -> Array:
    """World to the clip space of the grid, (4, 4), whose pixels are centred where those of the image are.

    Depth is made so that OpenGL clips at half the near plane and nowhere else; points without end (w = 0) keep theirs.
    """
    clip = world_to_clip(camera)
    matrix = clip.copy()
    for row, pixels in enumerate((camera.width, camera.height)):
        # in pixels of the image from its corner: x = N (p + 1/2) + shift at the centre of the grid's pixel p
        shift = (1 - grid.step) / 2 + grid.first[row]
        covered = grid.size[row] * grid.step
        matrix[row] = (pixels * clip[row] + (pixels - covered - 2 * shift) * clip[3]) / covered
    matrix[2] = clip[3] - [0, 0, 0, camera.near]
    return matrix
