"""The surface pass: "Render Scene" of Weng 2010, Figure 1.3."""

from __future__ import annotations

from typing import Any

from gpu_impl.camera_uniforms import camera_uniforms
from gpu_impl.device import Device
from gpu_impl.light_uniforms import light_defines, light_uniforms
from gpu_impl.passes.geometry import GBuffer
from gpu_impl.passes.shadow_map import ShadowMap
from gpu_impl.shader_source import set_uniforms
from gpu_impl.techniques import Technique
from gpu_impl.textures import PictureTextures
from scenes.model import Light, Scene


def add_surface(
    device: Device,
    target: Any,
    technique: Technique,
    scene: Scene,
    light: Light,
    gbuffer: GBuffer,
    shadow_map: ShadowMap,
    pictures: PictureTextures,
    *,
    first: bool,
) -> None:
    """Write the direct light of the first light on diffuse and Phong surfaces to `target`, or add another's.

    Parameters
    ----------
    target : RGBA32F    light as it leaves the surfaces
    """
    program = device.program(
        "surface.frag.glsl",
        defines={
            **light_defines(scene, light),
            **gbuffer.defines,
            **shadow_map.defines,
            "LIGHT_LEG": int(technique.composition == "physical"),
            "SOFT_SHADOWS": int(technique.surface_shadows == "soft"),
        },
    )
    set_uniforms(program, camera_uniforms(scene.camera) | light_uniforms(scene, light, pictures))
    set_uniforms(program, shadow_map.bind(unit=0) | gbuffer.bind(first_unit=1))
    device.fill(program, target, add=not first)
