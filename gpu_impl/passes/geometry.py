"""The geometry pass: what the eye sees first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gpu_impl.camera_uniforms import camera_uniforms, world_to_clip
from gpu_impl.device import Device
from gpu_impl.geometry import Geometry
from gpu_impl.textures import PictureTextures
from scenes.model import Camera


@dataclass(frozen=True)
class GBuffer:
    """What the eye sees first, at full resolution; read by gbuffer.glsl.

    Attributes
    ----------
    normal_and_distance : texture RGBA32F   unit normal (0 for none), distance along the pixel's ray [scene unit],
                                            0 where there is no surface
    material : texture RGBA32UI             bits of the diffuse reflectance, the red one's sign bit set if two-sided;
                                            normal of the triangle itself, packed in 32 bits
    specular : texture RGBA32F or None      specular reflectance, exponent; None where no material is specular
    """

    normal_and_distance: Any
    material: Any
    specular: Any | None

    def bind(self, first_unit: int) -> dict[str, int]:
        """Bind the textures and give their uniforms."""
        names = ("normal_and_distance", "surface_material", "surface_specular")
        units = {name: first_unit + i for i, name in enumerate(names[: len(self.textures)])}
        for unit, texture in zip(units.values(), self.textures, strict=True):
            texture.use(unit)
        return units

    @property
    def defines(self) -> dict[str, int]:
        """Defines of gbuffer.glsl."""
        return {"SPECULAR": int(self.specular is not None)}

    @property
    def textures(self) -> tuple[Any, ...]:
        """All of them, in the order of the pass's outputs."""
        return (self.normal_and_distance, self.material, *([] if self.specular is None else [self.specular]))


def render_gbuffer(device: Device, geometry: Geometry, camera: Camera, pictures: PictureTextures) -> GBuffer:
    """Rasterise the scene from the eye; the caller gives the textures back."""
    context, size = device.context, (camera.width, camera.height)
    buffers = GBuffer(
        device.texture(size, 4),
        device.texture(size, 4, "u4"),
        device.texture(size, 4) if geometry.is_specular else None,
    )
    depth = context.depth_renderbuffer(size)
    # where there is no surface nobody reads the others
    first = context.framebuffer(buffers.normal_and_distance, depth)
    first.clear()
    first.release()
    target = context.framebuffer(buffers.textures, depth)
    target.use()
    context.enable(context.DEPTH_TEST)
    # image row 0 is at the first row of the target: what OpenGL sees is mirrored
    context.front_face = "cw"
    corner = camera.near * float(np.sqrt(1 + camera.tan_half_x**2 + camera.tan_half_y**2))
    uniforms = camera_uniforms(camera) | {"world_to_clip": world_to_clip(camera)}
    for mesh in geometry.meshes:
        program = device.program(
            "geometry.frag.glsl",
            vertex="geometry.vert.glsl",
            defines=buffers.defines | {"PICTURE": int(mesh.has_picture)},
        )
        mesh.draw(program, uniforms | mesh.material_uniforms(pictures), camera.origin, reach=corner)
    context.front_face = "ccw"
    context.disable(context.DEPTH_TEST)
    target.release()
    depth.release()
    return buffers
