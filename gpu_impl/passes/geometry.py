"""The geometry pass: what the eye sees first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gpu_impl.camera_uniforms import camera_uniforms, world_to_clip
from gpu_impl.device import Device
from gpu_impl.geometry import Geometry
from gpu_impl.textures import PictureTextures
from scenes.model import Camera


@dataclass(frozen=True)
class GBuffer:
    """What the eye sees first, at full resolution.

    Attributes
    ----------
    normal_and_distance : texture RGBA32F   unit normal (0 for none), distance along the pixel's ray [scene unit],
                                        0 where there is no surface
    diffuse : texture RGBA32F               diffuse reflectance, 1 if two-sided
    specular : texture RGBA32F              specular reflectance, exponent
    triangle_normal : texture RGBA32F       normal of the triangle itself, of any length
    """

    normal_and_distance: Any
    diffuse: Any
    specular: Any
    triangle_normal: Any

    def bind(self, first_unit: int) -> dict[str, int]:
        """Bind the textures and give their uniforms."""
        units = {
            "normal_and_distance": first_unit,
            "surface_diffuse": first_unit + 1,
            "surface_specular": first_unit + 2,
            "triangle_normal": first_unit + 3,
        }
        for unit, texture in zip(units.values(), self.textures, strict=True):
            texture.use(unit)
        return units

    @property
    def textures(self) -> tuple[Any, Any, Any, Any]:
        """All of them, in the order of the pass's outputs."""
        return self.normal_and_distance, self.diffuse, self.specular, self.triangle_normal


def render_gbuffer(device: Device, geometry: Geometry, camera: Camera, pictures: PictureTextures) -> GBuffer:
    """Rasterise the scene from the eye; the caller releases the textures."""
    context, size = device.context, (camera.width, camera.height)
    buffers = GBuffer(*(device.texture(size, 4) for _ in range(4)))
    depth = context.depth_renderbuffer(size)
    target = context.framebuffer(buffers.textures, depth)
    target.use()
    target.clear()
    context.enable(context.DEPTH_TEST)
    program = device.program("geometry.frag.glsl", vertex="geometry.vert.glsl")
    uniforms = camera_uniforms(camera) | {"world_to_clip": world_to_clip(camera)}
    for mesh in geometry.meshes:
        mesh.draw(program, uniforms | mesh.material_uniforms(pictures))
    context.disable(context.DEPTH_TEST)
    target.release()
    depth.release()
    return buffers
