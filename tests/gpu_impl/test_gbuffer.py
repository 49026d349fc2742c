"""What the geometry pass packs comes out again."""

from __future__ import annotations

import numpy as np

from gpu_impl.context import shared_context
from gpu_impl.device import Device
from gpu_impl.shader_source import ShaderSource, compile_program, set_uniforms

SIDE = 256
MAIN = """
    #include "gbuffer.glsl"
    uniform sampler2D directions;
    uniform sampler2D reflectances;
    layout(location = 0) out vec4 direction;
    layout(location = 1) out vec4 reflectance;
    void main() {
        ivec2 at = ivec2(gl_FragCoord.xy);
        vec4 colour = texelFetch(reflectances, at, 0);
        uvec4 material = packed_material(colour.rgb, colour.a, texelFetch(directions, at, 0).xyz);
        direction = vec4(unpacked_direction(material.a), 0.0);
        reflectance = vec4(diffuse_reflectance(material), is_two_sided(material) ? 1.0 : 0.0);
    }"""


def test_packing() -> None:
    rng = np.random.default_rng(6)
    directions = rng.normal(size=(SIDE * SIDE, 3))
    # the axes, where the octahedron's faces meet, and one of no length
    directions[:6] = np.concatenate([np.eye(3), -np.eye(3)])
    directions[6:14] = [(x, y, 0) for x in (-1, 1) for y in (-1, 1)] * 2
    directions *= 10 ** rng.uniform(-6, 6, size=(SIDE * SIDE, 1))
    reflectances = rng.uniform(size=(SIDE * SIDE, 4))
    reflectances[:8, :3] = [0.0, 1.0, 0.5]
    reflectances[:, 3] = rng.integers(0, 2, SIDE * SIDE)

    device = Device(shared_context())
    inputs = [
        device.context.texture((SIDE, SIDE), components, array.astype("f4"), dtype="f4")
        for array, components in ((directions, 3), (reflectances, 4))
    ]
    program = compile_program(
        device.context, ShaderSource("fullscreen.vert.glsl"), ShaderSource("<main>", generated={"<main>": MAIN})
    )
    set_uniforms(program, {"directions": 0, "reflectances": 1})
    for unit, texture in enumerate(inputs):
        texture.use(unit)
    outputs = [device.texture((SIDE, SIDE), 4) for _ in range(2)]
    device.fill(program, *outputs)
    found, colours = (np.frombuffer(texture.read(), np.float32).reshape(-1, 4) for texture in outputs)
    for texture in (*inputs, *outputs):
        texture.release()

    # bit for bit
    assert (colours == reflectances.astype(np.float32)).all()
    unit = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    sine = np.linalg.norm(np.cross(unit, found[:, :3].astype(np.float64)), axis=1)
    assert (np.einsum("ij,ij->i", unit, found[:, :3]) > 0).all()
    # measured 6.2e-5: half a step of the 16 bits, 1.5e-5 each way, up to three times as long on the sphere
    assert sine.max() < 8e-5
    assert np.linalg.norm(found[:, :3], axis=1).max() < 1 + 1e-6
