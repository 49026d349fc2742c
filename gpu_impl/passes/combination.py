"""The combination pass: "Bilateral filter" of Weng 2010, Figure 1.3. A new upsampling is a file and a line here."""

from __future__ import annotations

from typing import Any

from gpu_impl.camera_uniforms import camera_uniforms
from gpu_impl.device import Device
from gpu_impl.light_uniforms import fog_defines, fog_uniforms
from gpu_impl.passes.geometry import GBuffer
from gpu_impl.shader_source import set_uniforms
from gpu_impl.techniques import UPSAMPLINGS, Technique
from scenes.model import Scene


def combine(
    device: Device,
    targets: tuple[Any, ...],
    technique: Technique,
    scene: Scene,
    gbuffer: GBuffer,
    surface: Any,
    airlight: Any,
) -> None:
    """Bring `airlight` to full resolution and put it together with the light that `surface` holds.

    Parameters
    ----------
    targets : one texture for the composite, or two for the surface's light as it reaches the eye and the airlight
    surface : RGBA32F    light as it leaves the surfaces
    airlight : RGBA32F   airlight and pieces, evaluated on every `technique.downsample`-th pixel
    """
    program = device.program(
        "combination.frag.glsl",
        defines=fog_defines(scene) | {"SPLIT": int(len(targets) == 2), "DOWNSAMPLED": int(technique.downsample > 1)},
        includes={"<upsampling>": UPSAMPLINGS[technique.upsample]},
    )
    airlight.use(0)
    surface.use(1)
    set_uniforms(program, camera_uniforms(scene.camera) | fog_uniforms(scene) | gbuffer.bind(first_unit=2))
    set_uniforms(program, {"scattering": 0, "surface": 1, "downsample": technique.downsample})
    device.fill(program, *targets)
