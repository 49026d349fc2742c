"""The first and the last shadow polygon of each ray, for strategies that ask for them (shadow_region.glsl)."""

from __future__ import annotations

from typing import Any

from gpu_impl.device import Device
from gpu_impl.lattices.grid import Grid
from gpu_impl.passes.shadow_volume import render_shadow_polygons
from gpu_impl.shader_source import set_uniforms
from gpu_impl.silhouettes import Adjacency
from gpu_impl.visibilities.strategy import FogInputs, Supply

# texture unit in the scattering pass, which binds shadow map, G-buffer and a spot's picture below
UNIT = 9


class ShadowPolygons(Supply):
    """A texture of a light's polygons.

    Attributes
    ----------
    texture : as `render_shadow_polygons` draws it
    """

    def __init__(self, texture: Any) -> None:
        self.texture = texture

    def bind(self, program: Any) -> None:
        """Bind the texture."""
        self.texture.use(UNIT)
        set_uniforms(program, {"shadow_polygons": UNIT})

    def give_back(self, device: Device) -> None:
        """Give the texture back."""
        device.give_back(self.texture)


def repaired(inputs: FogInputs) -> ShadowPolygons:
    """Those that can matter."""
    return _drawn(inputs, repaired=True)


def printed(inputs: FogInputs) -> ShadowPolygons:
    """All of them."""
    return _drawn(inputs, repaired=False)


def _drawn(inputs: FogInputs, repaired: bool) -> ShadowPolygons:
    device, scene = inputs.device, inputs.scene
    # a light's silhouettes are found anew in each frame; which triangles meet at which edge is the meshes' own
    adjacency = inputs.kept.get("adjacency", lambda: Adjacency(device.context, scene))
    with inputs.clock.time_pass("shadow polygons"):
        texture = render_shadow_polygons(
            device,
            adjacency,
            scene,
            inputs.light,
            inputs.gbuffer,
            inputs.shadow_map,
            inputs.pictures,
            grid=Grid.of(scene.camera, inputs.technique.downsample),
            repaired=repaired,
        )
    return ShadowPolygons(texture)
