"""The scattering pass: "Render Scattering Effect" of Weng 2010, Figure 1.3, with any visibility and airlight model."""

from __future__ import annotations

from typing import Any

import numpy as np

from gpu_impl.device import Device
from gpu_impl.geometry import GBuffer, camera_uniforms
from gpu_impl.light_uniforms import light_uniforms
from gpu_impl.shader_source import set_uniforms
from gpu_impl.shadow_map import ShadowMap, tile_count
from gpu_impl.techniques import AIRLIGHT_MODELS, VISIBILITIES, Technique
from scenes.model import Light, Scene


def add_scattering(
    device: Device,
    target: Any,
    technique: Technique,
    scene: Scene,
    light: Light,
    gbuffer: GBuffer,
    shadow_map: ShadowMap,
) -> None:
    """Add one light's airlight to `target`, whose pixels stand for every N-th of the image's."""
    grey = np.ptp(np.broadcast_to(scene.medium.sigma_t, 3)) == 0
    model = AIRLIGHT_MODELS[technique.airlight]
    program = device.program(
        "scattering.frag.glsl",
        defines={"GREY": int(grey), "TILES": tile_count(light), "STEPS": technique.steps},
        includes={
            "<airlight>": model.source,
            "<visibility>": VISIBILITIES[technique.visibility].source,
            "<phase>": f"phase/{scene.phase.name}.glsl",
        },
        generated=model.generated,
    )
    set_uniforms(program, camera_uniforms(scene.camera) | light_uniforms(scene, light))
    set_uniforms(program, shadow_map.bind(unit=0) | gbuffer.bind(first_unit=1))
    # the parameters of a phase function are uniforms of the same names
    set_uniforms(program, vars(scene.phase) | {"downsample": technique.downsample})
    device.fill(program, target, add=True)
