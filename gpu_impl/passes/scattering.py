"""The scattering pass: "Render Scattering Effect" of Weng 2010, Figure 1.3, with any visibility and airlight model."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

import numpy as np

from analytic.phase import Phase
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.blue_noise import blue_noise_uniforms
from gpu_impl.camera_uniforms import camera_uniforms
from gpu_impl.device import Device
from gpu_impl.lattice import Lattice
from gpu_impl.light_uniforms import light_defines, light_uniforms
from gpu_impl.passes.geometry import GBuffer
from gpu_impl.passes.shadow_map import ShadowMap
from gpu_impl.passes.shadow_volume import bind_polygons
from gpu_impl.shader_source import set_uniforms
from gpu_impl.techniques import Technique
from gpu_impl.textures import PictureTextures
from gpu_impl.visibilities import VISIBILITIES
from scenes.model import Light, Scene

# what a counting build counts, in the order of the channels of shaders/counting.glsl
COUNTERS = ("pieces", "shadow_map_reads", "exponential_integrals", "exponentials")
# binding of `phase_table` in phase/tabulated.glsl
PHASE_TABLE = 3


def add_scattering(
    device: Device,
    target: Any,
    technique: Technique,
    scene: Scene,
    light: Light,
    gbuffer: GBuffer,
    shadow_map: ShadowMap,
    pictures: PictureTextures,
    *,
    polygons: Any = None,
    layer: int = 0,
    counts: Any = None,
    first: bool,
) -> None:
    """Write the first light's airlight to `target`, every N-th pixel of the image, or add another's.

    Parameters
    ----------
    polygons : what `render_shadow_polygons` drew, where the visibility asks for it; this light's are in `layer`
    counts : RGBA32F    of the target's size, a channel for each of `COUNTERS`; None where nothing is counted
    """
    model, strategy = AIRLIGHT_MODELS[technique.airlight], VISIBILITIES[technique.visibility]
    program = device.program(
        "scattering.frag.glsl",
        defines=light_defines(scene, light)
        | shadow_map.defines
        | {"STEPS": technique.steps}
        | ({"COUNTING": 1} if counts else {}),
        includes={
            "<airlight>": model.source,
            "<visibility>": strategy.source,
            "<phase>": f"phase/{scene.phase.name}.glsl",
        },
        generated=model.generated(scene.phase),
    )
    set_uniforms(program, camera_uniforms(scene.camera) | light_uniforms(scene, light, pictures))
    set_uniforms(program, shadow_map.bind(unit=0) | gbuffer.bind(first_unit=1))
    set_uniforms(program, Lattice.of(scene.camera, technique.downsample).uniforms)
    if polygons:
        set_uniforms(program, bind_polygons(polygons, layer))
    noise = blue_noise_uniforms(device, program) if strategy.blue_noise else nullcontext()
    with phase_uniforms(device, program, scene.phase), noise:
        device.fill(program, *filter(None, (target, counts)), add=not first)


@contextmanager
def phase_uniforms(device: Device, program: Any, phase: Phase) -> Iterator[None]:
    """Hand a phase function's parameters over: numbers as uniforms of the same names, a table as a storage buffer."""
    table = getattr(phase, "values", None)
    if table is None:
        set_uniforms(program, vars(phase))
        yield
        return
    buffer = device.context.buffer(np.asarray(table, np.float32))
    buffer.bind_to_storage_buffer(PHASE_TABLE)
    try:
        yield
    finally:
        buffer.release()
