"""The scattering pass: "Render Scattering Effect" of Weng 2010, Figure 1.3, with any visibility and airlight model."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from analytic.phase import Phase
from gpu_impl.airlight_models import AIRLIGHT_MODELS
from gpu_impl.camera_uniforms import camera_uniforms
from gpu_impl.device import Device
from gpu_impl.light_uniforms import light_defines, light_uniforms
from gpu_impl.shader_source import set_uniforms
from gpu_impl.visibilities import VISIBILITIES
from gpu_impl.visibilities.strategy import FogInputs, Supply

# what a counting build counts, in the order of the channels of shaders/counting.glsl
COUNTERS = ("pieces", "shadow_map_reads", "exponential_integrals", "exponentials")
# of these, what airlight models do
OF_MODELS = COUNTERS[2:]
# binding of `phase_table` in phase/tabulated.glsl
PHASE_TABLE = 3
# of the loop by which scattering.frag.glsl notices that its loops are cut off
TURNS = 2
# texture unit of the airlight model's table, behind those that strategies take
TABLE_UNIT = 14


def add_scattering(
    target: Any, inputs: FogInputs, supply: Supply, *, counts: Any = None, recording: Any = None, first: bool
) -> None:
    """Write the first light's airlight to `target`, or add another's.

    Parameters
    ----------
    target : RGBA32F            of the lattice's size
    supply : Supply             what the technique's visibility made for this light
    counts : RGBA32F            of the same size, a channel for each of `COUNTERS`; None where nothing is counted
    recording : Recording       keeps the pieces; None where nobody asks
    """
    device, technique, scene, light = inputs.device, inputs.technique, inputs.scene, inputs.light
    model, strategy = AIRLIGHT_MODELS[technique.airlight], VISIBILITIES[technique.visibility]
    defines: dict[str, object] = {
        **light_defines(scene, light),
        **inputs.shadow_map.defines,
        "STEPS": technique.steps,
        "SHADOW_GIVEN": int(inputs.given is not None),
        "AIRLIGHT_AT_CORNERS": int(strategy.airlight_at_corners),
        "IN_STEPS": int(strategy.in_steps),
        "DEPTH_ONLY": int(model.depth_only),
        **strategy.defines,
        **supply.defines,
        **({"COUNTING": 1} if counts else {}),
        **({"RECORDING": 1} if recording else {}),
    }
    program = device.program(
        "scattering.frag.glsl",
        strategy.vertex,
        defines=defines,
        includes={
            "<airlight>": model.source,
            "<visibility>": strategy.source,
            "<lattice>": inputs.lattice.kind.source,
            "<phase>": f"phase/{scene.phase.name}.glsl",
        },
        generated=model.generated(scene.phase),
    )
    set_uniforms(program, camera_uniforms(scene.camera) | light_uniforms(scene, light, inputs.pictures))
    set_uniforms(program, inputs.shadow_map.bind(unit=0) | inputs.gbuffer.bind(first_unit=1))
    set_uniforms(program, inputs.lattice.uniforms | {"turns": TURNS})
    bind_table(program, inputs)
    for part in (supply, inputs.given, recording):
        if part:
            part.bind(program)
    with phase_uniforms(device, program, scene.phase):
        supply.draw(device, program, tuple(filter(None, (target, counts))), add=not first)


def bind_table(program: Any, inputs: FogInputs) -> None:
    """Bind the airlight model's table, where it has one."""
    name, phase = inputs.technique.airlight, inputs.scene.phase
    make = AIRLIGHT_MODELS[name].table
    if make is None:
        return
    table = inputs.kept.get(("table", name, phase), lambda: _table_texture(inputs.device, make(phase)))
    table.use(TABLE_UNIT)
    set_uniforms(program, {"airlight_table": TABLE_UNIT})


def _table_texture(device: Device, values: np.ndarray) -> Any:
    """A table (rows, columns) or (rows, columns, components) as a texture that ends in its border's values."""
    rows, columns, *components = values.shape
    context = device.context
    texture = context.texture((columns, rows), *(components or [1]), np.ascontiguousarray(values, "f4"), dtype="f4")
    texture.repeat_x = texture.repeat_y = False
    texture.filter = (context.LINEAR, context.LINEAR)
    return texture


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
